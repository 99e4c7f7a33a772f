"""Block steps keep what stability asks for some updates of each particle."""

import numpy as np
import pytest
from harness import instance, last_frame, run, state, write
from scenes import (
    cloth_box,
    cloth_styles,
    filled,
    final_dump,
    header,
    jitter,
    lattice,
    neighbor,
    sheet,
    sph_tait,
)
from step_scenes import SPACING, beside_stiff_water, dt_and_limit

BLOCK = "run_style sph/adaptive block\n"
ALONE = "velocity 0 force 0 density 0 max 1"
WIDTH = 8 * SPACING
GO_ON = """dump end all custom 80 end.txt id x y z vx vy vz
dump_modify end sort id format float %.17g
run 60
"""


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_a_run_goes_on_with_them_after_a_restart(ranks, tmp_path):
    scene = beside_stiff_water(4.0, ALONE)
    fixes = "".join(line for line in scene.splitlines(True) if line.startswith("fix "))
    with instance() as lmp:
        lmp.commands_string(f"{scene}displace_atoms all random 1e-4 1e-4 1e-4 7 units box")
        lmp.commands_string(f"run 19\nwrite_restart {tmp_path}/half")
        before = lmp.extract_fix("step", 0, 1, 2)
        lmp.command("run 60")
        whole = state(lmp)
        assert lmp.extract_fix("step", 0, 1, 2) - before < 0.9 * 60 * 448
    run(write(tmp_path, f"read_restart half\n{fixes}{BLOCK}{GO_ON}"), ranks=ranks)
    apart = last_frame(tmp_path / "end.txt")[:, 1:] - whole
    apart[:, :3] -= WIDTH * np.round(apart[:, :3] / WIDTH)
    assert np.abs(apart).max() < 1e-11


def out_of_reach_of_the_sheet():
    """Let water that has no vertex near set the smallest step, and wait as long as it may."""
    lmp = instance()
    lmp.commands_string(beside_stiff_water(200.0, ALONE) + "run 15 post no")
    return lmp


def step_of_global(lmp):
    lmp.commands_string("run_style sph/adaptive global\nrun 1 post no")
    return dt_and_limit(lmp)[0]


def test_they_follow_vertices_inside_the_support_on_any_number_of_ranks(tmp_path):
    """Lists of the ranks hold different vertices a little outside, as of two fluids above these."""
    fluids = sph_tait(
        "1 1 fluid 1000 c0 60 alpha 0.1 nu 1e-3",
        "3 3 fluid 800 c0 15 alpha 0.1 support 0.14",
        "2 2 boundary",
        options="tension yes",
    )
    with instance() as lmp:
        lmp.commands_string(
            header()
            + cloth_box("-0.5 0.5 -0.5 0.5 -0.6 0.8", 3)
            + lattice()
            + filled("fine", "-0.15 0.15 -0.15 0.15 0.03 0.18")
            + lattice(0.07)
            + filled("coarse", "-0.49 0.49 -0.49 0.49 -0.42 -0.14", 3)
            + "mass * 0.125\nmass 3 0.2744\ngroup fluid type 1 3\ngroup falls type 1\n"
            + jitter(0.004, 1234, "fluid")
            + "velocity falls set 0.5 0.3 -2 units box\n"
            + sheet(2, 2.0, "0.7 0.7", 0.1)
            + f"write_data {tmp_path}/scene.data nocoeff"
        )
    script = write(
        tmp_path,
        header()
        + "read_data scene.data\ngroup cloth type 2\ngroup fluid type 1 3\n"
        + fluids
        + cloth_styles("1", "compliance 100")
        + neighbor(0.03)
        + """timestep 0.004
fix step fluid sph/integrate global gain 1
fix sheet cloth pbd/cloth
fix contact fluid cloth/contact 0.015 sides no
"""
        + BLOCK
        + "run 90\n"
        + final_dump(),
    )
    for ranks in (1, 2):
        run(script, ranks=ranks, dump=f"{ranks}.txt")
    apart = last_frame(tmp_path / "1.txt") - last_frame(tmp_path / "2.txt")
    assert np.abs(apart[:, 1:4]).max() < 1e-6 * SPACING


def test_they_are_found_anew_where_sound_is_faster_in_the_next_run():
    with out_of_reach_of_the_sheet() as lmp:
        before = dt_and_limit(lmp)[0]
        lmp.commands_string("pair_coeff 3 3 fluid 1000 c0 1000\nrun 1 post no")
        kept = dt_and_limit(lmp)[0]
        assert kept < 0.5 * before
        assert kept <= step_of_global(lmp) * (1 + 1e-9)


def test_they_are_found_again_while_they_grow():
    """Water is pressed together by two fifths within 22 steps."""
    with out_of_reach_of_the_sheet() as lmp:
        first = step_of_global(lmp)
    with out_of_reach_of_the_sheet() as lmp:
        end = 0.3 * WIDTH
        lmp.command(f"fix press all deform 1 x final {-end} {end} remap x units box")
        lmp.command("run 22 post no")
        kept = dt_and_limit(lmp)[0]
        lmp.command("unfix press")
        found = step_of_global(lmp)
    assert found < 0.6 * first
    assert kept < 1.1 * found

"""run_style sph/adaptive block with a sheet: momentum, output times, limits, contact."""

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from registry import SCENES
from scenes import (
    DROP,
    END,
    FREE_SHEET,
    MAKE_DROP,
    cloth_box,
    cloth_styles,
    gravity,
    header,
    neighbor,
    sheet,
    sph_tait,
)
from scenes.units import render
from step_scenes import momentum_with_sheet


def on_free_sheet(wall, limits):
    """Let water fall on a sheet of boundary particles or on one that is a wall."""
    scene = FREE_SHEET.replace(
        "sph/integrate global", f"sph/integrate global velocity 0 acoustic 0.5 force 0.05 {limits}"
    )
    if wall:
        scene = scene.replace("3 3 boundary", "3 3 none").replace(
            "cloth/contact 0.03", "cloth/contact 0.03 wall yes\ncomm_modify cutoff 0.3"
        )
    return scene


@pytest.mark.parametrize("limits", ["", "output 0.01"])
@pytest.mark.parametrize("wall", [False, True])
def test_momentum_of_a_free_sheet_and_its_water(wall, limits):
    """Boundary particles or meshes take their part of the impulses.

    At an output time the sheet has a deferred impulse, what the water has been given ahead.
    """
    scene = on_free_sheet(wall, limits)
    lmp = instance()
    lmp.commands_string(scene + "run_style sph/adaptive block\nrun 1")
    (start, scale), active, error = momentum_with_sheet(lmp), [], []
    for _ in range(57):
        lmp.command("run 7 post no")
        active.append(lmp.extract_fix("step", 0, 1, 1))
        if lmp.extract_fix("step", 0, 1, 27) == 0:
            error.append(np.abs(momentum_with_sheet(lmp)[0] - start).max())
    assert min(active) < 0.7
    assert len(error) > 10
    assert max(error) < 1e-12 * scale


@pytest.mark.parametrize("wall", [False, True])
def test_restart_at_an_output_time(wall, tmp_path):
    """The sheet gets its deferred impulse."""
    begin = on_free_sheet(wall, "output 0.011 wetted 50 viscous 50 force 2")
    begin += "run_style sph/adaptive block\n"
    begin = begin.replace("timestep 0.001", "timestep 0.004").replace("c0 6 nu", "c0 24 nu")
    to_an_output_time = (
        "run 1 post no\nfix stop all halt 1 v_there > 0.5 error continue\n"
        "run 1000 post no\nunfix stop\n"
    )
    fixes = "".join(
        line
        for line in begin.splitlines(True)
        if line.startswith(("fix ", "run_", "comm_mod", "neigh"))
    )
    again = f"atom_style hybrid sph molecular\nread_restart {tmp_path}/half.bin\n{fixes}"
    with instance() as lmp:
        lmp.commands_string(begin + "variable there equal f_step[28]\nrun 1")
        start, scale = momentum_with_sheet(lmp)
        for _ in range(20):
            lmp.commands_string(to_an_output_time)
            assert lmp.extract_fix("step", 0, 1, 27) == 1
            if np.abs(momentum_with_sheet(lmp)[0] - start).max() > 1e-7 * scale:
                break
        else:
            pytest.fail("the sheet has no deferred impulse at any of 20 output times")
        go_on = "run 33\n"
        lmp.commands_string(f"write_restart {tmp_path}/half.bin\n{go_on}")
        while lmp.extract_fix("step", 0, 1, 27) == 1:
            lmp.command("run 1")
            go_on += "run 1\n"
        first = by_id(lmp, "x"), by_id(lmp, "v")
        end = momentum_with_sheet(lmp)[0]
    with instance() as lmp:
        lmp.commands_string(again + go_on)
        second = by_id(lmp, "x"), by_id(lmp, "v")
    assert np.abs(end - start).max() < 1e-12 * scale
    for one, other in zip(first, second, strict=True):
        assert np.array_equal(one, other)


def test_a_wet_vertex_limits_the_first_step_too(tmp_path, monkeypatch):
    """Light vertices in water ask for a step below that of the water."""
    monkeypatch.chdir(tmp_path)
    run(write(tmp_path, MAKE_DROP, "in.make"))
    wet = DROP.replace(
        "group fluid type 1\n", "group fluid type 1\ndisplace_atoms fluid move 0 0 -0.03\n"
    )
    first = {}
    for scheme in ("global", "block"):
        lmp = instance()
        lmp.commands_string(wet.replace("global", "global velocity 0 force 0 mass_scaling no"))
        lmp.commands_string(f"run_style sph/adaptive {scheme}\nrun 0 post no")
        first[scheme] = lmp.extract_fix("step", 0, 0)
        lmp.close()
    assert first["global"] < 0.5 * 0.5 * 0.05 / 30
    assert 0.5 * first["global"] < first["block"] <= first["global"] * (1 + 1e-12)


def test_with_cloth_and_contact_nothing_passes(tmp_path):
    run(write(tmp_path, MAKE_DROP, "in.make"))
    script = DROP + "run_style sph/adaptive block\n" + END
    for ranks in (1, 2):
        run(write(tmp_path, script), ranks=ranks, dump=f"{ranks}.txt", steps=100)
    one, two = last_frame(tmp_path / "1.txt"), last_frame(tmp_path / "2.txt")
    assert np.abs(one - two).max() < 1e-9


# A jet falls on a pinned sheet: the steps of the scene go to and fro between powers of two.
JET = (
    header("f f f", cutoff=0.3)
    + cloth_box("-0.4 0.4 -0.4 0.4 -0.3 0.5")
    + "mass 1 $(1000*0.05^3/1.03384)\nmass 2 1.0\n"
    + "region rim block -0.17 0.17 -0.17 0.17 INF INF side out\n"
    + sheet(2, 2.0, "0.4 0.4", 0.05, "group cloth pin rim pins")
    + "group water type 1\n"
    + sph_tait("1 1 fluid 1000.0 c0 20 alpha 0.1", "2 2 boundary")
    + cloth_styles("{edge}", "{hinge}")
    + neighbor(0.05)
    + "timestep 1e-3\n"
    + gravity()
    + """fix pour water sph/emit 2000000000 1 0.05 disc 0 0 0.3 0.06 velocity 0 0 -1.2
fix drain water sph/drain
fix step water sph/integrate global gain 1 until {end}
run_style sph/adaptive {scheme}
fix sheet cloth pbd/cloth {solving} pin pins
fix contact water cloth/contact 0.01
compute energy cloth ke
variable energy equal c_energy
fix kept all vector 1 v_energy
thermo_modify norm no
"""
)


@pytest.mark.parametrize(
    ("edge", "hinge", "end"),
    [("1.0", "compliance 1", 0.18), ("1.0", "0", 0.18), ("compliance 2e-4", "0.02", 0.25)],
)
@pytest.mark.parametrize("solving", ["", "iterations 20"])
def test_steps_that_jump_do_not_feed_a_sheet(solving, edge, hinge, end):
    values = {"edge": edge, "hinge": hinge, "end": end, "solving": solving}
    with instance() as lmp:
        lmp.commands_string(JET.format(**values, scheme="block"))
        lmp.command("run 100000")
        n = lmp.extract_global("ntimestep")
        energy = [lmp.extract_fix("kept", 0, 1, k) for k in range(n)]
    assert max(energy) < 1.0


@pytest.mark.parametrize("scheme", ["block", "individual"])
def test_output_leaves_the_motion_as_it_is(tmp_path, monkeypatch, scheme):
    """Also the order in which neighbors are added, and so the last bit."""
    monkeypatch.chdir(tmp_path)
    scene = SCENES["calibrated block steps"]
    ends = []
    for every in (0, 7):
        with instance() as lmp:
            lmp.commands_string(scene.make + "\nclear\n")
            script = render(scene.first(), "si").replace("adaptive block", f"adaptive {scheme}")
            if scheme == "individual":
                script = script.replace(" switch 0.2", "")
            # at step 28 most particles are inactive
            output = f"thermo_style custom step press\nthermo {every}\n"
            lmp.commands_string(f"{script}{output}run 19\nrun 10\n")
            ends.append([by_id(lmp, name) for name in ("x", "v", "f", "rho")])
    for quiet, told in zip(*ends, strict=True):
        np.testing.assert_array_equal(told, quiet)

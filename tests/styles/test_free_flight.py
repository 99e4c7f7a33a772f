"""Free flight: what rounding makes of the density is no pressure, on any number of ranks."""

import re

import numpy as np
import pytest
from harness import instance, last_frame, run, state, write
from scenes import FLUID, box, filled, final_dump, gravity, header, jitter, lattice, neighbor
from scenes import sph_tait as usual_sph_tait
from step_scenes import dt_and_limit
from test_stepping import ACOUSTIC

SPACING, RHO0 = 0.05, 1000.0


def sph_tait(options):
    return usual_sph_tait(f"1 1 fluid {RHO0} c0 20 alpha 0.1", options=options)


FALLING = (
    "timestep 0.004\nvelocity all set 0.3 0.1 -1 units box\n"
    + gravity()
    + "fix wall all wall/sph zlo 0 xlo -0.1 xhi 0.5 ylo -0.1 yhi 0.5\n"
)


def block_of_water(shaken):
    """Of 216 particles, of the rest density by their sites or because they are told so."""
    return (
        header("f f f", FLUID)
        + box("-0.5 0.9 -0.5 0.9 -0.1 1.2")
        + f"mass 1 {RHO0 * SPACING**3}\n"
        + lattice(SPACING)
        + filled("water", "0 0.3 0 0.3 0.3 0.6")
        + (jitter(0.002, 33) if shaken else "")
        + f"set group all sph/rho {RHO0}\n"
    )


@pytest.mark.parametrize(
    ("scheme", "options", "shaken"),
    [("global", "density calibrated", False), ("block", "density continuity", True)],
)
def test_water_at_rest_density_falls_on_ranks_as_on_one(tmp_path, scheme, options, shaken):
    with instance() as lmp:
        lmp.commands_string(block_of_water(shaken) + f"write_data {tmp_path}/water.data nocoeff")
    script = write(
        tmp_path,
        header("f f f", FLUID)
        + "read_data water.data\n"
        + sph_tait(options)
        + neighbor(0.03)
        + FALLING
        + f"fix step all sph/integrate global gain 1\nrun_style sph/adaptive {scheme}\nrun 150\n"
        + final_dump("x y z vx vy vz"),
    )
    for ranks in (1, 2):
        run(script, ranks=ranks, dump=f"{ranks}.txt")
    apart = last_frame(tmp_path / "1.txt") - last_frame(tmp_path / "2.txt")
    assert np.abs(apart[:, 1:4]).max() < 1e-6 * SPACING


@pytest.mark.parametrize("scheme", ["global", "block"])
@pytest.mark.parametrize(
    ("compression", "options", "pressed"),
    [
        (1e-12, "", False),
        (1e-12, "precision mixed", False),
        (1e-7, "", True),
        (1e-5, "precision mixed", True),
        (1e-12, "tension yes", True),
        (-1e-3, "tension yes", True),
        (-1e-3, "", False),
    ],
)
def test_sound_limits_the_step_from_a_compression_beyond_rounding(
    scheme, compression, options, pressed
):
    """Water that moves as a whole, so that nothing else asks for a short step."""
    with instance() as lmp:
        lmp.commands_string(
            block_of_water(shaken=False)
            + f"set group all sph/rho {RHO0 * (1 + compression):.17g}\n"
            + sph_tait(f"density continuity {options}")
            + neighbor(0.03)
            + "timestep 0.1\nfix step all sph/integrate global force 0\n"
            + f"run_style sph/adaptive {scheme}\nrun 1 post no"
        )
        assert (dt_and_limit(lmp)[1] == ACOUSTIC) == pressed


def resting_block(options, scheme, run):
    """Its surface is thinner than at rest, its inside denser."""
    return (
        block_of_water(shaken=True)
        + sph_tait(options)
        + neighbor(0.03)
        + "timestep 0.02\nfix step all sph/integrate global force 0 density 0\n"
        + f"run_style sph/adaptive {scheme}\n{run}\n"
    )


@pytest.mark.parametrize("scheme", ["global", "block"])
@pytest.mark.parametrize(("options", "longer"), [("", True), ("tension yes", False)])
def test_what_presses_on_nothing_lets_equal_steps_be_longer(options, longer, scheme):
    """Individual steps count all neighbors as if they were under pressure."""
    steps = {}
    for each in (scheme, "individual"):
        with instance() as lmp:
            lmp.commands_string(resting_block(options, each, "run 1"))
            steps[each] = dt_and_limit(lmp)[0]
    ratio = steps[scheme] / steps["individual"]
    if longer:
        assert 1.02 < ratio < 1.5
    else:
        assert ratio == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("scheme", ["global", "block"])
def test_neighbors_of_other_ranks_are_known_to_be_in_free_flight(scheme, tmp_path):
    with instance() as lmp:
        lmp.commands_string(
            block_of_water(shaken=True) + f"write_data {tmp_path}/water.data nocoeff"
        )
    whole = resting_block("", scheme, "thermo_style custom step time dt\nthermo 1\nrun 30")
    script = write(
        tmp_path,
        header("f f f", FLUID) + "read_data water.data\n" + whole[whole.index("pair_style") :],
    )
    rows = [re.findall(r"(?m)^ +\d+ +\S+ +\S+ *$", run(script, ranks=ranks)) for ranks in (1, 2, 4)]
    assert len(rows[0]) == 31
    assert rows[0] == rows[1] == rows[2]


def test_equal_and_unequal_steps_in_turn_go_on_to_the_last_bit(tmp_path, monkeypatch):
    """Where steps become unequal neighbors in free flight begin to count as under pressure."""
    monkeypatch.chdir(tmp_path)
    styles = (
        sph_tait("")
        + neighbor(0.03)
        + FALLING.replace("velocity all set 0.3 0.1 -1 units box\n", "")
        + "fix step all sph/integrate global gain 1.2\nrun_style sph/adaptive block\n"
    )
    kept, active = [], []
    with instance() as whole:
        whole.commands_string(block_of_water(shaken=True) + styles)
        for k in range(40):
            whole.command("run 4 post no")
            kept.append(state(whole))
            active.append(whole.extract_fix("step", 0, 1, 1))
            whole.command(f"write_restart {k}.restart")
    turns = [k for k in range(37) if (active[k] < 1.0) != (active[k + 1] < 1.0)]
    assert len(turns) >= 4
    for k in turns[:6]:
        with instance() as again:
            again.commands_string(f"comm_modify vel yes\nread_restart {k}.restart\n{styles}")
            for ahead in (1, 2):
                again.command("run 4 post no")
                np.testing.assert_array_equal(
                    state(again), kept[k + ahead], err_msg=f"{k}, {ahead}"
                )

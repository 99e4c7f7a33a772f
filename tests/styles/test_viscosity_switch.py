"""pair_coeff ... switch: artificial viscosity that is switched off where the flow shears."""

import numpy as np
import pytest
from harness import by_id, instance
from reference_sph import C0, RHO0
from scenes import (
    FLUID,
    box,
    cloth_box,
    cloth_styles,
    filled,
    gravity,
    header,
    jitter,
    lattice,
    neighbor,
    sheet,
    sph_tait,
)

SPACING = 0.05
FLOWS = {"shear": "0 v_wave 0", "sound": "v_wave 0 0"}


def wave(kind, words, scheme="constant"):
    """Return the kinetic energy that is left of a wave of small velocities, in its direction."""
    with instance() as lmp:
        lmp.commands_string(
            header("p p p", FLUID)
            + box(f"0 1 0 {4 * SPACING} 0 {4 * SPACING}")
            + f"lattice sc {SPACING} origin 0.5 0.5 0.5\ncreate_atoms 1 box\n"
            + sph_tait(
                f"1 1 fluid {RHO0} c0 {C0} alpha 0.2 spacing {SPACING} {words}",
                support=2 * SPACING,
                options="density calibrated tension yes",
            )
            + neighbor(0.3 * SPACING)
            + f"""variable wave atom 0.1*sin(2*PI*x)
            velocity all set {FLOWS[kind]} units box
            timestep {1 / C0 / 400}
            fix step all sph/integrate global gain 1
            run_style sph/adaptive {scheme}
            compute kinetic all ke
            run 0"""
        )
        before = lmp.extract_compute("kinetic", 0, 0)
        lmp.command("run 1600")  # four periods of sound
        return lmp.extract_compute("kinetic", 0, 0) / before


@pytest.mark.parametrize("scheme", ["constant", "global", "block"])
def test_shear_decays_by_the_floor_alone_and_sound_as_before(scheme):
    """A sound wave at its extremes has neither divergence nor curl, and all of both between."""
    rate = {
        (kind, words): -np.log(wave(kind, words, scheme))
        for kind in FLOWS
        for words in ("", "switch 0.2", "switch 0")
    }
    for kind in FLOWS:
        assert rate[kind, ""] > 0.05
    assert rate["shear", "switch 0.2"] == pytest.approx(0.2 * rate["shear", ""], rel=0.1)
    assert abs(rate["shear", "switch 0"]) < 0.05 * rate["shear", ""]
    for words in ("switch 0.2", "switch 0"):
        assert rate["sound", words] == pytest.approx(rate["sound", ""], rel=0.1)


def soaked(words, scheme, extra=""):
    """Water in disordered motion on both sides of a sheet of boundary particles."""
    half = 4 * SPACING
    lmp = instance()
    lmp.commands_string(
        header("p p p")
        + cloth_box(f"-{half} {half} -{half} {half} -{half} {half}")
        + f"mass 1 {RHO0 * SPACING**3}\n"
        + sheet(2, 4.0, f"{7 * SPACING} {7 * SPACING}", SPACING)
        + f"lattice sc {SPACING} origin 0.5 0.5 0\n"
        + filled("above", f"-{half} {half} -{half} {half} {SPACING / 2} {half}")
        + filled("below", f"-{half} {half} -{half} {half} -{half} -{SPACING / 2}")
        + "group fluid type 1\n"
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {C0} alpha 0.2 {words}",
            f"2 2 boundary pressure own volume {SPACING**3}",
            support=2 * SPACING,
        )
        + cloth_styles("compliance 1e-6", "0")
        + neighbor(0.3 * SPACING)
        + "velocity all create 1e18 7 loop geom\ntimestep 1e-4\n"
        + "fix step fluid sph/integrate global gain 1\nfix sheet cloth pbd/cloth\n"
        + f"run_style sph/adaptive {scheme}\n{extra}"
    )
    return lmp


def motion(lmp):
    """Momentum of all at the time of the positions, and the sum of its sizes."""
    mass = lmp.numpy.extract_atom("mass")[by_id(lmp, "type")]
    each = mass[:, None] * by_id(lmp, "v")
    of_sheet = (7, 8, 9) if lmp.has_id("fix", "sheet") else ()
    half_kick = [lmp.extract_fix("sheet", 0, 1, n) for n in of_sheet] or np.zeros(3)
    return each.sum(axis=0) - half_kick, np.linalg.norm(each, axis=1).sum()


# with block vertices get their part of an impulse with the next step
ALONE = "unfix sheet\ndelete_atoms group cloth bond yes"


@pytest.mark.parametrize(("scheme", "extra"), [("global", ""), ("block", ALONE)])
def test_momentum_is_exact(scheme, extra):
    with soaked("switch 0.1", scheme, f"{extra}\nrun 1") as lmp:
        before, size = motion(lmp)
        lmp.command("run 50")
        after, _ = motion(lmp)
    assert np.abs(after - before).max() < 1e-12 * size


def falls_in_a_tank(neigh_modify):
    """Two shaken fluids with unequal steps and output times: ends, and pressures inside steps."""
    with instance() as lmp:
        lmp.commands_string(
            header("f f f", FLUID)
            + box("-0.3 0.8 -0.3 0.8 -0.3 1.2", 2)
            + "mass 1 0.125\nmass 2 0.1\natom_modify sort 0 0\n"
            + lattice(SPACING)
            + filled("below", "0 0.4 0 0.4 0 0.2")
            + filled("above", "0 0.4 0 0.4 0.2 0.4", 2)
            + jitter(0.003, 33)
            + sph_tait(
                "1 1 fluid 1000 c0 20 alpha 0.1 switch 0.2",
                "2 2 fluid 800 c0 15 alpha 0.1 switch 0.2",
                options="density calibrated",
            )
            + neighbor(0.03)
            + f"neigh_modify {neigh_modify}\ntimestep 0.004\n"
            + gravity()
            + """fix tank all wall/sph zlo 0 xlo 0 xhi 0.5 ylo 0 yhi 0.4
            fix step all sph/integrate global gain 1 output 0.02
            run_style sph/adaptive block
            thermo_style custom step press
            run 0 post no"""
        )
        pressures = []
        for _ in range(100):
            lmp.command("run 1 pre no post no")
            if lmp.extract_fix("step", 0, 1, 1) < 1:
                pressures.append(lmp.get_thermo("press"))
        return by_id(lmp, "x"), np.array(pressures)


def test_shares_at_output_times_and_in_the_pressure_are_those_of_the_motion_there():
    """Not those of an evaluation before, which new lists forget: they may come in every step."""
    (whole, pressures), (again, with_new_lists) = map(falls_in_a_tank, ("check yes", "check no"))
    assert np.abs(whole - again).max() < 1e-6 * SPACING
    assert len(pressures) > 5
    assert with_new_lists == pytest.approx(pressures, rel=1e-6)


def test_a_switch_of_one_changes_nothing():
    found = []
    for words in ("", "switch 1"):
        with soaked(words, "global", "run 20") as lmp:
            found.append(by_id(lmp, "x"))
    assert np.array_equal(*found)


def test_data_files_contain_it(tmp_path):
    with soaked("switch 0.25", "global", "run 0") as lmp:
        lmp.command(f"write_data {tmp_path}/data nofix")
    assert "alpha 0.2 switch 0.25" in (tmp_path / "data").read_text()


@pytest.mark.parametrize(
    ("words", "scheme", "message"),
    [
        ("switch 1.5", "global", "switch is '1.5': give a number from 0 to 1"),
        ("switch -0.1", "global", "switch is '-0.1': give a number from 0 to 1"),
        ("switch", "global", "switch is missing at the end of the command"),
        ("switch 0.2", "individual", "leave 'switch' of pair_coeff out"),
    ],
)
def test_bad_input_is_named(words, scheme, message):
    with pytest.raises(Exception, match=message):
        soaked(words, scheme, "run 0")

"""The skin of neighbor lists where the script gives none."""

import re

import pytest
from harness import instance
from scenes import FLUID, box, header, sph_tait

UNITS = ["lj", "real", "metal", "si", "cgs", "electron", "micro", "nano"]
REACH = 1.0


def cutoff_and_log(folder, pair, units="si", neighbor=""):
    """How far ghosts reach in a run of one particle, and what LAMMPS says."""
    log = folder / "log"
    with instance() as lmp:
        lmp.commands_string(
            f"log {log}\n"
            + header(atoms=FLUID, units=units)
            + box("-4 4 -4 4 -4 4")
            + "create_atoms 1 single 0 0 0\nmass 1 1\n"
            + pair
            + neighbor
            + "\nrun 0\ninfo out log comm\nrun 0"
        )
    text = log.read_text()
    return float(re.search(r"Communication cutoff = ([\d.e+-]+)", text)[1]), text


def water(support):
    return sph_tait("1 1 fluid 1 c0 1", support=support)


@pytest.mark.parametrize("units", UNITS)
def test_it_is_half_of_the_support_in_the_place_of_the_default_of_lammps(units, tmp_path):
    usual = cutoff_and_log(tmp_path, f"pair_style zero {REACH}\npair_coeff * *\n", units)[0] - REACH
    cutoff, text = cutoff_and_log(tmp_path, water(3.0), units)
    assert cutoff == 4.5
    told = (
        f"pair_style sph/tait: neighbor skin 1.5, half of the support, in the place of {usual:g},"
    )
    assert text.count(told) == 1
    assert f"the default of units {units}: give it by 'neighbor'" in text


@pytest.mark.parametrize("units", UNITS)
def test_the_default_of_lammps_is_had_by_one_just_above_it(units, tmp_path):
    _, text = cutoff_and_log(tmp_path, water(3.0), units)
    default, given = (
        float(number)
        for number in re.search(
            r"in the place of ([\d.]+),.* as ([\d.]+) for the default", text
        ).groups()
    )
    assert default < given < 1.001 * default
    cutoff, _ = cutoff_and_log(tmp_path, water(3.0), units, f"neighbor {given} bin")
    assert cutoff == pytest.approx(3.0 + given, rel=1e-5)


def test_a_skin_that_is_given_stays(tmp_path):
    cutoff, text = cutoff_and_log(tmp_path, water(1.0), neighbor="neighbor 0.2 bin")
    assert cutoff == 1.2
    assert "neighbor skin" not in text


@pytest.mark.parametrize(("support", "skin"), [(0.1, 0.3), (1.0, 0.5)])
def test_beside_another_style_it_is_no_narrower(support, skin, tmp_path):
    both = water(support).replace(
        "pair_style sph/tait", "pair_style hybrid/overlay zero 0.05 sph/tait"
    )
    both = both.replace("pair_coeff 1 1", "pair_coeff * * zero\npair_coeff 1 1 sph/tait")
    cutoff, text = cutoff_and_log(tmp_path, both, "lj")
    assert cutoff == pytest.approx(support + skin, rel=1e-12)
    assert ("neighbor skin" in text) == (skin != 0.3)
    assert cutoff_and_log(tmp_path, water(support), "lj")[0] == pytest.approx(1.5 * support)

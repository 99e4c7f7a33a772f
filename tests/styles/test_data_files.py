"""Data and restart files hold what pair_style and pair_coeff said: the same forces come out."""

import numpy as np
import pytest
from harness import by_id, instance
from scenes import TWO_FLUIDS

PAIR = """
pair_coeff 1 1 fluid 1000 c0 20 alpha 0.3 nu 0.0123456789012345678
pair_coeff 2 2 fluid 1200 fluctuation 0.013 3.1 gamma 4 nu 0.01 support 0.11
pair_coeff 3 3 boundary
"""
OWN = """
pair_coeff 1 2 alpha 0.7
pair_coeff 1 3 nu 0.3 support 0.09 c0 55
pair_coeff 3 3 boundary volume 1.3e-4
"""
BEHIND = """
neighbor 0.03 bin
neigh_modify every 1 delay 0 check yes
special_bonds lj/coul 1 1 1
timestep 0.001
"""
# of pair_style: each must be in the restart file, and each changes the forces
SETTINGS = {
    "defaults": "",
    "kernel": "kernel quintic",
    "tension": "tension yes",
    "precision": "precision mixed",
    "continuity": "density continuity",
    "delta": "density continuity delta 0.4",
    "reinit": "density continuity reinit 3",
}
BEFORE_READING = "units si\natom_style hybrid sph molecular\ncomm_modify vel yes\nboundary p p f\n"


def scene(setting="", coefficients=PAIR, extra=""):
    lmp = instance()
    lmp.commands_string(
        TWO_FLUIDS
        + f"pair_style sph/tait 0.1 {setting}\n{coefficients}{BEHIND}"
        + "velocity all ramp vz -0.3 0.3 x 0.0 0.3 units box\n"
        + "set type 1 sph/rho 1010\nset type 2 sph/rho 1220\n"
        + extra
        + "run 0"
    )
    return lmp


def forces_after(lmp, steps, group="fluid type 1 2"):
    lmp.commands_string(f"group {group}\nfix move fluid sph/integrate constant\nrun {steps}")
    return by_id(lmp, "f")


@pytest.mark.parametrize("mixing", ["ii", "ij"])
@pytest.mark.parametrize("coefficients", [PAIR, PAIR + OWN], ids=["mixed", "own"])
def test_data_file(tmp_path, mixing, coefficients):
    """Pairs that were given coefficients of their own need 'pair ij'."""
    path = tmp_path / "x.data"
    lmp = scene(coefficients=coefficients)
    lmp.command(f"write_data {path} pair {mixing}")
    again = instance()
    again.commands_string(
        f"{BEFORE_READING}pair_style sph/tait 0.1\nread_data {path}\n{BEHIND}run 0"
    )
    scale = np.abs(by_id(lmp, "f")).max()
    same = np.allclose(by_id(again, "f"), by_id(lmp, "f"), rtol=0, atol=1e-13 * scale)
    assert same == (mixing == "ij" or coefficients == PAIR)


def test_data_file_of_data_file(tmp_path):
    """Every digit survives: a second round gives the same text."""
    lmp = scene(coefficients=PAIR + OWN)
    texts = []
    for name in ("first", "second"):
        path = tmp_path / name
        lmp.command(f"write_data {path} pair ij")
        texts.append(path.read_text().split("PairIJ Coeffs")[1].split("Atoms")[0])
        lmp = instance()
        lmp.commands_string(
            f"{BEFORE_READING}pair_style sph/tait 0.1\nread_data {path}\n{BEHIND}run 0"
        )
    assert texts[0] == texts[1]
    assert "0.012345678901234568" in texts[0] and "k 3025" in texts[0]


@pytest.mark.parametrize("setting", SETTINGS)
def test_restart(tmp_path, setting):
    path = tmp_path / "x.restart"
    lmp = scene(SETTINGS[setting], PAIR + OWN)
    forces_after(lmp, 4)
    lmp.command(f"write_restart {path}")
    lmp.command("run 6")
    again = instance()
    again.commands_string(f"read_restart {path}\ncomm_modify vel yes\n{BEHIND}")
    np.testing.assert_array_equal(forces_after(again, 6), by_id(lmp, "f"))


def test_each_setting_matters():
    """Otherwise the restarts above would prove nothing."""
    seen = [forces_after(scene(text, PAIR + OWN), 10) for text in SETTINGS.values()]
    for k, one in enumerate(seen):
        assert all(np.any(one != other) for other in seen[:k])

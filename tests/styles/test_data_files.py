"""Data and restart files hold what pair_style and pair_coeff said: the same forces come out."""

import struct

import numpy as np
import pytest
from harness import by_id, instance
from scenes import TWO_FLUIDS, cloth_box, gravity, header, neighbor, sheet

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
BEHIND = neighbor(0.03) + "special_bonds lj/coul 1 1 1\ntimestep 0.001\n"
# of pair_style: each must be in the restart file, and each changes the forces
SETTINGS = {
    "defaults": "",
    "kernel": "kernel quintic",
    "tension": "tension yes",
    "precision": "precision mixed",
    "continuity": "density continuity",
    "delta": "density continuity delta 0.4",
    "reinit": "density continuity reinit 3",
    "calibrated": "density calibrated",
}
BEFORE_READING = header("p p f")


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


def test_damaged_restart_files_are_named(tmp_path):
    """The settings of the pair style, and the record of a fix, which ends with an ID of its own."""
    path = tmp_path / "x.restart"
    lmp = scene("", PAIR)
    forces_after(lmp, 0)
    lmp.command(f"write_restart {path}")
    whole = path.read_bytes()
    head = whole.index(b"CHPS", whole.index(b"sph/tait"))
    settings = whole.index(struct.pack("d", 0.1), head)
    of_pair = r"pair_style sph/tait: its settings in the restart file are damaged.* another"
    record = whole.index(b"CHPS", settings)
    damage = {
        head: of_pair,  # what a file of another release has there, too
        settings: of_pair,
        record: r"fix move sph/integrate: its record in the restart file is damaged.*"
        "give the fix another ID",
    }
    for place, words in damage.items():
        path.write_bytes(whole[:place] + b"\xff" * 8 + whole[place + 8 :])
        again = instance()
        with pytest.raises(Exception, match=words):
            again.commands_string(f"read_restart {path}\ncomm_modify vel yes\n{BEHIND}")
            forces_after(again, 0)


def test_each_setting_matters():
    """Otherwise the restarts above would prove nothing."""
    seen = [forces_after(scene(text, PAIR + OWN), 10) for text in SETTINGS.values()]
    for k, one in enumerate(seen):
        assert all(np.any(one != other) for other in seen[:k])


# ---------------------------------------------------------------------- rest shape of a cloth

STYLES = (
    header("f f f", "molecular", cutoff=0.3)
    + """bond_style pbd
angle_style zero
dihedral_style pbd
pair_style zero 0.1
"""
)
HANGS = """
pair_coeff * *
bond_coeff 1 compliance 1e-2
angle_coeff *
dihedral_coeff 1 0.1
special_bonds lj/coul 1 1 1
region rim block -0.17 0.17 -0.17 0.17 INF INF side out
group cloth type 1
timestep 1e-3
""" + gravity()
MADE = (
    cloth_box("-0.4 0.4 -0.4 0.4 -0.4 0.4", 1) + "mass 1 1.0\n" + sheet(1, 4.0, "0.4 0.4", 0.1, "")
)
KEPT = "fix rest all property/atom d2_rest 3\n"
FILLED = """
variable x atom x
variable y atom y
variable z atom z
set group cloth d2_rest[1] v_x d2_rest[2] v_y d2_rest[3] v_z
"""


@pytest.mark.parametrize(
    ("keep", "how", "kept"), [(True, "", True), (True, "nofix", False), (False, "", False)]
)
def test_the_rest_shape_in_a_data_file(tmp_path, keep, how, kept):
    """A strained sheet keeps its strain if the file holds the property, and LAMMPS says nothing."""
    path = tmp_path / "later.data"
    fix = "fix sheet cloth pbd/cloth pin pins"
    pins = "region pins block -0.21 -0.19 INF INF INF INF\ngroup pins region pins\n"
    with instance() as lmp:
        lmp.commands_string(STYLES + MADE + HANGS + pins)
        lmp.commands_string(KEPT + FILLED if keep else "")
        lmp.commands_string(
            f"{fix} {'rest d2_rest' if keep else ''}\nrun 100\nwrite_data {path} {how}"
        )
        strain = lmp.extract_fix("sheet", 0, 1, 3)
    assert strain > 0.01
    with instance() as lmp:
        read = f"read_data {path} {'fix rest NULL rest' if kept else ''}\n"
        lmp.commands_string(STYLES + (KEPT if kept else "") + read + HANGS + pins)
        lmp.commands_string(f"{fix} {'rest d2_rest' if kept else ''}\nrun 0")
        again = lmp.extract_fix("sheet", 0, 1, 3)
    assert again == pytest.approx(strain if kept else 0, rel=1e-9, abs=1e-12)

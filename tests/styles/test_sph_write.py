"""sph_write: tables of the kernel and of the equation of state that the pair style uses."""

import math

import numpy as np
import pytest
from harness import instance, run, write
from scenes import FLUID, box, header, sph_tait


def text(setting="", units="si", dimension=3):
    return (
        header(atoms=FLUID, units=units, dimension=dimension)
        + box("-1 1 -1 1 -0.2 0.2", 4)
        + "mass * 1.0\n"
        + sph_tait(
            "1 1 fluid 1000 c0 20",
            "2 2 fluid 1200 c0 30 gamma 4 support 0.14",
            "3 3 boundary",
            options=setting,
        )
    )


def scene(setting="", units="si", dimension=3):
    lmp = instance()
    lmp.commands_string(text(setting, units, dimension))
    return lmp


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("kernel", ["wendland/c2", "wendland/c4", "cubic", "quintic"])
def test_kernel(tmp_path, kernel, dimension):
    path = tmp_path / "kernel.txt"
    scene(f"kernel {kernel}", dimension=dimension).command(f"sph_write kernel 1 2 4001 {path}")
    r, w, slope = np.loadtxt(path).T
    assert r[0] == 0 and r[-1] == pytest.approx(0.12, rel=1e-14)  # the mean of two supports
    assert w[-1] == slope[-1] == slope[0] == 0
    measure = 4 * np.pi * r**2 if dimension == 3 else 2 * np.pi * r
    assert np.trapezoid(measure * w, r) == pytest.approx(1, rel=1e-6)
    np.testing.assert_allclose(
        np.gradient(w, r)[1:-1], slope[1:-1], atol=2e-6 * np.abs(slope).max()
    )


@pytest.mark.parametrize("tension", ["no", "yes"])
def test_state(tmp_path, tension):
    path = tmp_path / "state.txt"
    scene(f"tension {tension}").command(f"sph_write state 2 101 {path} 1100 1300")
    rho, p, sound, energy = np.loadtxt(path).T
    np.testing.assert_allclose(rho, np.linspace(1100, 1300, 101), rtol=1e-14)
    acts = (rho > 1200) | (tension == "yes")
    expected = 900 * 1200 / 4 * ((rho / 1200) ** 4 - 1)
    np.testing.assert_allclose(p, np.where(acts, expected, 0), rtol=1e-11, atol=1e-9)
    np.testing.assert_allclose(sound, 30 * (rho / 1200) ** 1.5, rtol=1e-13)
    slope = p / rho**2  # of the energy; trapezoids are off by (2 kg/m^3)^3 slope''/12
    np.testing.assert_allclose(np.diff(energy), slope[1:] + slope[:-1], rtol=0, atol=2e-6)
    assert energy[50] == 0 and energy[-1] > 1


def test_state_in_units_that_convert(tmp_path):
    """metal: velocity in A/ps, mass in g/mol; energies in eV, pressures in bar."""
    path = tmp_path / "state.txt"
    scene(units="metal").command(f"sph_write state 1 2 {path} 1000 1100")
    p, energy = np.loadtxt(path)[1, [1, 3]]
    dalton, electronvolt = 1.66053906660e-27, 1.602176634e-19
    raw = 400 * 1000 / 7 * (1.1**7 - 1)  # Da/A^3 (A/ps)^2
    assert p == pytest.approx(raw * dalton * 1e30 * 1e4 / 1e5, rel=1e-5)
    per_mass = 400 / 7 * (1.1**6 / 6 + 1 / 1.1 - 7 / 6)  # (A/ps)^2
    assert energy == pytest.approx(per_mass * dalton * 1e4 / electronvolt, rel=1e-5)


def test_tables_are_appended_and_headed_on_any_number_of_ranks(tmp_path):
    script = text()
    script += "sph_write kernel 1 3 11 t.txt\nsph_write state 1 5 t.txt 1000 1100\n"
    run(write(tmp_path, script), ranks=2)
    blocks = (tmp_path / "t.txt").read_text().split("\n\n\n")
    assert [len(np.loadtxt(block.splitlines())) for block in blocks] == [11, 5]
    assert "wendland/c2" in blocks[0] and "support 0.1" in blocks[0]
    assert "# r W dW/dr" in blocks[0] and "# density pressure sound energy/mass" in blocks[1]


def test_the_table_holds_the_force_of_two_particles(tmp_path):
    """No run was needed before; a run after it uses the same kernel."""
    lmp = scene()
    path = tmp_path / "kernel.txt"
    lmp.command(f"sph_write kernel 1 1 5 {path}")
    lmp.commands_string("""
        pair_coeff 4 4 boundary
        create_atoms 1 single 0 0 0
        create_atoms 1 single 0.05 0 0
        run 0""")
    w, slope = np.loadtxt(path)[[0, 2], 1], np.loadtxt(path)[2, 2]
    rho = w.sum()
    p = max(400 * 1000 / 7 * ((rho / 1000) ** 7 - 1), 0)
    force = lmp.numpy.extract_atom("f")[1, 0]
    assert math.isclose(force, -2 * p / rho**2 * slope, rel_tol=1e-12) and force > 0


ERRORS = {
    "table": ("sph_write forces 1 1 10 x", r"sph_write: table is 'forces'.*kernel or state"),
    "rows": ("sph_write kernel 1 1 1 x", r"number of rows is '1'.*from 2"),
    "type": ("sph_write kernel 1 9 5 x", r"second type is '9'.*1 to 4"),
    "unknown": ("sph_write kernel 1 4 5 x", r"nothing was said of type 4.*pair_coeff 4 4"),
    "apart": (
        "pair_coeff 4 4 boundary\nsph_write kernel 3 4 5 x",
        r"types 3 and 4 are boundaries that never.*fluid",
    ),
    "wall": ("sph_write state 3 5 x 1 2", r"type 3 is a boundary.*give a fluid"),
    "none": (
        "pair_coeff 4 4 none\nsph_write state 4 5 x 1 2",
        r"type 4 is a type of the role none",
    ),
    "no kernel": (
        "pair_coeff 4 4 none\nsph_write kernel 1 4 5 x",
        r"type 4 is a type of the role none, without kernel.*give a fluid",
    ),
    "range": ("sph_write state 1 5 x 2 1", r"density 2 to 1 is no range"),
    "density": ("sph_write state 1 5 x 0 1", r"lowest density is '0'.*> 0"),
    "short": ("sph_write state 1 5 x 1", r"highest density is missing"),
    "long": ("sph_write kernel 1 1 5 x y", r"'y' is one word too many"),
    "place": (
        "sph_write kernel 1 1 5 no/such/place",
        r"cannot write file 'no/such/place' \(No such",
    ),
    "no pair": ("pair_style zero 1\nsph_write kernel 1 1 5 x", r"pair_style zero has no kernel"),
}


@pytest.mark.parametrize("name", ERRORS)
def test_errors(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    commands, message = ERRORS[name]
    with pytest.raises(Exception, match=message):
        scene().commands_string(commands)


def test_no_box():
    lmp = instance()
    with pytest.raises(Exception, match=r"sph_write: there is no box yet"):
        lmp.command("sph_write kernel 1 1 5 x")

"""Lattices of water against closed formulas, and small scenes beside walls and between drops."""

from __future__ import annotations

import io
import math
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from scipy.integrate import quad

from sphcloth.results import points_table
from sphcloth.validation import lattice, water
from sphcloth.validation.runner import Runner

SUMS = {2: lattice.density_sum, 3: lattice.cubic_density_sum}


def runner(tmp_path: Path, name: str) -> Runner:
    return Runner(water.FOLDER / f"in.{name}", tmp_path, 1, Console(file=io.StringIO()))


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("kernel", lattice.KERNELS)
def test_virial_of_a_lattice_is_the_derivative_of_its_energy(kernel: str, dimension: int) -> None:
    """All sides longer by a small share: the density that the particles find, and their work."""
    support, size = 2.7, 1e-5

    def density(scale: float) -> float:
        return SUMS[dimension](kernel, support / scale) / scale**dimension

    slope = (density(1 + size) - density(1 - size)) / (2 * size)
    expected = -slope / density(1.0) ** 2 / dimension
    assert lattice.virial(kernel, support, dimension) == pytest.approx(expected, rel=1e-4)


def test_density_beside_a_plane_is_the_sum_and_the_integral_behind_it(tmp_path: Path) -> None:
    support, distance = 2, 0.5
    found = water.corner(runner(tmp_path, "corner"), support, distance)
    shape = lattice.KERNELS["wendland/c2"]
    norm = 21 / (2 * math.pi)
    along = np.arange(-support, support + 1)
    x, y, z = np.meshgrid(along, along, along[along >= 0])
    q = np.sqrt(x**2 + y**2 + z**2) / support
    inside = norm * float(np.sum(shape(q[q < 1]))) / support**3

    def slice_of_the_ball(height: float) -> float:
        parts = quad(lambda q: q * float(shape(np.float64(q))), height, 1)[0]
        return 2 * math.pi * norm * parts

    behind = quad(slice_of_the_ball, distance / support, 1)[0]
    expected = inside / lattice.cubic_density_sum("wendland/c2", support) + behind
    assert found["1 wall"] == pytest.approx(expected, abs=2e-4)
    assert 1.05 < found["2 walls"] < found["3 walls"]


def test_a_single_particle_bounces_with_its_energy_in_short_steps(tmp_path: Path) -> None:
    found = water.bounce(runner(tmp_path, "bounce"), "particle", "constant", 2, 0.5)
    assert -0.5 < found["deepest / support"] < -0.1
    assert found["kinetic energy after / before"] == pytest.approx(1.0, abs=0.03)


def test_colliding_drops_keep_energy_to_second_order(tmp_path: Path) -> None:
    at = runner(tmp_path, "drops")
    coarse, fine = (water.drops(at, "constant", {"dt": dt}) for dt in (8e-4, 2e-4))
    ratio = coarse["change of the energy"] / fine["change of the energy"]
    assert ratio == pytest.approx(4**2, rel=0.1)
    block = water.drops(at, "block", {"limits": "acoustic 0.25 ratio 4"})
    assert block["particle updates"] < 0.3 * fine["particle updates"]
    assert abs(block["change of the energy"]) < 0.01


def test_points_are_shown_as_a_table(capsys: pytest.CaptureFixture) -> None:
    print(points_table([{"what": "drop", "deepest": -0.123456}]))
    assert capsys.readouterr().out.splitlines()[-1] == "| drop | -0.1235 |"

"""The pytest plugin: what passes, what fails and how it says so."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest
from conftest import make_frame, square_sheet

from sphcloth import testing

pytest_plugins = ["pytester"]

MESH, SHEET = square_sheet(4)

SCENE = """
units           si
dimension       2
boundary        p p p
atom_style      sph
comm_modify     vel yes
variable        speed index 0.0
variable        push index 0.0
region          box block 0 1 0 1 -0.05 0.05
create_box      1 box
mass            1 $(1000.0*0.1^2/1.0079)
lattice         sq 0.1 origin 0.5 0.5 0
create_atoms    1 box
velocity        all set ${speed} 0 0 units box
pair_style      sph/tait 0.3
pair_coeff      1 1 fluid 1000.0 c0 20
timestep        1e-3
fix             step all sph/integrate constant
fix             flat all enforce2d
fix             push all gravity ${push} vector 1 0 0
compute         water all sph/atom density
thermo_style    custom step time ke
thermo_modify   line yaml
thermo          10
dump            all all custom 10 water.lammpstrj id type x y z vx vy vz c_water
dump_modify     all sort id colname c_water rho format float %20.15g
write_data      water.data nofix
run             20
"""

TESTS = f"""
import pytest
from sphcloth.testing import assert_density_within, assert_momentum_kept
SCENE = '''{SCENE}'''

def test_flow(sphcloth_run):
    run = sphcloth_run(SCENE, ranks=2, speed=0.5)
    assert run.thermo["Time"][-1] == pytest.approx(0.02)
    assert_momentum_kept(run.trajectory, run.masses, within=1e-12)
    assert_density_within(run.trajectory, 1000.0, within=0.01)

def test_push(sphcloth_run):
    run = sphcloth_run(SCENE, speed=0.5, push=1.0)
    assert_momentum_kept(run.trajectory, run.masses, within=1e-12)

def test_dense(sphcloth_run):
    run = sphcloth_run(SCENE)
    assert_density_within(run.trajectory, 950.0, within=0.01)

def test_broken(sphcloth_run):
    sphcloth_run("units si\\nnonsense\\n")

def test_missing(sphcloth_run):
    sphcloth_run("in.missing")
"""


def test_runs_and_assertions(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(TESTS)
    result = pytester.runpytest("-p", "no:cacheprovider")
    result.assert_outcomes(passed=1, failed=4)
    result.stdout.fnmatch_lines(
        [
            "*AssertionError: momentum went from [[]*to*at step 20: a change of 0.0375* allowed",
            "*AssertionError: a density is off by 4.97*% of 950 at step *, 1.000% allowed",
            "*in.scene fails: ERROR: Unknown command: nonsense*",
            "no script in.missing",
        ]
    )
    assert "sphcloth/testing.py" not in result.stdout.str(), "the trace ends in the user's test"


def test_nothing_heavy_loads_with_pytest(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("def test_nothing(): pass")
    code = (
        "import sys, pytest; assert pytest.main(['-p', 'no:hypothesispytest']) == 0; "
        "assert 'sphcloth.testing' in sys.modules; "
        "print('loaded', [m for m in ('MDAnalysis', 'numpy', 'scipy', 'rich') if m in sys.modules])"
    )
    assert "loaded []" in pytester.run(sys.executable, "-c", code).stdout.str()


def test_crossings_name_the_particle() -> None:
    above, below = ([0.3, 0.27, z] for z in (0.1, -0.1))
    frames = [make_frame(0, [above], SHEET), make_frame(1, [below], SHEET)]
    testing.assert_no_crossings(MESH, frames[:1] * 2)
    with pytest.raises(
        AssertionError, match=r"1 particles .* particle 1001 before step 1 at \[0.3"
    ):
        testing.assert_no_crossings(MESH, frames)


def test_references_show_the_worst_value() -> None:
    exact = np.array([1.0, 2.0, 3.0])
    testing.assert_close_to_reference(exact * 1.009, exact, within=0.01)
    with pytest.raises(
        AssertionError, match=r"u: relative error 0.1336.* at \(1,\): 2.5 instead of 2"
    ):
        testing.assert_close_to_reference([1.0, 2.5, 3.0], exact, 0.01, "u")
    with pytest.raises(AssertionError, match=r"shape \(2,\), the reference has \(3,\)"):
        testing.assert_close_to_reference([1.0, 2.0], exact, 0.01)
    with pytest.raises(AssertionError, match="nan instead of 2"):
        testing.assert_close_to_reference([1.0, np.nan, 3.0], exact, 0.01)


@pytest.mark.parametrize("bad", [np.nan, np.inf, 900.0])
@pytest.mark.parametrize("place", [0, 1, 2])
def test_a_density_that_is_off_in_any_frame_is_found(bad: float, place: int) -> None:
    frame = make_frame(0, [[0, 0, 0]], np.empty((0, 3)))
    frames = [
        replace(frame, step=step, columns=frame.columns | {"rho": np.array([1000.0 + step])})
        for step in range(3)
    ]
    kind = int(frame.types[0])
    testing.assert_density_within(frames, 1000.0, 0.01, kind)
    frames[place] = replace(
        frame, step=place, columns=frame.columns | {"rho": np.array([float(bad)])}
    )
    with pytest.raises(AssertionError, match=f"is off by .* at step {place}"):
        testing.assert_density_within(frames, 1000.0, 0.01, kind)


def test_nothing_holds_of_no_frame_and_of_no_value() -> None:
    with pytest.raises(AssertionError, match="there is no frame"):
        testing.assert_density_within([], 1000.0, 0.01)
    with pytest.raises(AssertionError, match="there is no frame"):
        testing.assert_momentum_kept([], 1.0, 0.01)
    with pytest.raises(AssertionError, match="u: there is no value"):
        testing.assert_close_to_reference([], [], 0.1, "u")


def test_momentum_that_is_not_a_number_is_not_kept() -> None:
    frame = make_frame(0, [[0, 0, 0]], np.empty((0, 3)))
    flying = replace(
        frame, columns=frame.columns | {c: np.array([np.nan]) for c in ("vx", "vy", "vz")}
    )
    with pytest.raises(AssertionError, match="momentum went"):
        testing.assert_momentum_kept([flying, flying], 1.0, within=1.0)

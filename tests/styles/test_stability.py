"""The limit of stability against the exact one, from the eigenvalues of a whole scene."""

import numpy as np
import pytest
from harness import by_id, instance
from scenes import FLUID, box, header, neighbor, sph_tait
from step_scenes import (
    LATTICE_SUM,
    RHO0,
    SOUND,
    SPACING,
    VOLUME,
    dt_and_limit,
    growth_in,
    soaked,
)
from test_stepping import ACOUSTIC, VISCOUS, WETTED

THIN = 1.12 * SPACING
ALONE = "velocity 0 force 0 density 0 max 1 mass_scaling no"


def wendland_slope(r, support):
    """Return (1/r) dW/dr of Wendland C2 in space."""
    return -20 * 21 / (2 * np.pi * support**5) * np.maximum(1 - r / support, 0) ** 3


def longest_stable_step(lmp, support=2 * SPACING, least_density=0.0):
    """Return 2 over the largest frequency of all particles and vertices together."""
    x, rho, kind = (by_id(lmp, name) for name in ("x", "rho", "type"))
    mass = lmp.numpy.extract_atom("mass")[kind]
    low, high = lmp.extract_box()[:2]
    apart = x[:, None] - x[None]
    apart -= (np.array(high) - low) * np.round(apart / (np.array(high) - low))
    r = np.linalg.norm(apart, axis=2)
    slope = wendland_slope(r, support)
    np.fill_diagonal(slope, 0)
    water = kind == 1
    felt = np.where(water, mass, RHO0 * VOLUME)
    gradient = (felt[None] * slope)[..., None] * apart
    change = -gradient
    change[np.arange(len(x)), np.arange(len(x))] = gradient.sum(axis=1)
    rho = np.where(water, np.maximum(rho, least_density), rho)
    sound = SOUND * (rho / RHO0) ** 3
    change *= (sound * np.sqrt(mass) / np.maximum(rho, 1))[:, None, None]
    change /= np.sqrt(mass)[None, :, None]
    rows = change[water].reshape(water.sum(), -1)
    return 2 / np.sqrt(np.linalg.eigvalsh(rows @ rows.T)[-1])


@pytest.mark.parametrize(("areal", "n"), [(200.0, 10), (4.0, 12), (0.1, 18)])
def test_a_step_above_the_exact_limit_explodes_and_the_limit_does_not(areal, n):
    with soaked(areal, f"global {ALONE} stability 1") as lmp:
        exact = longest_stable_step(lmp)
        step, by = dt_and_limit(lmp)
    assert 0.6 * exact < step < exact
    assert by == (ACOUSTIC if areal == 200 else WETTED)
    assert growth(areal, 0.97 * exact, 40) < 3
    assert growth(areal, 1.05 * exact, n) > 30


def test_water_in_free_flight_has_the_limit_of_the_pressure_that_it_will_have():
    """Thin water that flies together, as spray before it meets water, has no pressure yet."""
    half = 2.6 * THIN
    with instance() as lmp:
        lmp.commands_string(
            header(atoms=FLUID)
            + box("-1 1 -1 1 -1 1")
            + f"mass 1 {RHO0 * SPACING**3 / LATTICE_SUM}\n"
            + f"lattice sc {THIN}\nregion block block {f'-{half} {half} ' * 3} units box\n"
            + "create_atoms 1 region block\n"
            + sph_tait(f"1 1 fluid {RHO0} c0 {SOUND}", options="tension no")
            + neighbor(0.03)
            + f"velocity all ramp vx 100 -100 x -{half} {half} units box\n"
            + f"timestep 1e-3\nfix step all sph/integrate global {ALONE} stability 1\nrun 0 post no"
        )
        step, by = dt_and_limit(lmp)
        assert by == ACOUSTIC
        assert by_id(lmp, "rho").max() < 0.8 * RHO0
        assert 0.5 < step / longest_stable_step(lmp, least_density=RHO0) < 1


def growth(areal, step, n):
    """By how much the energy of small velocities grows in constant steps."""
    with soaked(areal, "constant") as lmp:
        return growth_in(lmp, f"timestep {step}\nrun {n} post no")


@pytest.mark.parametrize("scheme", ["global", "individual", "block"])
@pytest.mark.parametrize("steps", [1.3, 2.3, 3.2])
def test_output_times_feed_nothing(scheme, steps):
    """A shorter step after every few whole ones would: two steps swing in resonance."""
    with soaked(200.0, f"global {ALONE}") as lmp:
        interval = steps * dt_and_limit(lmp)[0]
    with soaked(200.0, f"global {ALONE} output {interval}") as lmp:
        assert growth_in(lmp, f"run_style sph/adaptive {scheme}\nrun 150 post no") < 3


def test_the_limit_is_found_again_where_it_changes():
    """At most 8 steps later, and at once in a run with other coefficients."""
    with soaked(4.0, f"global {ALONE}") as lmp:
        usual = dt_and_limit(lmp)[0]
        lmp.command("run 3 post no")
        stable = lmp.numpy.extract_fix("step", 1, 2)[: lmp.extract_setting("nlocal"), 3:]
        assert stable[:, 0][stable[:, 0] > 0].min() == pytest.approx(usual, rel=0.05)
        assert set(np.unique(stable[:, 1])) <= {0, ACOUSTIC, WETTED}
        lmp.command(f"pair_coeff 1 1 fluid {RHO0} c0 {4 * SOUND}")
        lmp.command("run 0 post no")
        assert dt_and_limit(lmp)[0] == pytest.approx(usual / 4, rel=0.05)


def test_friction_of_light_vertices_limits_the_step():
    """By the ratio of the masses, as it slows them down."""
    found = []
    for areal in (0.4, 0.1):
        with soaked(areal, f"global {ALONE}", fluid="c0 0.1 nu 1") as lmp:
            found.append(dt_and_limit(lmp))
    assert found[0][1] == found[1][1] == VISCOUS
    assert found[0][0] == pytest.approx(4 * found[1][0], rel=0.1)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("stability 1.1", "stability is '1.1': give a number from 0 to 1"),
        ("stability 0.9 acoustic 0.5", "takes the place of acoustic, viscous and wetted"),
        ("wetted 1 stability 0.5", "takes the place of acoustic, viscous and wetted"),
    ],
)
def test_bad_input_is_named(words, message):
    with pytest.raises(Exception, match=message):
        soaked(4.0, f"global {words}")


@pytest.mark.parametrize("words", ["acoustic 0.5", "wetted 0.5", "viscous 0.2", "stability 0"])
def test_nothing_is_summed_where_another_limit_is_asked_for(words):
    with soaked(4.0, f"global {words}") as lmp:
        assert (lmp.numpy.extract_fix("step", 1, 2)[:512, 3:] == 0).all()


def test_water_that_begins_to_fall_is_not_compressed_by_a_long_step():
    """At first nothing is under pressure, and the step is as long as the ceiling.

    It compresses itself by 0.05 % in the step in which it meets the floor; in a step that was
    chosen two steps before it is 2 %, and then the water is thrown upwards.
    """
    dx, sound = 0.05, 70.0
    with instance() as lmp:
        lmp.commands_string(
            header("f f f", FLUID)
            + box("-0.2 0.7 -0.2 0.7 -0.2 2.2")
            + f"mass 1 {RHO0 * dx**3}\nlattice sc {dx} origin 0.5 0.5 0.5\n"
            + "region column block 0 0.5 0 0.5 0 2 units box\ncreate_atoms 1 region column\n"
            + sph_tait(
                f"1 1 fluid {RHO0} c0 {sound} alpha 0.06", support=2 * dx, options="kernel cubic"
            )
            + neighbor(0.1)
            + """fix tank all wall/sph xlo -0.025 xhi 0.525 ylo -0.025 yhi 0.525 zlo -0.025 &
  pressure mirror
fix gravity all gravity 9.81 vector 0 0 -1
timestep 0.01
fix step all sph/integrate global
run_style sph/adaptive global
run 1 post no
"""
        )
        assert lmp.extract_global("dt") == 0.01
        compressed = 0.0
        for _ in range(15):
            lmp.command("run 1 pre no post no")
            compressed = max(compressed, lmp.extract_fix("step", 0, 1, 3))
        assert lmp.extract_global("dt") < 0.002
    assert compressed < 0.006

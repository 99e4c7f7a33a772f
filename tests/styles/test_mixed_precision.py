"""pair_style sph/tait with precision mixed against double, wherever the box is and in any units."""

import numpy as np
import pytest
from harness import by_id, instance
from reference_sph import lattice
from scenes import FLUID, box, filled, header, jitter, neighbor, sph_tait
from scenes import lattice as lattice_of


@pytest.mark.parametrize("length", [1e-9, 1e10])
@pytest.mark.parametrize("density", ["summation", "continuity delta 0.1"])
def test_mixed_precision_holds_for_any_size_of_the_numbers(length, density):
    """As in units real, or for drops of nanometers in SI: 1/H^5 is beyond single precision."""
    given = lambda s: f"precision {s} density {density}"  # noqa: E731
    double, mixed = (scaled_row(length, given(s)) for s in ("double", "mixed"))
    assert np.abs(double).max() > 0
    np.testing.assert_allclose(mixed, double, rtol=1e-5, atol=1e-5 * np.abs(double).max())


def scaled_row(length, setting):
    """Forces and densities of particles that approach each other, with friction and diffusion."""
    lmp = instance()
    lmp.commands_string(
        header("f f f", "sph")
        + box(" ".join(f"{side * length}" for side in (-1, 1) * 3), 2)
        + f"mass * {0.125 * length**3}\nregion all block INF INF INF INF INF INF\n"
        + "".join(
            f"create_atoms {kind} single {x * length} 0 0 units box\n"
            for kind, x in ((1, 0), (1, 0.05), (1, 0.02), (2, -0.04))
        )
        + f"velocity all ramp vx 0 -2 x {-length} {length} units box\n"
        + "set type 1 sph/rho 1010\nset atom 2 sph/rho 1030\n"  # not linear: it diffuses
        + sph_tait(
            f"1 1 fluid 1000 c0 20 alpha 0.1 nu {1e-3 * length}",
            f"2 2 boundary volume {1e-4 * length**3}",
            support=0.1 * length,
            options=setting,
        )
        + f"neighbor {0.03 * length} bin\ngroup water type 1\ntimestep {1e-3 * length}\n"
        + "fix step water sph/integrate constant\nrun 1\n"
    )
    return np.concatenate([by_id(lmp, "f")[:, 0] / length**2, by_id(lmp, "rho")[:3] - 1000])


def test_mixed_precision_does_not_depend_on_where_the_box_is():
    """Integer coordinates: far from the origin the same digits."""

    def forces(shift):
        lmp = lattice("run 0", setting="precision mixed")
        lmp.commands_string(f"""
            change_box all x final {-0.2 + shift} {0.2 + shift} units box
            displace_atoms all move {shift} 0 0 units box
            run 0""")
        return by_id(lmp, "f")

    near, far = forces(0.0), forces(1000.0)
    np.testing.assert_allclose(far, near, atol=1e-5 * np.abs(near).max())


@pytest.mark.parametrize(
    ("shape", "length"), [("block", 1e2), ("block", 1e4), ("block", 1e6), ("prism", 1e2)]
)
def test_mixed_precision_does_not_depend_on_how_long_the_box_is(shape, length):
    """Water on both sides of the periodic face at its end, in supports of 0.1."""

    def forces(precision):
        lmp = instance()
        tilt = f" 0 0 {0.3 * length}" if shape == "prism" else ""
        lmp.commands_string(
            header(atoms=FLUID)
            + box(f"-0.2 0.2 -0.2 0.2 {-0.3 * length} {0.7 * length}{tilt}", 1, shape)
            + lattice_of()
            + filled("water", f"INF INF INF INF {-0.3 * length} {-0.3 * length + 0.4}")
            + f"mass 1 0.125\n{jitter(0.004, 7)}displace_atoms all move 0 0 -0.21 units box\n"
            + sph_tait("1 1 fluid 1000 c0 20", options=f"tension yes precision {precision}")
            + neighbor(0.03)
            + "run 0\n"
        )
        return by_id(lmp, "x"), by_id(lmp, "f")

    (x, double), (_, mixed) = forces("double"), forces("mixed")
    assert len(x) == 512 and np.ptp(x[:, 2]) > 0.9 * length
    np.testing.assert_allclose(mixed, double, atol=1e-5 * np.abs(double).max())


@pytest.mark.parametrize(
    ("rho0", "sound", "refused"),
    [
        (1e3, 20, False),
        (1e-10, 1e9, False),
        (1e38, 20, True),
        (1e-20, 1e9, True),  # c0^2/rho0 is 1e38, and what is summed of it no number
        (1e20, 1e-8, True),
    ],
)
def test_what_single_precision_cannot_hold_is_refused(rho0, sound, refused):
    def forces(precision):
        lmp = lattice(setting=f"precision {precision}")
        lmp.commands_string(f"""
            mass * {rho0 * 0.05**3}
            set group all sph/rho {1.01 * rho0}
            pair_coeff * * fluid {rho0} c0 {sound}
            run 0""")
        return by_id(lmp, "f")

    double = forces("double")
    if refused:
        with pytest.raises(
            Exception, match=r"sph/tait: precision mixed: density .* of type 1 must"
        ):
            forces("mixed")
    else:
        np.testing.assert_allclose(forces("mixed"), double, atol=1e-5 * np.abs(double).max())

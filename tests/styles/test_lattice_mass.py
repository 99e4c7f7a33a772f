"""pair_coeff ... spacing of pair_style sph/tait: the mass of a particle of a lattice."""

import math

import numpy as np
import pytest
from harness import by_id, instance
from reference_sph import C0, KERNELS, RHO0, H

from sphcloth.validation.cases import pour


def with_spacing(coeff="spacing 0.05", *, dimension=3, before="", kernel="wendland/c2"):
    """A lattice of spacing 0.05, its mass by the pair style."""
    lmp = instance()
    z = "0 0.4" if dimension == 3 else "-0.01 0.01"
    lmp.commands_string(f"""
        units si
        dimension {dimension}
        atom_style sph
        atom_modify map array
        comm_modify vel yes
        lattice {"sc" if dimension == 3 else "sq"} 0.05
        region box block 0 0.4 0 0.4 {z} units box
        create_box 1 box
        create_atoms 1 box
        {before}
        pair_style sph/tait {H} kernel {kernel}
        pair_coeff 1 1 fluid {RHO0} {coeff} c0 {C0}
        neighbor 0.02 bin""")
    return lmp


def mass_of_lattice(kernel, dimension=3, spacing=0.05, support=H):
    n = np.arange(-9, 10) * spacing
    grid = np.stack(np.meshgrid(*[n] * dimension), axis=-1).reshape(-1, dimension)
    q = np.linalg.norm(grid, axis=1) / support
    w = KERNELS[kernel][0](q[q < 1]) * (H / support) ** 3
    if dimension == 2:  # the kernels above have the constant of three dimensions
        w *= {"wendland/c2": H * (7 / math.pi) / (21 / (2 * math.pi)), "cubic": H * 5 / 7}[kernel]
    return RHO0 / w.sum()


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("kernel", ["wendland/c2", "cubic"])
def test_spacing_gives_a_lattice_the_rest_density(kernel, dimension):
    lmp = with_spacing(kernel=kernel, dimension=dimension)
    lmp.command("run 0")
    np.testing.assert_allclose(by_id(lmp, "rho"), RHO0, rtol=1e-12)
    mass = lmp.extract_atom("mass")[1]
    np.testing.assert_allclose(mass, mass_of_lattice(kernel, dimension), rtol=1e-12)


def test_mass_of_a_lattice_follows_kernel_support_and_spacing():
    lmp = with_spacing("spacing 0.05 support 0.15")
    mass = lmp.extract_atom("mass")
    np.testing.assert_allclose(mass[1], mass_of_lattice("wendland/c2", support=0.15), rtol=1e-12)
    lmp.command(f"pair_coeff 1 1 fluid {RHO0} c0 {C0} spacing 0.05")
    lmp.command(f"pair_style sph/tait {H} kernel quintic")
    np.testing.assert_allclose(mass[1], mass_of_lattice("quintic"), rtol=1e-12)
    lmp.command(f"pair_style sph/tait {H} kernel cubic")
    lmp.command("run 0")
    np.testing.assert_allclose(by_id(lmp, "rho"), RHO0, rtol=1e-12)
    lmp.command(f"pair_coeff 1 1 fluid {RHO0} c0 {C0} spacing 0.04")
    np.testing.assert_allclose(mass[1], mass_of_lattice("cubic", spacing=0.04), rtol=1e-12)


@pytest.mark.parametrize("density", pour.DENSITIES)
def test_the_case_pour_knows_the_mass_of_its_particles(density):
    lmp = with_spacing(
        f"spacing 0.05 support {0.05 * pour.SUPPORT}", kernel=f"{pour.KERNEL} density {density}"
    )
    lmp.command("run 0")
    mass = pour.particle_mass({"density": density}, 0.05) * RHO0 / pour.RHO0
    np.testing.assert_allclose(lmp.extract_atom("mass")[1], mass, rtol=1e-12)


def test_mass_of_a_lattice_in_restart_and_data_files(tmp_path):
    lmp = with_spacing()
    lmp.commands_string(f"write_restart {tmp_path}/r\nwrite_data {tmp_path}/d\nrun 0")
    again = instance()
    again.commands_string(f"comm_modify vel yes\nread_restart {tmp_path}/r\nrun 0")
    np.testing.assert_allclose(by_id(again, "rho"), RHO0, rtol=1e-12)
    again.command(f"pair_style sph/tait {H} kernel cubic")
    np.testing.assert_allclose(again.extract_atom("mass")[1], mass_of_lattice("cubic"), rtol=1e-12)
    data = instance()
    data.commands_string(f"""
        units si
        atom_style sph
        comm_modify vel yes
        pair_style sph/tait {H}
        read_data {tmp_path}/d
        run 0""")
    np.testing.assert_allclose(by_id(data, "rho"), RHO0, rtol=1e-12)


def test_a_mass_that_agrees_with_the_lattice_is_fine():
    lmp = with_spacing(before="mass 1 $(1000.0*0.05^3/1.03384)")
    lmp.command("run 0")
    np.testing.assert_allclose(by_id(lmp, "rho"), RHO0, rtol=1e-12)


def test_a_mass_that_contradicts_the_spacing_is_an_error():
    both = r"spacing of type 1 is '0.05', which makes its mass 0.12.*'mass 1' is 0.125: leave out"
    with pytest.raises(Exception, match=both):
        with_spacing(before="mass 1 0.125")
    lmp = with_spacing()
    lmp.command("mass 1 0.125")
    with pytest.raises(Exception, match=both):
        lmp.command("run 0")


def test_spacing_needs_a_mass_of_the_type_and_neighbors():
    each = "fix mass all property/atom rmass ghost yes"
    with pytest.raises(Exception, match=r"leave out 'spacing' and use 'set type 1 mass 0\.12"):
        with_spacing(before=each)
    for spacing in (0.11, 1e-4):
        with pytest.raises(Exception, match=f"spacing of type 1 is '{spacing}'.*neighbors"):
            with_spacing(f"spacing {spacing}")

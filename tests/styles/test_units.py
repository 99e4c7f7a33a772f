"""The same scene in other units gives the same physics, per-atom output and cloth included."""

import numpy as np
import pytest
from harness import by_id, instance

# Numeric values of 1 m, 1 kg and 1 s; lj has no units of its own, so any will do.
DALTON = 1.66053906660e-27
UNITS = {
    "si": (1.0, 1.0, 1.0),
    "cgs": (100.0, 1000.0, 1.0),
    "lj": (1 / 0.05, 1 / 0.125, 7.3),
    "micro": (1e6, 1e15, 1e6),
    "nano": (1e9, 1e21, 1e9),
    "real": (1e10, 1 / DALTON, 1e15),
    "metal": (1e10, 1 / DALTON, 1e12),
}
# columns of compute sph/atom with their powers of length, mass and time
COLUMNS = {
    "density": (-3, 1, 0),
    "pressure": (-1, 1, -2),
    "energy": (2, 1, -2),
    "sound": (1, 0, -1),
    "volume": (3, 0, 0),
    "neighbors": (0, 0, 0),
    "dt": (0, 0, 1),
    "active": (0, 0, 0),
}
# what LAMMPS calls a unit of pressure and of energy, in SI
PRESSURE = {"real": 101325.0, "metal": 1e5}
ENERGY = {"real": 4184 / 6.02214076e23, "metal": 1.602176634e-19}


def places():
    """A jittered block of water over a floor, the same for all units."""
    rng = np.random.default_rng(5)
    grid = (np.indices((6, 6, 5)).reshape(3, -1).T + 0.5) * 0.05 - [0.15, 0.15, 0]
    water = grid + rng.uniform(-0.004, 0.004, grid.shape)
    floor = np.array([[x, y, -0.2] for x in grid[::5, 0] for y in (0.0, 0.05)])
    velocity = rng.uniform(-0.3, 0.3, grid.shape) - [0, 0, 3.0]
    return water, floor, velocity


def scene(units, gravity):
    length, mass, time = UNITS[units]
    water, floor, velocity = places()
    lmp = instance()
    lmp.commands_string(f"""
        units {units}
        atom_style hybrid sph molecular
        atom_modify map yes
        comm_modify vel yes
        boundary p p f
        region box block {-0.5 * length} {0.5 * length} {-0.5 * length} {0.5 * length} &
          {-0.4 * length} {0.6 * length} units box
        create_box 3 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
          extra/angle/per/atom 8 extra/dihedral/per/atom 8
        mass * {0.125 * mass}
        special_bonds lj/coul 1 1 1""")
    n = len(water)
    lmp.create_atoms(
        n,
        None,
        [1] * n,
        (water * length).ravel().tolist(),
        (velocity * length / time).ravel().tolist(),
    )
    lmp.create_atoms(len(floor), None, [3] * len(floor), (floor * length).ravel().tolist())
    lmp.commands_string(f"""
        create_cloth 2 {40.0 * mass / length**2} center 0 0 0 &
          size {0.5 * length} {0.5 * length} spacing {0.05 * length} group cloth
        group water type 1
        pair_style sph/tait {0.1 * length}
        pair_coeff 1 1 fluid {1000 * mass / length**3} c0 {5 * length / time} alpha 0.1 &
          nu {1e-2 * length**2 / time}
        pair_coeff 2*3 2*3 boundary pressure own
        bond_style pbd
        bond_coeff 1 1.0
        angle_style zero
        angle_coeff *
        dihedral_style pbd
        dihedral_coeff 1 0.1
        neighbor {0.03 * length} bin
        neigh_modify every 1 delay 0 check yes
        timestep {0.003 * time}
        {f"fix gravity all gravity {9.81 * length / time**2} vector 0 0 -1" if gravity else ""}
        fix step water sph/integrate global
        fix sheet cloth pbd/cloth iterations 5 damping {2 / time}
        fix contact water cloth/contact {0.02 * length}
        compute state all sph/atom {" ".join(COLUMNS)}
        thermo_style custom step dt pe ke
        run 20""")
    return lmp


def in_si(lmp, units):
    """Everything that there is to see, in SI."""
    length, mass, time = UNITS[units]
    owned = lmp.extract_setting("nlocal")
    order = np.argsort(lmp.numpy.extract_atom("id")[:owned])
    state = np.array(lmp.numpy.extract_compute("state", 1, 2))[:owned][order].T
    seen = {"x": by_id(lmp, "x") / length, "v": by_id(lmp, "v") * time / length}
    for (name, (a, b, c)), values in zip(COLUMNS.items(), state, strict=True):
        unit = length**a * mass**b * time**c
        if name == "pressure":
            unit = 1 / PRESSURE.get(units, 1 / unit)
        if name == "energy":
            unit = 1 / ENERGY.get(units, 1 / unit)
        seen[name] = values / unit
    seen["step"] = np.array([lmp.get_thermo("dt")]) / time
    seen["contacts"] = np.array([lmp.extract_fix("contact", 0, 1, 0)])
    return seen


def largest_differences(units, gravity):
    one, other = in_si(scene("si", gravity), "si"), in_si(scene(units, gravity), units)
    assert one["contacts"][0] > 0 and one["pressure"].max() > 0 and one["step"][0] < 0.003
    return {
        name: np.abs(values - other[name]).max() / np.abs(values).max()
        for name, values in one.items()
    }


@pytest.mark.parametrize("gravity", [True, False])
@pytest.mark.parametrize("units", ["cgs", "lj", "micro", "nano"])
def test_units_that_need_no_conversion(units, gravity):
    for name, difference in largest_differences(units, gravity).items():
        assert difference < 1e-11, name


@pytest.mark.parametrize("units", ["real", "metal"])
def test_units_with_conversions(units):
    """LAMMPS's constants have seven to ten digits; fix gravity knows none of them, so without."""
    for name, difference in largest_differences(units, False).items():
        limit = 1e-6 if name in ("pressure", "energy") else 1e-11
        assert difference < limit, name

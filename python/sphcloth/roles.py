"""What the atoms of a scene are: water, walls, or vertices of cloth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh, read_sections
from sphcloth.strings import Strings


@dataclass(frozen=True)
class Roles:
    """Which atom types are what, as a data file tells.

    Attributes:
        fluid: types of water; None if the file does not say.
        walls: types of boundary particles.
        mesh: triangles of cloth and obstacles; None if there are none.
        volume: type of water -> volume of a particle at rest, an area in two dimensions.
        rest_density: type of water -> density at rest.
        strings: edges beside the triangles; None if there are none.
    """

    fluid: frozenset[int] | None = None
    walls: frozenset[int] = frozenset()
    mesh: ClothMesh | None = None
    volume: dict[int, float] = field(default_factory=dict)
    rest_density: dict[int, float] = field(default_factory=dict)
    strings: Strings | None = None

    @classmethod
    def read(cls, data: Path) -> Roles:
        """Read the roles from a file by ``write_data``.

        The coefficients of ``pair_style sph/tait`` name them; without those, as in a scene of
        cloth alone, no type is known to be water.

        Raises:
            UserError: no such file, or one of another form.
        """
        sections = read_sections(data)
        angles = sections.get("Angles")
        mesh = ClothMesh.of_angles(angles, data) if angles else None
        bonds = sections.get("Bonds")
        strings = Strings.of_bonds(bonds, mesh, data) if bonds and mesh else None
        words = _coefficients(sections)
        fluid = {int(row[0]): float(row[2]) for row in words if row[1] == "fluid"}
        walls = frozenset(int(row[0]) for row in words if row[1] == "boundary")
        masses = dict(line.split()[:2] for line in sections.get("Masses", []))
        volume = {
            kind: float(masses[str(kind)]) / rho
            for kind, rho in fluid.items()
            if str(kind) in masses
        }
        return cls(frozenset(fluid) if fluid else None, walls, mesh, volume, fluid, strings)

    @classmethod
    def beside(cls, dump: Path) -> Roles:
        """Read the roles from the data file of a dump's name; none are known without it."""
        data = dump.with_suffix(".data")
        return cls.read(data) if data.is_file() else cls()


def _coefficients(sections: Mapping[str, list[str]]) -> list[list[str]]:
    """Return type, role and numbers of each type that has a role."""
    rows = [line.split() for line in sections.get("Pair Coeffs", [])]
    pairs = [line.split() for line in sections.get("PairIJ Coeffs", [])]
    rows += [row[1:] for row in pairs if row[:1] == row[1:2]]
    return [row for row in rows if len(row) > 2 and row[1] in ("fluid", "boundary")]


def parse_types(text: str, option: str) -> frozenset[int]:
    """Turn ``1,3`` into atom types.

    Raises:
        UserError: anything but positive numbers.
    """
    words = text.split(",")
    if not all(word.strip().isdigit() and int(word) > 0 for word in words):
        raise UserError(f"{option} {text}: expected atom types such as 1 or 1,3")
    return frozenset(int(word) for word in words)

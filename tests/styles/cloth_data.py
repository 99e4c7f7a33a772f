"""A cloth as data: its data file, a run of it, and what the run has kept."""

from dataclasses import dataclass, field

import numpy as np
from harness import by_id, instance

EPS = np.finfo(float).eps


@dataclass
class Cloth:
    """Vertices with a mass each, bonds and hinges with their types, and what the fix is told."""

    x: np.ndarray
    rest: np.ndarray
    v: np.ndarray
    mass: np.ndarray
    bonds: list[tuple[int, int, int]]  # two vertices from 0, type
    hinges: list[tuple[int, int, int, int, int]]
    bond_coeffs: list[str]
    hinge_coeffs: list[str] = field(default_factory=lambda: ["0", "0"])
    options: str = "solver gs direction current"
    dt: float = 1e-3
    steps: int = 3
    pins: list[int] = field(default_factory=list)
    box: float = 0.0  # edge of a periodic box around the origin; 0: none, the box follows

    def data(self):
        """A data file: every vertex is of a type of its own, so that it has a mass of its own."""
        n = len(self.x)
        half = 0.5 * self.box or 2 * np.abs(self.x).max() + 1
        folded = self.x - self.box * np.floor(self.x / self.box + 0.5) if self.box else self.x
        image = np.rint((self.x - folded) / self.box).astype(int) if self.box else 0 * self.x
        image = image.astype(int)
        at_most = max(8, 2 * len(self.bonds), 4 * len(self.hinges))
        lines = ["cloth", "", f"{n} atoms", f"{len(self.bonds)} bonds"]
        lines += [f"{len(self.hinges)} dihedrals", f"{n} atom types"]
        lines += [f"{len(self.bond_coeffs)} bond types", f"{len(self.hinge_coeffs)} dihedral types"]
        lines += [f"{at_most} extra bond per atom", f"{at_most} extra dihedral per atom"]
        lines += [f"{-half:.17g} {half:.17g} {d}lo {d}hi" for d in "xyz"]

        def section(name, rows, numbered=True):
            if len(rows):
                lines.extend(["", name, ""])
            for k, row in enumerate(rows):
                words = [f"{w:.17g}" if isinstance(w, float) else str(w) for w in row]
                lines.append(" ".join(([str(k + 1)] if numbered else []) + words))

        section("Masses", [(float(m),) for m in self.mass])
        section(
            "Atoms # molecular",
            [(1, k + 1, *map(float, folded[k]), *image[k]) for k in range(n)],
        )
        section("Velocities", [tuple(map(float, u)) for u in self.v])
        section("rest", [tuple(map(float, r)) for r in self.rest])
        section("Bonds", [(t, i + 1, j + 1) for i, j, t in self.bonds])
        section("Dihedrals", [(t, a + 1, b + 1, c + 1, d + 1) for a, b, c, d, t in self.hinges])
        return "\n".join(lines) + "\n"

    def script(self, newton="on"):
        """Commands up to and without the run; the data file is cloth.data."""
        boundary = "p p p" if self.box else "s s s"
        lines = [f"newton {newton}", "units si", "atom_style molecular", "atom_modify map yes"]
        lines += ["atom_modify sort 0 0", f"boundary {boundary}", "comm_modify vel yes"]
        lines += ["special_bonds lj/coul 1 1 1", "fix rest all property/atom d2_rest 3"]
        lines += ["read_data ${data} fix rest NULL rest", "bond_style pbd"]
        lines += [f"bond_coeff {t} {c}" for t, c in enumerate(self.bond_coeffs, 1)]
        if self.hinges:
            lines += ["dihedral_style pbd"]
            lines += [f"dihedral_coeff {t} {c}" for t, c in enumerate(self.hinge_coeffs, 1)]
        lines += [f"comm_modify cutoff {0.5 * self.box or 1}", "neighbor 0.1 nsq"]
        # no list is renewed, since LAMMPS loses atoms that are further out than digits last
        lines += ["neigh_modify every 1000000 delay 0 check no", f"timestep {self.dt:.17g}"]
        pin = ""
        if self.pins:
            lines += [f"group pins id {' '.join(str(k + 1) for k in self.pins)}"]
            pin = "pin pins"
        lines += [f"fix sheet all pbd/cloth {self.options} rest d2_rest {pin}", "run 0"]
        return "\n".join(lines) + "\n"


def start(cloth, folder, newton="on"):
    """The cloth in LAMMPS, before its first step."""
    path = folder / "cloth.data"
    path.write_text(cloth.data())
    lmp = instance()
    lmp.command(f"variable data index {path}")
    lmp.commands_string(cloth.script(newton))
    return lmp


def unwrapped(lmp, box=0.0):
    """Positions as if there were no periodic box."""
    x = by_id(lmp, "x")
    if not box:
        return x
    return x + box * np.array([lmp.decode_image_flags(int(i)) for i in by_id(lmp, "image")])


def motion(cloth, folder, newton="on"):
    """Positions and velocities at the start and after every step."""
    lmp = start(cloth, folder, newton)
    seen = [(unwrapped(lmp, cloth.box), by_id(lmp, "v"))]
    for _ in range(cloth.steps):
        lmp.command("run 1 pre no post no")
        seen.append((unwrapped(lmp, cloth.box), by_id(lmp, "v")))
    output = [lmp.extract_fix("sheet", 0, 1, k) for k in range(7)]
    return np.array([x for x, _ in seen]), np.array([v for _, v in seen]), output

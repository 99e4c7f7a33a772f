"""The input script of a :class:`~sphcloth.stress.random_scene.RandomScene`, in its units."""

from __future__ import annotations

import math

from sphcloth.stress.random_scene import GRAVITY, RandomScene
from sphcloth.stress.unit_systems import UNITS, Units

# edges of the box from the middle of the sheet, spacings, where nothing is faster than the water
WIDE, DEEP, HIGH = 20, 40, 40
# where drained, where the floor is, and where the plate is, spacings below the sheet
SINK, FLOOR, PLATE = 24, 16, 6


def script_of(scene: RandomScene) -> str:
    """Return the input script."""
    return _Script(scene, UNITS[scene.units]).text()


class _Script:
    """The input script of a scene in a system of units."""

    def __init__(self, scene: RandomScene, units: Units) -> None:
        self.s, self.u, self.dx = scene, units, scene.spacing
        # a sheet that falls, or that the water carries along, stays in the box
        way = 3.0 * scene.speed * scene.time
        self.wide = WIDE * self.dx + way
        self.deep = DEEP * self.dx + way + (GRAVITY * scene.time**2 if scene.gravity else 0.0)

    def q(self, *values: float, unit: str = "m") -> str:
        """Return numbers in these units."""
        return " ".join(f"{value * self.u.of(unit):.15g}" for value in values)

    def text(self) -> str:
        parts = [self._box(), self._atoms(), self._forces(), self._fixes(), self._output()]
        lines = f"# {self.s.told()}\nvariable every index 4    # steps between frames\n"
        return lines + "\n".join(line for part in parts for line in part) + "\n"

    def _box(self) -> list[str]:
        s, dx = self.s, self.dx
        sides = [-self.wide, self.wide, -self.wide, self.wide, -self.deep, HIGH * dx]
        shape = "prism" if s.tilt else "block"
        tilts = [s.tilt, *([0.5 * s.tilt, -s.tilt] if s.boundary == "p p p" else [0.0, 0.0])]
        return [
            f"units {s.units}",
            "atom_style hybrid sph molecular",
            "atom_modify map yes",
            f"newton {s.newton}",
            "comm_modify vel yes",
            f"boundary {s.boundary}",
            f"region box {shape} {self.q(*sides)} "
            + (self.q(*tilts) if s.tilt else "")
            + " units box",
            "create_box 4 box bond/types 2 angle/types 2 dihedral/types 2 "
            "extra/bond/per/atom 10 extra/angle/per/atom 10 extra/dihedral/per/atom 20",
            "special_bonds lj/coul 1.0 1.0 1.0",
            # spacing of the fluids and create_cloth give all others theirs
            *([f"mass 3 {self.q(1.0, unit='kg')}"] if s.sheet == "none" else []),
            *([] if s.plate else [f"mass 4 {self.q(1.0, unit='kg')}"]),
        ]

    def _atoms(self) -> list[str]:
        s = self.s
        lines = [*self._sheet(), *self._plate(), *self._water()]
        lines += ["group water type 1 2"]
        lines += [
            f"set type {kind} sph/rho {self.q(rho, unit='kg/m^3')}"
            for kind, rho in enumerate(s.rest_density, 1)
            if s.density == "continuity" and s.water != "jet"
        ]
        return lines

    def _sheet(self) -> list[str]:
        s, half = self.s, 0.5 * self.s.side
        if s.sheet == "none":
            return []
        slope = f"axes {math.cos(s.slope):.15g} 0 {math.sin(s.slope):.15g} 0 1 0"
        lines, pins = [], ""
        if s.pins == "rim":
            inner = self.q(half - 0.3 * s.edge_length)
            lines = [
                f"region pinned cylinder z 0 0 {inner} INF INF side out units box"
                if s.sheet == "disc"
                else f"region pinned block -{inner} {inner} -{inner} {inner} INF INF "
                "side out units box"
            ]
            pins = "pin pinned pins"
        elif s.pins == "corners":
            reach, along = self.q(0.3 * s.edge_length), half * math.cos(s.slope)
            for k, (a, b) in enumerate(((-1, -1), (-1, 1), (1, -1), (1, 1))):
                at = self.q(a * along, b * half, a * half * math.sin(s.slope))
                lines.append(f"region pinned{k} sphere {at} {reach} units box")
                pins += f"pin pinned{k} pins "
        size = f"disc {self.q(half)}" if s.sheet == "disc" else f"size {self.q(2 * half, 2 * half)}"
        pattern = "" if s.sheet == "disc" else f"pattern {s.pattern}"
        areal = self.q(s.areal, unit="kg/m^2")
        edge = self.q(s.edge_length)
        made = f"create_cloth 3 {areal} {size} spacing {edge} {pattern} {slope} group cloth {pins}"
        return [*lines, made.rstrip()]

    def _plate(self) -> list[str]:
        s, dx = self.s, self.dx
        if not s.plate:
            return []
        below = PLATE * dx + abs(math.sin(s.slope)) * s.side
        return [
            f"create_cloth 4 {self.q(10.0, unit='kg/m^2')} size {self.q(12 * dx, 12 * dx)} "
            f"spacing {self.q(2 * dx)} center {self.q(0, 0, -below)} "
            "bond 2 triangle 2 hinge 2 group plate"
        ]

    def _water(self) -> list[str]:
        s, dx = self.s, self.dx
        if s.water == "jet":
            return []
        nx, ny, nz = s.size
        base = s.start
        lines = [self._lattice(dx, base)]
        if s.water == "drop":
            radius = dx * (2 + 0.25 * nx)
            lines += [
                f"region drop sphere {self.q(0, 0, base + radius, radius)} units box",
                "create_atoms 1 region drop",
            ]
            return lines
        lines += [self._block("low", nx, ny, base, nz * dx), "create_atoms 1 region low"]
        upper = base + nz * dx
        if s.water == "two fluids":
            lines += [self._block("high", nx, ny, upper, nz * dx), "create_atoms 2 region high"]
        if s.water == "two resolutions":
            upper += 2 * s.support
            lines += [self._lattice(2 * dx, upper)]
            lines += [self._block("high", nx, ny, upper, 4 * dx), "create_atoms 2 region high"]
        return lines

    def _lattice(self, spacing: float, base: float) -> str:
        """Return a lattice whose first layer is half a spacing above the base."""
        above = (base / spacing + 0.5) % 1.0
        return f"lattice sc {self._lattice_scale(spacing)} origin 0.5 0.5 {above:.12f}"

    def _lattice_scale(self, spacing: float) -> str:
        """Units lj want the number of sites in a cube of the unit length."""
        length = spacing * self.u.m
        return f"{length**-3 if self.s.units == 'lj' else length:.15g}"

    def _block(self, name: str, nx: int, ny: int, low: float, high: float) -> str:
        dx = self.dx
        # a little less than whole cells: no site is on a face
        half = [0.5 * (2 * math.ceil(n / 2)) * dx * 0.99 for n in (nx, ny)]
        sides = [-half[0], half[0], -half[1], half[1], low + 0.01 * dx, low + high - 0.01 * dx]
        return f"region {name} block {self.q(*sides)} units box"

    def _forces(self) -> list[str]:
        s = self.s
        lines = [
            f"pair_style sph/tait {self.q(s.support)} kernel {s.kernel} precision {s.precision} "
            f"density {s.density} tension {s.tension}",
            self._fluid(0, 1.0),
            self._fluid(1, 2.0) if s.water == "two resolutions" else self._fluid(1, 1.0),
            "pair_coeff 3 3 "
            + (f"boundary pressure {s.pressure}" if s.coupling == "boundary" else "none"),
            "pair_coeff 4 4 none",
            f"neighbor {self.q(s.skin)} bin",
            "neigh_modify every 1 delay 0 check yes",
        ]
        if s.water != "jet":
            lines.append(f"velocity water set {self.q(*s.velocity, unit='m/s')} units box")
        if s.has_mesh:
            lines += [
                "bond_style pbd",
                f"bond_coeff 1 {self._stiffness(s.edge, 'm/N')}",
                "bond_coeff 2 1.0",
                "angle_style zero",
                "angle_coeff *",
                "dihedral_style pbd",
                f"dihedral_coeff 1 {self._stiffness(s.hinge, '1/N/m')}",
                "dihedral_coeff 2 0",
            ]
        return lines

    def _fluid(self, k: int, coarse: float) -> str:
        s = self.s
        rho = self.q(s.rest_density[k], unit="kg/m^3")
        c0 = self.q(s.c0[k], unit="m/s")
        nu = self.q(s.nu, unit="m^2/s")
        return (
            f"pair_coeff {k + 1} {k + 1} fluid {rho} c0 {c0} alpha {s.alpha:.6g} nu {nu} "
            f"spacing {self.q(coarse * self.dx)} support {self.q(coarse * s.support)}"
        )

    def _stiffness(self, given: tuple[str, float], unit: str) -> str:
        kind, value = given
        return f"{value:.6g}" if kind == "k" else f"compliance {self.q(value, unit=unit)}"

    def _fixes(self) -> list[str]:
        s, dx = self.s, self.dx
        lines = [f"timestep {self.q(s.dt, unit='s')}"]
        if s.gravity:
            lines.append(f"fix gravity all gravity {self.q(GRAVITY, unit='N/kg')} vector 0 0 -1")
        if s.water == "jet":
            n = 30 * s.size[0]
            opening = self.q(0, 0, s.opening, (1.2 + 0.2 * s.size[1]) * dx)
            lines.append(
                f"fix pour water sph/emit {n} 1 {self.q(dx)} disc {opening} "
                f"velocity {self.q(*s.velocity, unit='m/s')}"
            )
        if "f" in s.boundary:
            sides = self.q(-self.deep, -SINK * dx)
            lines.append(f"region sink block INF INF INF INF {sides} units box")
            lines.append("fix drain water sph/drain region sink")
        if s.walls:
            w = self.q(0.8 * WIDE * dx)
            floor = self.q(-FLOOR * dx)
            lines.append(f"fix tank water wall/sph xlo -{w} xhi {w} ylo -{w} yhi {w} zlo {floor}")
        scheme = s.scheme if s.verlet else "global"
        lines.append(
            f"fix step water sph/integrate {scheme} until {self.q(s.time, unit='s')} gain 1"
        )
        if not s.verlet:
            lines.append(f"run_style sph/adaptive {s.scheme}")
        if s.sheet != "none":
            lines.append(self._cloth())
        if (s.contact and s.sheet != "none") or s.plate:
            lines.append(self._contact())
        if s.shift:
            lines.append("fix shift water sph/shift")
        return lines

    def _cloth(self) -> str:
        s = self.s
        words = ["fix sheet cloth pbd/cloth"]
        if s.iterations:
            words += [f"solver {s.solver} iterations {s.iterations} direction {s.direction}"]
        if s.order != "forward":
            words += [f"order {s.order}"]
        words += [f"damping {self.q(s.damping, unit='1/s')}"]
        if s.reference:
            words += [f"reference {self.q(s.dt, unit='s')}"]
        if s.pins != "none":
            words += ["pin pins"]
        return " ".join(words)

    def _contact(self) -> str:
        s = self.s
        words = [f"fix contact water cloth/contact {self.q(s.thickness)}"]
        words += [f"friction {s.friction:.4g} restitution {s.restitution:.4g}"]
        if s.coupling == "wall":
            words += ["wall yes"]
        if s.plate:
            words += ["obstacle plate"]
        if s.meets:
            words += [f"cloth yes cloth/thickness {self.q(s.meets)}"]
        return " ".join(words)

    def _output(self) -> list[str]:
        s = self.s
        poured = "f_pour" if s.water == "jet" else "0"
        drained = "f_drain" if "f" in s.boundary else "0"
        lines = ["compute density water sph/atom density"]
        lines += [f"variable poured equal {poured}", f"variable drained equal {drained}"]
        kicks = ""
        if s.sheet != "none":
            lines.append("compute kick all pbd/cloth halfkick/*")
            lines += [f"variable kick{k} equal c_kick[{k}]" for k in (1, 2, 3)]
            kicks = "v_kick1 v_kick2 v_kick3"
        lines += [
            f"thermo_style custom step time dt atoms v_poured v_drained {kicks}",
            "thermo_modify line yaml norm no format float %.17g",
            "thermo ${every}",
            "dump scene all custom ${every} stress.lammpstrj id type "
            "xu yu zu x y z vx vy vz mass c_density",
            "dump_modify scene sort id colname c_density rho format float %.17g",
        ]
        if s.has_mesh:
            lines.append("write_data stress.data nofix")
        return [*lines, f"run {s.steps}"]

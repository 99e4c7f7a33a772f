"""Scenes that tests of several styles share."""

from dataclasses import dataclass

from scenes.fragments import (
    FLUID,
    box,
    cloth_box,
    cloth_styles,
    filled,
    final_dump,
    gravity,
    header,
    jitter,
    lattice,
    neighbor,
    no_other_bonds,
    sheet,
    sph_tait,
    stiffness,
)
from scenes.units import render


@dataclass(frozen=True)
class Scene:
    """An input script in the parts that a restart takes apart; numbers may carry units.

    Attributes:
        atoms: from the header to the last group.
        forces: styles, coefficients and the time step, which a restart file holds.
        settings: what it does not hold, regions included.
        fixes: fixes, the run style, and computes.
        make: script, in SI, that writes the data file which `atoms` reads, so that atom IDs and
            random numbers depend neither on the number of ranks nor on the units.
        finish: commands behind the last run.
        steps: before and behind the restart file.
        exact_on: number of ranks up to which a restart continues to the last bit, and not to
            round-off.
    """

    atoms: str
    forces: str
    settings: str
    fixes: str
    make: str = ""
    finish: str = ""
    steps: int = 20
    exact_on: int = 4

    def first(self) -> str:
        """Return the script of a run from the beginning, without the run."""
        return self.atoms + self.forces + self.settings + self.fixes

    def again(self, restart: str) -> str:
        """Return the script that goes on from a restart file, without the run."""
        return f"comm_modify vel yes\nread_restart {restart}\n" + self.settings + self.fixes


END = "\nrun ${steps}\n" + final_dump()

# A jittered block of water falls on a pinned sheet.
MAKE_DROP = (
    header("p p f")
    + cloth_box("-0.5 0.5 -0.5 0.5 -0.6 1.0")
    + "mass * 0.125\n"
    + lattice()
    + filled("block", "-0.2 0.2 -0.2 0.2 0.03 0.33")
    + "group fluid type 1\n"
    + jitter(0.01, 1234, "fluid")
    + "velocity fluid set 0.5 0.3 -3.0 units box\nspecial_bonds lj/coul 1 1 1\n"
    + sheet(2, 4.0, "0.9 0.9", 0.05, "center 0 0 0")
    + "neighbor 0.05 bin\nwrite_data drop.data\n"
)
DROP_SCENE = Scene(
    make=MAKE_DROP,
    atoms=header("p p f")
    + """special_bonds lj/coul 1 1 1
read_data drop.data
group fluid type 1
group cloth type 2
region held block -0.44[m] 0.44[m] INF INF INF INF side out
region up block INF INF INF INF -0.02[m] 0.02[m]
region pins intersect 2 held up
group pins region pins
group pins intersect pins cloth
""",
    forces=sph_tait(
        "1 1 fluid 1000.0[kg/m^3] c0 30[m/s] alpha 0.1 nu 1e-3[m^2/s]",
        "2 2 boundary",
        support="0.1[m]",
    )
    + stiffness()
    + "timestep 0.002[s]\n",
    settings=no_other_bonds() + neighbor("0.03[m]"),
    fixes=gravity(g="9.81[N/kg]")
    + """fix step fluid sph/integrate global gain 1
fix sheet cloth pbd/cloth iterations 5 pin pins damping 2.0[1/s]
fix contact fluid cloth/contact 0.015[m]
""",
)
VARIABLES = "variable newton index on\nvariable steps index 100\nvariable dump index end.txt\n"
THERMO = (
    "thermo 10\nthermo_style custom step time dt f_step[4] f_sheet[3] f_contact[1] f_contact[3]\n"
)
DROP = VARIABLES + "newton ${newton}\n" + render(DROP_SCENE.first()) + THERMO
# no thermo output here, which must not matter
AGAIN_DROP = (
    "variable restart index mid.restart\nvariable steps index 60\nvariable dump index end.txt\n"
    + render(DROP_SCENE.again("${restart}"))
)

# A free sheet, no gravity, and fluid particles of two types with unequal masses that hit it.
FREE_SHEET = (
    header()
    + cloth_box("-1 1 -1 1 -1 1", 3)
    + "mass 1 0.125\nmass 2 0.3\n"
    + sheet(3, 5.0, "0.8 0.8", 0.05, "center 0 0 0 group cloth")
    + lattice()
    + filled("low", "-0.15 0.15 -0.15 0.15 0.05 0.2", 1)
    + filled("high", "-0.15 0.15 -0.15 0.15 0.2 0.3", 2)
    + "group fluid type 1 2\nvelocity fluid set 0.3 -0.2 -6.0 units box\n"
    + sph_tait("1 1 fluid 1000.0 c0 8 alpha 0.1", "2 2 fluid 2000.0 c0 6 nu 0.01", "3 3 boundary")
    + cloth_styles("0.9", "0.1")
    + neighbor(0.03)
    + """timestep 0.001
fix step fluid sph/integrate global gain 1
fix sheet cloth pbd/cloth iterations 5 damping 1.0
fix contact fluid cloth/contact 0.03
"""
)

# Two fluids over a floor, jittered, all moving alike.
TWO_FLUIDS = (
    header("p p f")
    + box("0 0.3 0 0.3 -0.2 0.5", 3)
    + "mass 1 0.125\nmass 2 0.15\nmass 3 1\n"
    + lattice()
    + filled("floor", "INF INF INF INF -0.026 0.0", 3)
    + filled("water", "INF INF INF INF 0.0 0.15", 1)
    + filled("oil", "INF INF INF INF 0.15 0.3", 2)
    + jitter(0.01, 77)
    + "velocity all set 0.1 0.2 -0.3\n"
)

# A block of water falls on a plane; what flies may take longer steps than what has hit it.
MAKE_FALL = (
    header("f f f", FLUID)
    + box("-0.6 0.6 -0.6 0.6 -0.3 1")
    + lattice()
    + filled("water", "-0.2 0.2 -0.2 0.2 0.05 0.45")
    + jitter(0.01, 17)
    + "mass 1 0.125\nset group all sph/rho 1000\nvelocity all set 0 0 -2 units box\n"
    + "write_data fall.data\n"
)


def periodic_water(spacing, coefficients, options="", dimension=3):
    """Eight particles along each axis of a periodic lattice; one layer in two dimensions."""
    side, slab = 8 * spacing, 8 * spacing if dimension == 3 else spacing
    return (
        header(atoms=FLUID, dimension=dimension)
        + box(f"0 {side} 0 {side} {-0.5 * slab} {0.5 * slab}")
        + lattice(spacing, dimension)
        + "create_atoms 1 box\n"
        + sph_tait(f"1 1 fluid {coefficients}", options=options)
        + neighbor(0.02)
    )


def fall(scheme, ceiling=2e-3, limits=""):
    """Return the script behind MAKE_FALL, with the scheme of time steps."""
    return (
        "variable steps index 200\nvariable dump index end.txt\n"
        + header("f f f", FLUID)
        + "read_data fall.data\n"
        + sph_tait("1 1 fluid 1000 c0 20 alpha 0.1")
        + neighbor(0.03)
        + f"timestep {ceiling}\n"
        + gravity()
        + "fix walls all wall/sph zlo 0\n"
        + f"fix step all sph/integrate global acoustic 0.5 force 0.05 {limits}\n"
        + f"run_style sph/adaptive {scheme}\n"
    )


# Vortices in a tilted periodic box, in two dimensions.
MAKE_FLOW = (
    header(atoms=FLUID, dimension=2)
    + box("0 1 0 1 -0.025 0.025 0.3 0 0", shape="prism")
    + "mass 1 2.5\n"
    + lattice(dimension=2)
    + "create_atoms 1 box\n"
    + jitter(0.01, 4711, dimension=2)
    + """set group all sph/rho 1000.0
variable u atom -cos(2*PI*(x-0.3*y))*sin(2*PI*y)
variable w atom sin(2*PI*(x-0.3*y))*cos(2*PI*y)
velocity all set v_u v_w 0 units box
write_data flow.data
"""
)

# Water is poured at 2 m/s, a layer each 0.025 s.
POUR = (
    header("f f f", FLUID)
    + box("-0.5 0.5 -0.5 0.5 -0.5 1")
    + "mass 1 0.1209\n"
    + sph_tait("1 1 fluid 1000 c0 20")
    + neighbor(0.03)
    + """timestep {dt}
group water type 1
fix step water sph/integrate constant
fix pour water sph/emit {n} 1 0.05 {opening} velocity 0 0 -2 start 0
"""
)

# One particle above a sheet: what commands and errors are tried on.
SMALL_SHEET = (
    header()
    + cloth_box("-1 1 -1 1 -1 1")
    + "mass * 0.1\nregion none block 0.9 0.91 0.9 0.91 0.9 0.91\n"
    + sheet(2, 1.0, "0.6 0.6", 0.1, "group cloth pin none vacant")
    + "create_atoms 1 single 0 0 0.5\ngroup water type 1\n"
    + sph_tait("1 1 fluid 1000 c0 20", "2 2 boundary")
    + "special_bonds lj/coul 1 1 1\n"
    + stiffness()
    + "neighbor 0.05 bin\n"
)

"""Pieces of input scripts, each a function of what differs between scenes."""

CLOTH, FLUID = "hybrid sph molecular", "sph"
ROOM = (
    "bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 "
    "extra/angle/per/atom 8 extra/dihedral/per/atom 16"
)


def header(boundary="p p p", atoms=CLOTH, *, units="si", dimension=3, newton="", cutoff=""):
    """What comes before the box."""
    return (
        (f"newton {newton}\n" if newton else "")
        + f"units {units}\n"
        + (f"dimension {dimension}\n" if dimension != 3 else "")
        + f"atom_style {atoms}\natom_modify map yes\n"
        + f"comm_modify vel yes{f' cutoff {cutoff}' if cutoff else ''}\n"
        + f"boundary {boundary}\n"
    )


def box(sides, types=1, shape="block", room=""):
    """An empty box."""
    return f"region box {shape} {sides} units box\ncreate_box {types} box {room}".rstrip() + "\n"


def cloth_box(sides, types=2, shape="block"):
    """An empty box with room for a cloth."""
    return box(sides, types, shape, ROOM)


def lattice(spacing=0.05, dimension=3):
    """Sites in the middle of cells, so that a region of whole cells is full."""
    kind, origin = ("sc", "0.5 0.5 0.5") if dimension == 3 else ("sq", "0.5 0.5 0")
    return f"lattice {kind} {spacing} origin {origin}\n"


def filled(region, sides, kind=1, shape="block"):
    """A region with an atom of a type on each site of the lattice."""
    return f"region {region} {shape} {sides} units box\ncreate_atoms {kind} region {region}\n"


def jitter(by, seed, group="all", dimension=3):
    """Moves each atom by up to a length along each axis."""
    return (
        f"displace_atoms {group} random {by} {by} {by if dimension == 3 else 0} {seed} units box\n"
    )


def sheet(kind, areal, size, spacing, more="group cloth"):
    """A rectangular cloth."""
    return f"create_cloth {kind} {areal} size {size} spacing {spacing} {more}\n"


def sph_tait(*coefficients, support=0.1, options=""):
    """The pair style; coefficients as ``1 1 fluid 1000 c0 20``."""
    style = f"pair_style sph/tait {support} {options}".rstrip()
    return "\n".join([style, *(f"pair_coeff {c}" for c in coefficients)]) + "\n"


def stiffness(edge="1.0", hinge="0.1", types="1"):
    """Of edges and hinges, which a restart file holds."""
    return (
        f"bond_style pbd\nbond_coeff {types} {edge}\n"
        f"dihedral_style pbd\ndihedral_coeff {types} {hinge}\n"
    )


def no_other_bonds():
    """Triangles have no force, and bonds hide no pair; a restart file does not hold that."""
    return "special_bonds lj/coul 1 1 1\nangle_style zero\nangle_coeff *\n"


def cloth_styles(edge="1.0", hinge="0.1", types="1"):
    """Forces of a cloth."""
    return no_other_bonds() + stiffness(edge, hinge, types)


def neighbor(skin, cutoff=""):
    """Lists that are renewed as soon as they must be, and how far ghosts reach beyond the lists."""
    ghosts = f"comm_modify cutoff {cutoff}\n" if cutoff else ""
    return f"neighbor {skin} bin\n{ghosts}neigh_modify every 1 delay 0 check yes\n"


def gravity(group="all", vector="0 0 -1", g=9.81):
    """Weight."""
    return f"fix gravity {group} gravity {g} vector {vector}\n"


def final_dump(columns="x y z vx vy vz", file="${dump}"):
    """The last state, to all digits and in the order of atom IDs."""
    return f"write_dump all custom {file} id {columns} modify sort id format float %.17g\n"

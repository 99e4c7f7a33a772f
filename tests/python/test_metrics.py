"""What goes through a moving sheet, and what only goes past it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conftest import make_frame, square_sheet

from sphcloth import metrics
from sphcloth.errors import UserError
from sphcloth.log import ThermoTable
from sphcloth.mesh import ClothMesh
from sphcloth.trajectory import Frame

MESH, SHEET = square_sheet(4)
RNG = np.random.default_rng(1)


def path(*places: list[float]) -> list[Frame]:
    """Return one frame for each place of a single particle over the resting sheet."""
    return [make_frame(step, [place], SHEET) for step, place in enumerate(places)]


# inside a triangle, on an inner edge, on a diagonal, on a vertex
@pytest.mark.parametrize("where", [(0.3, 0.27), (0.25, 0.3), (0.4, 0.4), (0.5, 0.5)])
def test_a_particle_that_falls_through_is_found(where: tuple[float, float]) -> None:
    found = metrics.crossings(MESH, path([*where, 0.2], [*where, 0.1], [*where, -0.3]))
    assert found.count == 1
    assert found.ids.tolist() == [1001]
    assert found.steps.tolist() == [2]
    np.testing.assert_allclose(found.points, [[*where, 0]], atol=1e-12)


def test_a_particle_that_rounds_the_border_is_not_counted() -> None:
    around = path([0.9, 0.5, 0.1], [1.1, 0.5, 0.1], [1.1, 0.5, -0.1], [0.9, 0.5, -0.1])
    assert metrics.crossings(MESH, around).count == 0


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_position_that_is_not_finite_is_named(bad: float) -> None:
    with pytest.raises(UserError, match=r"particle 1001 has a position .* not finite at step 2"):
        metrics.crossings(MESH, path([0.3, 0.3, 0.2], [0.3, 0.3, 0.1], [0.3, 0.3, bad]))
    with pytest.raises(UserError, match=r"particle 1001 has a position .* not finite at step 0"):
        metrics.above_sheet(MESH, path([0.3, 0.3, bad])[0])
    frames = path([0.3, 0.3, 0.2], [0.3, 0.3, 0.1])
    frames[1] = make_frame(1, [[0.3, 0.3, 0.1]], np.full_like(SHEET, bad))
    with pytest.raises(UserError, match=r"a vertex has a position .* not finite at step 1"):
        metrics.crossings(MESH, frames)
    with pytest.raises(UserError, match=r"a vertex has a position .* not finite at step 1"):
        metrics.above_sheet(MESH, frames[1])


def test_a_moving_sheet_sweeps_over_a_resting_particle() -> None:
    frames = [
        make_frame(0, [[0.3, 0.4, 0.5]], SHEET),
        make_frame(1, [[0.3, 0.4, 0.5]], SHEET + 0.9),
    ]
    assert metrics.crossings(MESH, frames).count == 0  # it moves aside by 0.9 as well
    frames[1] = make_frame(1, [[0.3, 0.4, 0.5]], SHEET + np.array([0.2, 0, 0.9]))
    assert metrics.crossings(MESH, frames).count == 1


def test_particle_and_sheet_that_move_together_do_not_cross() -> None:
    fluid = RNG.random((200, 3)) * [1, 1, 0.1] + [0, 0, 1e-3]
    shift = np.array([0.3, 0.2, -2.0])
    frames = [make_frame(0, fluid, SHEET), make_frame(1, fluid + shift, SHEET + shift)]
    assert metrics.crossings(MESH, frames).count == 0


def test_a_turning_sheet_meets_what_stands_in_its_way() -> None:
    upright = SHEET[:, [2, 1, 0]]  # turned by a right angle about the y axis
    fluid = [[0.4, 0.5, 0.4], [0.9, 0.5, 0.9], [0.4, 0.5, -0.4]]
    frames = [make_frame(0, fluid, SHEET), make_frame(1, fluid, upright)]
    # straight paths of the vertices: the border moves along x + z = 1, inside of the second one
    assert metrics.crossings(MESH, frames).ids.tolist() == [1001]


def test_a_line_through_a_fold_and_out_again_is_no_crossing() -> None:
    roof = SHEET.copy()
    roof[:, 2] = 0.5 - np.abs(roof[:, 0] - 0.5)
    frames = [make_frame(0, [[0.1, 0.5, 0.3]], roof), make_frame(1, [[0.9, 0.5, 0.3]], roof)]
    assert metrics.crossings(MESH, frames).count == 0
    frames[1] = make_frame(1, [[0.5, 0.5, 0.3]], roof)
    assert metrics.crossings(MESH, frames).count == 1


def test_a_particle_that_goes_through_and_back_is_counted_once() -> None:
    found = metrics.crossings(MESH, path([0.3, 0.3, 0.1], [0.3, 0.3, -0.1], [0.3, 0.3, 0.1]))
    assert (found.count, len(found.ids)) == (1, 2)


def test_a_path_longer_than_two_edges_makes_a_crossing_unclear() -> None:
    """The mean edge of the sheet is 0.28 long; the last path wraps around the box."""
    edge = MESH.edge_lengths(make_frame(0, [], SHEET)).mean()
    for last, unclear in ((-0.4, False), (-0.5, True), (99.5, True)):
        found = metrics.crossings(MESH, path([0.3, 0.3, 0.1], [0.3, 0.3, last]))
        assert found.is_unclear.tolist() == [unclear]
        assert found.moved.tolist() == pytest.approx([(0.1 - (last - 100 * (last > 1))) / edge])


def test_many_particles_agree_with_counting_by_height() -> None:
    before = RNG.random((3000, 3)) * [1.6, 1.6, 1] - [0.3, 0.3, 0.5]
    after = RNG.random((3000, 3)) * [1.6, 1.6, 1] - [0.3, 0.3, 0.5]
    moment = before[:, 2] / (before[:, 2] - after[:, 2])
    met = before + moment[:, None] * (after - before)
    inside = np.all((met[:, :2] > 0) & (met[:, :2] < 1), axis=1)
    expected = np.flatnonzero((before[:, 2] * after[:, 2] < 0) & inside) + 1001
    frames = [make_frame(0, before, SHEET), make_frame(1, after, SHEET)]
    assert sorted(metrics.crossings(MESH, frames).ids) == expected.tolist()


def test_particles_that_come_or_go_between_frames_are_left_out() -> None:
    frames = [
        make_frame(0, [[0.3, 0.3, 0.1]], SHEET, first_fluid_id=2000),
        make_frame(1, [[0.3, 0.3, -0.1]], SHEET, first_fluid_id=3000),
    ]
    assert metrics.crossings(MESH, frames).count == 0


def test_a_wrap_around_the_periodic_box_is_no_flight_through_the_sheet() -> None:
    assert metrics.crossings(MESH, path([0.3, 0.3, -49.9], [0.3, 0.3, 49.9])).count == 0


def test_a_long_flight_in_a_closed_box_is_no_wrap() -> None:
    frames = path([0.3, 0.3, 49.9], [0.3, 0.3, -49.9])
    closed = [replace(frame, periodic=(True, True, False)) for frame in frames]
    assert [metrics.crossings(MESH, scene).count for scene in (frames, closed)] == [0, 1]


def test_a_wrap_around_a_tilted_box_is_no_flight_through_the_sheet() -> None:
    """A fall of 0.1 at x = -9.5 through the floor: the particle comes back 20 further in x."""
    frames = path([-9.5, 0.5, 0.05], [10.5, 0.5, 99.95])
    box = np.array([[-50.0, -50.0, 0.0], [70.0, 50.0, 100.0]])
    assert (
        metrics.crossings(MESH, [replace(f, box=box, tilt=(0, 20, 0)) for f in frames]).count == 0
    )
    assert metrics.crossings(MESH, [replace(f, box=box, tilt=(0, 0, 0)) for f in frames]).count == 1


def in_unit_box(frames: list[Frame], **changes: object) -> list[Frame]:
    """Return the frames in a periodic box from 0 to 1, as a dump has them, or in another one."""
    box = np.array([[0.0] * 3, [1.0] * 3])
    return [replace(frame, **{"box": box} | changes) for frame in frames]


# height of the particle before and after, then that of the sheet
@pytest.mark.parametrize(
    ("particle", "sheet", "expected"),
    [
        ((0.02, 0.98), (0.01, 0.01), 1),
        ((0.99, 0.01), (0.005, 0.005), 1),
        ((0.98, 0.01), (0.995, 0.99), 1),
        ((0.002, 0.002), (0.005, 0.995), 1),
        ((0.998, 0.998), (0.995, 0.001), 1),
        ((0.5, 0.5), (0.99, 0.01), 0),
        ((0.99, 0.02), (0.98, 0.01), 0),
        ((0.97, 0.99), (0.02, 0.01), 0),
    ],
)
def test_passes_through_a_periodic_face_are_found(
    particle: tuple[float, float], sheet: tuple[float, float], expected: int
) -> None:
    frames = [
        make_frame(step, [[0.4, 0.35, z]], 0.8 * SHEET + [0.1, 0.1, height])
        for step, (z, height) in enumerate(zip(particle, sheet, strict=True))
    ]
    assert metrics.crossings(MESH, in_unit_box(frames)).count == expected


@pytest.mark.parametrize("tilt", [(0.0, 0.0, 0.0), (0.3, -0.2, 0.4)])
def test_a_sheet_through_all_faces_is_crossed_as_one_in_the_middle(
    tilt: tuple[float, float, float],
) -> None:
    """Random paths and a moving wavy sheet, the same counts wherever the box is cut."""
    sheet = 0.8 * SHEET + 0.1
    sheet[:, 2] += 0.4 + 0.05 * np.sin(9 * sheet[:, 0])
    later = sheet + np.array([0.02, 0.01, -0.06])
    start = RNG.random((500, 3)) * [1, 1, 0.3] + [0, 0, 0.35]
    end = start + (RNG.random((500, 3)) - 0.5) * 0.3
    cell = np.eye(3)
    cell[[1, 2, 2], [0, 0, 1]] = tilt
    low = np.array([min(0, *tilt[:2], tilt[0] + tilt[1]), min(0, tilt[2]), 0])
    high = np.array([1 + max(0, *tilt[:2], tilt[0] + tilt[1]), 1 + max(0, tilt[2]), 1])

    def counted(shift: list[float]) -> list[int]:
        inside = [((each + shift) % 1) @ cell for each in (start, sheet, end, later)]
        frames = [make_frame(0, *inside[:2]), make_frame(1, *inside[2:])]
        boxed = in_unit_box(frames, box=np.array([low, high]), tilt=tilt)
        return sorted(metrics.crossings(MESH, boxed).ids)

    whole = counted([0, 0, 0])
    assert 50 < len(whole) < 450
    for shift in ([0, 0, 0.5], [0.5, 0.3, 0], [0.4, 0.7, 0.45]):
        assert counted(shift) == whole


def test_a_sheet_that_closes_through_the_box_has_no_hole_there() -> None:
    """Four rows of triangles along y, the last one of which ends at the first vertices."""
    number = np.arange(20).reshape(5, 4)
    a, b = number[:-1], number[1:]
    c, d = np.roll(b, -1, axis=1), np.roll(a, -1, axis=1)
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    x, y = np.meshgrid(np.linspace(0.1, 0.9, 5), np.arange(4) / 4, indexing="ij")
    sheet = np.stack([x.ravel(), y.ravel(), np.full(20, 0.5)], axis=1)
    over = np.column_stack([np.full(40, 0.37), np.arange(40) / 40 + 0.011, np.full(40, 0.6)])
    frames = [make_frame(0, over, sheet), make_frame(1, over - [0, 0, 0.2], sheet)]
    ring = ClothMesh(np.arange(1, 21), triangles)
    assert metrics.crossings(ring, in_unit_box(frames)).count == 40
    closed = in_unit_box(frames, periodic=(True, False, True))
    assert metrics.crossings(ring, closed).count < 40


def test_frames_in_no_order_are_no_paths() -> None:
    frames = path([0.3, 0.3, 0.2], [0.3, 0.3, 0.1], [0.3, 0.3, -0.1])
    assert metrics.crossings(MESH, frames).count == 1
    for wrong in (frames[::-1], [frames[0], frames[2], frames[1]]):
        with pytest.raises(UserError, match=r"crossings: a frame of step 1 follows one of step 2"):
            metrics.crossings(MESH, wrong)
    with pytest.raises(UserError, match="outer_force: a frame of step 1 follows one of step 2"):
        metrics.outer_force(frames[:0:-1], 1.0, (0, 0, 0))


def test_one_frame_is_too_few() -> None:
    with pytest.raises(UserError, match="only one"):
        metrics.crossings(MESH, path([0, 0, 0]))


def test_above_the_sheet_is_over_it_and_within_its_footprint() -> None:
    bowl = SHEET.copy()
    bowl[:, 2] = (bowl[:, 0] - 0.5) ** 2
    fluid = [[0.5, 0.5, 0.01], [0.5, 0.5, -0.01], [0.97, 0.5, 0.1], [1.2, 0.5, 1], [0.3, 0.3, 5]]
    above = metrics.above_sheet(MESH, make_frame(0, fluid, bowl))
    assert above.tolist() == [True, False, False, False, True]


@pytest.mark.parametrize("shift", [(0, 0, 0), (0.45, 0.3, 0), (0.1, 0.7, 0.6), (0.3, 0.3, 0.35)])
@pytest.mark.parametrize("tilt", [(0.0, 0.0, 0.0), (0.3, -0.2, 0.4)])
def test_what_is_above_a_sheet_is_so_wherever_the_box_is_cut(
    shift: tuple[float, float, float], tilt: tuple[float, float, float]
) -> None:
    """In a periodic box the sheet is below what is nearer from above than from below."""
    cell = np.eye(3)
    cell[[1, 2, 2], [0, 0, 1]] = tilt
    # straight up at each place, whatever the tilt
    upright = np.array([*cell[:2], [0, 0, 1]])
    fluid = np.random.default_rng(3).random((400, 3)) - [0, 0, 0.5]
    over = np.all((fluid[:, :2] > 0.2) & (fluid[:, :2] < 0.8), axis=1)
    expected = over & (fluid[:, 2] > 0)
    sheet = 0.6 * SHEET + [0.2, 0.2, 0]
    moved = [((each @ upright + shift) @ np.linalg.inv(cell) % 1) @ cell for each in (fluid, sheet)]
    beyond = np.array([np.ptp([0, *tilt[:2], tilt[0] + tilt[1]]), abs(tilt[2]), 0])
    frame = in_unit_box([make_frame(0, *moved)], box=np.array([[0] * 3, 1 + beyond]), tilt=tilt)[0]
    assert 40 < expected.sum() < 100
    np.testing.assert_array_equal(metrics.above_sheet(MESH, frame), expected)
    assert metrics.held_volume(MESH, frame, 2.0) == 2 * expected.sum()


def test_in_a_closed_box_a_sheet_is_below_all_that_is_over_it() -> None:
    frames = in_unit_box([make_frame(0, [[0.5, 0.5, 0.95]], 0.6 * SHEET + [0.2, 0.2, 0.05])])
    closed = [replace(frame, periodic=(True, True, False)) for frame in frames]
    assert metrics.above_sheet(MESH, closed[0]).tolist() == [True]
    assert metrics.above_sheet(MESH, frames[0]).tolist() == [False]


def test_density_deviation_counts_both_signs() -> None:
    frame = make_frame(0, [[0, 0, 0], [0, 0, 1]], SHEET)
    frame.columns["rho"] = np.concatenate([np.zeros(len(SHEET)), [1010.0, 980.0]])
    assert metrics.density_deviation(frame, 1000.0) == pytest.approx(0.02)


def test_compressed_share_counts_what_is_denser_by_more_than_asked() -> None:
    frame = make_frame(0, [[0, 0, k] for k in range(4)], SHEET)
    sheet = np.full(len(SHEET), 2000.0)
    frame.columns["rho"] = np.concatenate([sheet, [1011.0, 1009.0, 980.0, 1030.0]])
    assert metrics.compressed_share(frame, 1000.0) == 0.5
    assert metrics.compressed_share(frame, 1000.0, above=0.02) == 0.25
    assert np.isnan(metrics.compressed_share(frame, 1000.0, fluid_type=9))


def test_balances_come_from_the_thermo_columns() -> None:
    counts = {"Step": [0, 10, 20], "v_poured": [0, 8, 8], "v_drained": [0, 1, 2]}
    columns = {name: np.array(values, float) for name, values in counts.items()}
    exact = ThermoTable(columns | {"v_fluid": np.array([0.0, 7, 6])}, 1.0)
    lossy = ThermoTable(columns | {"v_fluid": np.array([0.0, 9, 6])}, 1.0)
    assert (metrics.mass_balance(exact), metrics.mass_balance(lossy)) == (0, 2)
    other = {name: np.append(values, np.nan) for name, values in lossy.columns.items()}
    assert metrics.mass_balance(ThermoTable(other, 1.0)) == 2
    none = {name: np.full(3, np.nan) for name in other}
    with pytest.raises(UserError, match="no row of the log"):
        metrics.mass_balance(ThermoTable(none, 1.0))
    assert metrics.particle_updates(exact) == 100
    counted = ThermoTable(columns | {"v_updates": np.array([5.0, 20, 45])}, 1.0)
    assert metrics.particle_updates(counted) == 40


@pytest.mark.parametrize(
    ("step", "drops", "right"),
    [(0, 0, True), (10, 7, True), (10, 0, False), (15, 6, True), (15, 8, False), (15, 5, False)],
)
def test_a_dump_must_hold_the_water_that_the_log_counts(step: int, drops: int, right: bool) -> None:
    counts = {"Step": [0, 10, 20], "v_poured": [0, 8, 8], "v_drained": [0, 1, 2]}
    columns = {name: np.array(values, float) for name, values in counts.items()}
    table = ThermoTable(columns | {"v_fluid": np.array([0.0, 7, 6])}, 1.0)
    frame = make_frame(step, [[0, 0, 1]] * drops, SHEET)
    if right:
        metrics.check_fluid_count(table, frame)
    else:
        with pytest.raises(UserError, match=f"holds {drops} particles of type 1 at step {step}"):
            metrics.check_fluid_count(table, frame)

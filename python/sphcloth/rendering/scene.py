"""What all pictures of a dump share, and how a frame becomes one of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib import colors
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from sphcloth.errors import UserError
from sphcloth.rendering.backdrop import Environment
from sphcloth.rendering.camera import Camera
from sphcloth.rendering.legend import Scale, add_scale
from sphcloth.rendering.light import Light, Spheres
from sphcloth.rendering.particles import Particles
from sphcloth.rendering.scene_roles import SceneRoles, check_positions
from sphcloth.rendering.shading import Geometry, Solid, View
from sphcloth.rendering.subdivision import Refinement
from sphcloth.rendering.surface import Surface, smoothed, water_surface
from sphcloth.rendering.tubes import tubes
from sphcloth.trajectory import Frame
from sphcloth.unwrapping import Unwrapper

# front and back of each piece of cloth, in turn; then of obstacles, pins and spheres of water
CLOTH_COLORS = (("#d9c8aa", "#c9714e"), ("#c8604f", "#a5483f"), ("#74a076", "#557f5d"))
OBSTACLE_COLOR, PIN_COLOR, STRING_COLOR = "#b9bcc2", "#8c2f25", "#5b5349"
SPHERE_COLOR = "#2f7fd0"

PIN_RADIUS, STRING_RADIUS, KNOT_RADIUS = 0.006, 0.002, 0.02  # of the scene
# from the scene to the camera; of a two-dimensional scene almost straight in front of it
VIEW, FLAT_VIEW = np.array([1.0, -1.8, 0.95]), np.array([0.25, -1.0, 0.22])
# towards the sun from the camera: aside, upwards, back; and how high it stands at least
SUN, MIN_SUN_HEIGHT = np.array([-0.5, 0.8, 0.3]), 1.05
# quantiles of the coordinates of water between which it is to be seen
WATER_QUANTILES = (0.1, 0.9)
# triangles of cloth, after they have been made smooth by subdivision
FINE_TRIANGLES = 100_000
# how far around the scene water is drawn, and light is followed, in radii of the scene
DRAWN_ROOM, LIT_ROOM = 3.0, 1.25
# of a sheet, in spacings of the water: water keeps this distance, and is looked for so far
SHEET_GAP, SHEET_REACH = 0.03, 1.0
# what is farther aside from the nearest vertex, in edges, is beyond the border of the sheet
MAX_OFFSET = 0.8


@dataclass(frozen=True)
class Scene:
    """What all pictures of a dump share.

    Attributes:
        roles: what each atom is drawn as.
        camera: the view; a turntable turns it.
        environment: the floor, the room and the sun.
        pinned: indices of the vertices that never move, shape (K,).
        scale: values of the colors of water, or None for water's own.
        as_spheres: whether water is drawn as spheres.
    """

    roles: SceneRoles
    camera: Camera
    environment: Environment
    pinned: NDArray[np.int64]
    scale: Scale | None
    as_spheres: bool

    @classmethod
    def of(
        cls,
        frames: Sequence[Frame],
        roles: SceneRoles,
        size: tuple[int, int] = (1280, 960),
        as_spheres: bool = False,
    ) -> Scene:
        """Choose one view, floor and color scale for a dump, from some of its frames."""
        points, floor = _framed(frames, roles)
        low, high = points.min(axis=0), points.max(axis=0)
        center = (low + high) / 2
        radius = float(np.linalg.norm(high - low)) / 2 or 1.0
        camera = Camera.framing(points, FLAT_VIEW if roles.is_flat else VIEW, size)
        sun = SUN @ camera.axes
        sun[2] = max(sun[2], MIN_SUN_HEIGHT)
        environment = Environment(floor, center, radius, sun / np.linalg.norm(sun))
        return cls(
            roles, camera, environment, _pins(frames, roles), _scale(frames, roles), as_spheres
        )

    def look_from(
        self, position: NDArray[np.float64] | None, target: NDArray[np.float64] | None
    ) -> Scene:
        """Return the scene seen from a place, or towards one, or both.

        Raises:
            UserError: both are the same.
        """
        target = self.camera.target if target is None else target
        if position is None:
            position = target + self.camera.position - self.camera.target
        if np.array_equal(position, target):
            raise UserError("--camera and --target are the same point: there is no direction")
        return replace(self, camera=Camera(position, target, self.camera.size))

    def seen_all_around(self) -> Scene:
        """Return the scene with the camera so far back that a turntable shows all of it."""
        middle, radius = self.environment.center, self.environment.radius
        camera = self.camera
        distance = 1.02 * radius / np.sin(camera.half_angle)
        return replace(
            self, camera=replace(camera, position=middle + distance * camera.axes[2], target=middle)
        )

    def renderer(self) -> Renderer:
        """Return what draws frames, in the order of the dump."""
        return Renderer(self)


class Renderer:
    """Draws frames of a scene, one after another."""

    def __init__(self, scene: Scene) -> None:
        """Take the scene; sheets that reach through a periodic boundary are followed."""
        self._scene = scene
        mesh = scene.roles.mesh
        self._unwrap = None if mesh is None else Unwrapper(mesh)
        self._parts = _colored_parts(scene.roles)
        self._walls: tuple[Particles, Surface] | None = None
        self._view: tuple[float, View] | None = None

    def follow(self, frame: Frame) -> NDArray[np.float64] | None:
        """Return the vertices without periodic wraps, shape (V, 3); None without cloth.

        Frames must come in the order of the dump.
        """
        return None if self._unwrap is None else self._unwrap(frame)

    def geometry_of(self, frame: Frame, sheet: NDArray[np.float64] | None) -> Geometry:
        """Make the surfaces of a frame, whose vertices are where ``follow`` found them.

        Raises:
            UserError: a vertex or a column is not in the frame, or a number is not finite.
        """
        scene = self._scene
        solids = [] if sheet is None else self._solids(frame, sheet)
        spheres = [self._pins(frame)] if len(scene.pinned) else []
        particles = _within(scene.roles.water(frame), scene.environment)
        water, tint = Surface.empty(), None
        if scene.as_spheres:
            spheres.append(self._water_spheres(particles))
        else:
            water = _cut_at_sheets(
                water_surface(particles), particles, solids, scene.roles.largest_spacing
            )
            tint = None if scene.scale is None else _linear(scene.scale.shades(water.values))
        if scene.roles.strings is not None:
            strings, knots = self._strings(frame, sheet)
            solids.append(strings)
            spheres.append(knots)
        surfaces = [solid.surface for solid in solids]
        room = (scene.environment.center, LIT_ROOM * scene.environment.radius)
        light = Light.on(surfaces, water, spheres, scene.environment.sun, room)
        return Geometry(solids, spheres, water, tint, self._glass(frame), light)

    def picture(self, geometry: Geometry, angle: float = 0.0) -> NDArray[np.uint8]:
        """Draw surfaces with the camera walked around by an angle, in radians.

        Returns:
            The picture, shape (height, width, 3).
        """
        scene = self._scene
        if self._view is None or self._view[0] != angle:
            self._view = angle, View(scene.camera.turned(angle), scene.environment)
        picture = self._view[1].draw(geometry)
        return picture if scene.scale is None else add_scale(picture, scene.scale)

    def _solids(self, frame: Frame, sheet: NDArray[np.float64]) -> list[Solid]:
        """Return cloth and obstacles of a frame, whose vertices are at some places."""
        points = self._scene.roles.upright(sheet)
        check_positions(points, frame)
        return [
            Solid(Surface.of(fine.weights @ points, fine.triangles), front, back)
            for fine, front, back in self._parts
        ]

    def _strings(self, frame: Frame, sheet: NDArray[np.float64]) -> tuple[Solid, Spheres]:
        """Return strings, and balls where they end."""
        strings, radius = self._scene.roles.strings, self._scene.environment.radius
        points = self._scene.roles.upright(strings.positions(frame, sheet))
        check_positions(points, frame)
        color = _linear(STRING_COLOR)
        surface = tubes(points, strings.links, STRING_RADIUS * radius)
        centers = points[strings.knots]
        size = np.full(len(centers), KNOT_RADIUS * radius)
        return Solid(surface, color, color), Spheres(centers, size, np.tile(color, (len(size), 1)))

    def _pins(self, frame: Frame) -> Spheres:
        scene = self._scene
        centers = scene.roles.upright(scene.roles.mesh.positions(frame)[scene.pinned])
        radius = np.full(len(centers), PIN_RADIUS * scene.environment.radius)
        return Spheres(centers, radius, np.tile(_linear(PIN_COLOR), (len(centers), 1)))

    def _water_spheres(self, particles: Particles) -> Spheres:
        if self._scene.scale is None:
            colors = np.tile(_linear(SPHERE_COLOR), (len(particles.positions), 1))
        else:
            colors = _linear(self._scene.scale.shades(particles.values))
        return Spheres(particles.positions, 0.55 * particles.spacing, colors)

    def _glass(self, frame: Frame) -> Surface:
        """Return the surface of boundary particles, which is made anew only if they moved."""
        particles = _within(self._scene.roles.wall_particles(frame), self._scene.environment)
        if self._walls is None or not np.array_equal(self._walls[0].positions, particles.positions):
            self._walls = particles, water_surface(particles)
        return self._walls[1]


def _colored_parts(roles: SceneRoles) -> list[tuple[Refinement, NDArray, NDArray]]:
    """Return smooth meshes of all cloth and obstacles, one for each pair of colors."""
    if roles.mesh is None:
        return []
    triangles = roles.mesh.triangles
    color = roles.mesh.pieces[triangles[:, 0]] % len(CLOTH_COLORS)
    color[~roles.cloth] = -1
    colors = dict(enumerate(CLOTH_COLORS)) | {-1: (OBSTACLE_COLOR, OBSTACLE_COLOR)}
    return [
        (
            Refinement.of(triangles[color == number], len(roles.mesh.ids), FINE_TRIANGLES),
            *map(_linear, pair),
        )
        for number, pair in colors.items()
        if (color == number).any()
    ]


def _framed(frames: Sequence[Frame], roles: SceneRoles) -> tuple[NDArray[np.float64], float]:
    """Return points that are to be seen, shape (N, 3), and the height of the floor."""
    cloth, water = np.zeros((0, 3)), [np.zeros((0, 3))]
    if roles.mesh is not None:
        cloth = np.concatenate([roles.upright(_ends(frame, roles)) for frame in frames])
    for frame in frames:
        positions = roles.upright(frame.positions[np.isin(frame.types, list(roles.fluid))])
        water.append(positions[np.isfinite(positions).all(axis=1)])
    wet = np.concatenate(water)
    walls = roles.upright(frames[0].positions[np.isin(frames[0].types, list(roles.walls))])
    radius = roles.largest_spacing / 2
    if len(cloth):
        low, high = cloth.min(axis=0), cloth.max(axis=0)
        extent = float((high - low).max())
        floor = low[2] - 0.1 * extent
        points = np.concatenate([cloth, [[*(low + high)[:2] / 2, floor]]])
        if len(wet):
            points = np.concatenate([points, _most_of(wet, low - extent, high + extent)])
    elif len(wet):
        points, floor = _corners(*np.quantile(wet, [0.005, 0.995], axis=0), radius), np.inf
    elif len(walls):
        points, floor = walls, np.inf
    else:
        raise UserError("the dump holds neither water nor cloth to draw: see --fluid and --data")
    floor = min(floor, *(np.quantile(part[:, 2], 0.005) for part in (points, wet) if len(part)))
    if not len(cloth) and len(walls):
        floor = min(floor, walls[:, 2].min())
    return points, float(floor) - radius


def _ends(frame: Frame, roles: SceneRoles) -> NDArray[np.float64]:
    """Return the vertices of cloth and the ends of strings, where they are in the box."""
    sheet = roles.mesh.positions(frame)
    if roles.strings is None:
        return sheet
    return np.concatenate([sheet, roles.strings.positions(frame, sheet)])


def _most_of(water: NDArray, low: NDArray, high: NDArray) -> NDArray[np.float64]:
    """Return the corners of a box with most of some water, cut off at low and high, shape (8, 3).

    Drops that are far from a sheet may leave the picture: they would shrink all the rest.
    """
    return _corners(*np.clip(np.quantile(water, WATER_QUANTILES, axis=0), low, high), 0.0)


def _corners(low: NDArray, high: NDArray, margin: float) -> NDArray[np.float64]:
    """Return the corners of a box, shape (8, 3)."""
    ends = np.stack([low - margin, high + margin])
    return np.stack(np.meshgrid(*ends.T, indexing="ij"), axis=-1).reshape(-1, 3)


def _pins(frames: Sequence[Frame], roles: SceneRoles) -> NDArray[np.int64]:
    """Return the vertices of cloth that never move, shape (K,)."""
    if roles.mesh is None or len(frames) < 2:
        return np.zeros(0, np.int64)
    first, *rest = (roles.mesh.positions(frame) for frame in frames)
    still = ~np.any([later != first for later in rest], axis=(0, 2))
    of_cloth = np.zeros(len(still), bool)
    of_cloth[roles.mesh.triangles[roles.cloth]] = True
    return np.flatnonzero(still & of_cloth)


def _scale(frames: Sequence[Frame], roles: SceneRoles) -> Scale | None:
    """Return the range of the colored quantity that few particles leave."""
    if roles.color_by is None:
        return None
    values = [roles.values(frame)[np.isin(frame.types, list(roles.fluid))] for frame in frames]
    values = np.concatenate(values)
    low, high = np.quantile(values, [0.02, 0.98]) if len(values) else (0.0, 1.0)
    if roles.color_by == "speed":
        low = 0.0
    return Scale(roles.color_by, float(low), float(max(high, low + 1e-12)))


def _within(particles: Particles, environment: Environment) -> Particles:
    """Leave out what is far away: a lost drop would stretch the grid of the surface."""
    away = np.abs(particles.positions - environment.center).max(axis=1)
    near = away < DRAWN_ROOM * environment.radius
    return particles.select(near)


def _cut_at_sheets(
    water: Surface, particles: Particles, solids: Sequence[Solid], spacing: float
) -> Surface:
    """Return water that ends at sheets: its surface, a radius from the particles, reaches through.

    A vertex beyond a sheet, seen from the nearest particle, goes back on that particle's side.
    """
    if not solids or not len(water.points):
        return water
    sheet = np.concatenate([solid.surface.points for solid in solids])
    upwards = np.concatenate([solid.surface.normals for solid in solids])
    _, nearest = cKDTree(sheet).query(water.points, distance_upper_bound=SHEET_REACH * spacing)
    near = np.flatnonzero(nearest < len(sheet))
    place, normal = sheet[nearest[near]], upwards[nearest[near]]
    aside = np.linalg.norm(np.cross(water.points[near] - place, normal), axis=1)
    over = (
        aside
        < MAX_OFFSET * np.concatenate([_cells(solid.surface) for solid in solids])[nearest[near]]
    )
    near, place, normal = near[over], place[over], normal[over]
    points = water.points.copy()
    _, particle = cKDTree(particles.positions).query(points[near])
    side = np.sign(np.einsum("ij,ij->i", particles.positions[particle] - place, normal))
    height = side * np.einsum("ij,ij->i", points[near] - place, normal)
    points[near] += (side * np.maximum(SHEET_GAP * spacing - height, 0))[:, None] * normal
    return smoothed(replace(water, points=points), 2)


def _cells(surface: Surface) -> NDArray[np.float64]:
    """Return the length of an edge at each vertex, shape (V,)."""
    ends = surface.points[surface.triangles]
    lengths = np.linalg.norm(ends - np.roll(ends, 1, axis=1), axis=2).max(axis=1)
    longest = np.zeros(len(surface.points))
    np.maximum.at(longest, surface.triangles.ravel(), np.repeat(lengths, 3))
    return longest


def _linear(color: object) -> NDArray[np.float64]:
    """Return sRGB colors of any form that matplotlib knows as linear ones, shape (..., 3)."""
    encoded = colors.to_rgba_array(color)[:, :3]
    linear = np.where(encoded < 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return linear[0] if isinstance(color, str) else linear

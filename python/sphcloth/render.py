"""Pictures of water on cloth: PyVista off-screen, matplotlib where VTK cannot draw."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib import colors, image
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh
from sphcloth.trajectory import Frame

if TYPE_CHECKING:
    import pyvista

PICTURE_SIZE = (1280, 960)
CLOTH_COLOUR = "#e3a857"
CLOTH_BACK_COLOUR = "#b9793b"
PIN_COLOUR = "#b3261e"
PIN_RADIUS = 0.009  # of the cloth's extent
FLOOR_COLOUR = "#dfe6ee"
SKY_COLOURS = ("#ffffff", "#c9d9ea")
WATER = colors.LinearSegmentedColormap.from_list("water", ["#1257a8", "#3b97df", "#b5e2f8"])

# from the scene towards the camera; the lens's full angle in degrees
VIEW = np.array([1.0, -1.8, 0.45]) / np.linalg.norm([1.0, -1.8, 0.45])
VIEW_ANGLE = 30.0
HALF_HEIGHT = np.tan(np.radians(VIEW_ANGLE / 2))
HALF_EXTENT = HALF_HEIGHT * np.array([PICTURE_SIZE[0] / PICTURE_SIZE[1], 1.0])
# the picture's own axes
RIGHT = np.cross([0, 0, 1], VIEW) / np.linalg.norm(np.cross([0, 0, 1], VIEW))
UP = np.cross(VIEW, RIGHT)

Pictures = list[Path]
Draw = Callable[["Scene", Frame, Path], None]


@dataclass(frozen=True)
class Camera:
    """Where the camera stands: it looks along ``-VIEW`` at ``target`` from ``distance``."""

    target: NDArray[np.float64]
    distance: float

    @classmethod
    def framing(cls, points: NDArray[np.float64]) -> Camera:
        """Stand as close as lets all points, shape (N, 3), into the picture."""
        axes = np.stack([RIGHT, UP, VIEW])
        seen = points @ axes.T
        middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
        aside = np.abs(seen - middle)[:, :2] / HALF_EXTENT
        needed = (seen - middle)[:, 2] + aside.max(axis=1)
        return cls(middle @ axes, 1.06 * float(needed.max()))

    @property
    def position(self) -> NDArray[np.float64]:
        """The camera's place, shape (3,)."""
        return self.target + self.distance * VIEW

    def project(self, points: NDArray[np.float64]) -> tuple[NDArray, NDArray]:
        """Return where points, shape (..., 3), appear, shape (..., 2), and their depth, (...)."""
        offset = points - self.position
        depth = -(offset @ VIEW)
        return np.stack([offset @ RIGHT, offset @ UP], axis=-1) / depth[..., None], depth


@dataclass(frozen=True)
class Scene:
    """What all pictures of a sequence share.

    Attributes:
        mesh: the cloth.
        fluid_type: atom type of the water.
        camera: the one view.
        floor: centre of the floor plate, shape (3,): below the sheet and all water.
        extent: largest extent of the cloth.
        radius: radius of a drawn particle.
        top_speed: speed that gets the brightest colour.
        pinned: indices of the vertices that never move, shape (K,).
    """

    mesh: ClothMesh
    fluid_type: int
    camera: Camera
    floor: NDArray[np.float64]
    extent: float
    radius: float
    top_speed: float
    pinned: NDArray[np.int64]

    @classmethod
    def of(cls, frames: Sequence[Frame], mesh: ClothMesh, fluid_type: int) -> Scene:
        """Choose one view, colour scale and particle size for all given frames."""
        cloth = np.stack([mesh.positions(frame) for frame in frames])
        fluid = [frame.select(fluid_type) for frame in frames]
        water = np.concatenate([part.positions for part in fluid])
        low, high = cloth.min(axis=(0, 1)), cloth.max(axis=(0, 1))
        extent = float((high - low).max())
        radius = _particle_radius(max(fluid, key=len).positions)
        lowest = min(low[2] - 0.1 * extent, water[:, 2].min(initial=np.inf) - radius)
        floor = np.array([*(low + high)[:2] / 2, lowest])
        # drops that miss the sheet may leave the picture: they would shrink all the rest
        over_sheet = np.all(water >= low, axis=1) & np.all(water[:, :2] <= high[:2], axis=1)
        still = np.all(cloth == cloth[0], axis=(0, 2)) & (len(frames) > 1)
        return cls(
            mesh,
            fluid_type,
            Camera.framing(np.concatenate([cloth.reshape(-1, 3), water[over_sheet], [floor]])),
            floor,
            extent,
            radius,
            _top_speed(np.concatenate([_speeds(part) for part in fluid])),
            np.flatnonzero(still),
        )


def render_frames(
    frames: Sequence[Frame], mesh: ClothMesh, out_dir: Path, fluid_type: int = 1
) -> Pictures:
    """Draw each frame to ``frame_0000.png``, ... with one fixed camera; return the paths.

    Args:
        frames: frames of one run, at least one.
        mesh: the cloth.
        out_dir: folder for the pictures; made if need be.
        fluid_type: atom type of the water.
    """
    if not frames:
        raise UserError("no frame to draw")
    out_dir.mkdir(parents=True, exist_ok=True)
    scene = Scene.of(frames, mesh, fluid_type)
    draw = _draw_with_pyvista if can_use_pyvista() else _draw_with_matplotlib
    paths = [out_dir / f"frame_{number:04d}.png" for number in range(len(frames))]
    for frame, path in zip(frames, paths, strict=True):
        draw(scene, frame, path)
    return paths


def contact_sheet(pictures: Pictures, captions: Sequence[str], path: Path) -> None:
    """Put up to six pictures, evenly spaced over the sequence, on one PNG."""
    chosen = evenly_spaced(len(pictures), 6)
    columns = min(3, len(chosen))
    rows = -(-len(chosen) // columns)
    figure = Figure(figsize=(4.8 * columns, 3.8 * rows), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes in grid.flat:
        axes.axis("off")
    for axes, number in zip(grid.flat, chosen, strict=False):
        axes.imshow(image.imread(pictures[number]))
        axes.set_title(captions[number], fontsize=11)
    FigureCanvasAgg(figure).print_figure(path, dpi=120)


def evenly_spaced(total: int, wanted: int) -> list[int]:
    """Return up to ``wanted`` indices out of ``total``: the last, the first, and some between."""
    last_first = np.linspace(total - 1, 0, min(wanted, total))
    return np.unique(last_first.round().astype(int)).tolist()


@cache
def can_use_pyvista() -> bool:
    """Tell whether VTK draws on this machine; tried in another process, as VTK may crash."""
    attempt = (
        "import pyvista; plotter = pyvista.Plotter(off_screen=True);"
        "plotter.add_mesh(pyvista.Sphere()); assert plotter.screenshot(None).std() > 0"
    )
    try:
        done = subprocess.run([sys.executable, "-c", attempt], capture_output=True, timeout=120)
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def _particle_radius(positions: NDArray) -> float:
    """Return a little more than half the typical distance of neighbours."""
    if len(positions) < 2:
        return 0.01
    distance, _ = cKDTree(positions).query(positions, k=2)
    return 0.6 * float(np.median(distance[:, 1]))


def _speeds(fluid: Frame) -> NDArray[np.float64]:
    """Return the particles' speeds, shape (N,); zero where the dump holds no velocities."""
    if "vx" not in fluid.columns:
        return np.zeros(len(fluid))
    return np.linalg.norm(fluid.velocities, axis=1)


def _top_speed(speeds: NDArray) -> float:
    """Return a speed that few particles exceed, never zero."""
    return float(np.quantile(speeds, 0.98)) or 1.0 if len(speeds) else 1.0


def _draw_with_pyvista(scene: Scene, frame: Frame, path: Path) -> None:
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    # a machine without a screen makes VTK complain of the X server before it draws all the same
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    plotter = pyvista.Plotter(off_screen=True, window_size=list(PICTURE_SIZE), lighting="none")
    plotter.set_background(SKY_COLOURS[0], top=SKY_COLOURS[1])
    _add_lights(plotter, scene)
    _add_floor(plotter, scene)
    _add_cloth(plotter, scene, frame)
    _add_water(plotter, scene, frame.select(scene.fluid_type))
    plotter.enable_ssao(radius=6 * scene.radius, bias=0.2 * scene.radius)
    plotter.enable_anti_aliasing("ssaa")
    plotter.camera_position = (scene.camera.position, scene.camera.target, (0, 0, 1))
    plotter.camera.view_angle = VIEW_ANGLE
    plotter.reset_camera_clipping_range()
    plotter.screenshot(path)
    plotter.close()


def _add_lights(plotter: pyvista.Plotter, scene: Scene) -> None:
    """Add a light from above, one from beside the camera and a faint one from behind."""
    import pyvista

    target, distance = scene.camera.target, scene.camera.distance
    for direction, intensity in (
        ((0.3, -1, 2.0), 0.75),
        ((1, -1.5, -0.3), 0.55),
        ((-1, 1, 1), 0.2),
    ):
        position = target + distance * np.array(direction)
        light = pyvista.Light(position=position, focal_point=target, intensity=intensity)
        plotter.add_light(light)


def _add_floor(plotter: pyvista.Plotter, scene: Scene) -> None:
    """Add a round plate below the sheet."""
    import pyvista

    plate = pyvista.Disc(center=scene.floor, inner=0, outer=0.8 * scene.extent, c_res=90)
    plotter.add_mesh(plate, color=FLOOR_COLOUR, ambient=0.4, diffuse=0.7)


def _add_cloth(plotter: pyvista.Plotter, scene: Scene, frame: Frame) -> None:
    """Add the sheet, its two sides in two shades, and its pins."""
    import pyvista

    points = scene.mesh.positions(frame)
    plotter.add_mesh(
        pyvista.PolyData.from_regular_faces(points, scene.mesh.triangles),
        color=CLOTH_COLOUR,
        backface_params={"color": CLOTH_BACK_COLOUR},
        smooth_shading=True,
        show_edges=True,
        edge_color="#6b4a22",
        edge_opacity=0.25,
        ambient=0.2,
    )
    if len(scene.pinned):
        pin = pyvista.Sphere(radius=PIN_RADIUS * scene.extent)
        pins = pyvista.PolyData(points[scene.pinned]).glyph(geom=pin, scale=False, orient=False)
        plotter.add_mesh(pins, color=PIN_COLOUR)


def _add_water(plotter: pyvista.Plotter, scene: Scene, fluid: Frame) -> None:
    """Add the particles as balls, brighter the faster they are."""
    import pyvista

    if not len(fluid):
        return
    cloud = pyvista.PolyData(fluid.positions)
    cloud["speed"] = _speeds(fluid)
    ball = pyvista.Sphere(radius=scene.radius, theta_resolution=10, phi_resolution=8)
    plotter.add_mesh(
        cloud.glyph(geom=ball, scale=False, orient=False),
        scalars="speed",
        cmap=WATER,
        clim=(0, scene.top_speed),
        smooth_shading=True,
        specular=0.3,
        ambient=0.3,
        show_scalar_bar=False,
    )


def _draw_with_matplotlib(scene: Scene, frame: Frame, path: Path) -> None:
    """Draw cloth, water and pins as polygons, the far ones first so that near ones hide them."""
    figure = Figure(figsize=(PICTURE_SIZE[0] / 100, PICTURE_SIZE[1] / 100))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    width, height = HALF_EXTENT
    axes.set(xlim=(-width, width), ylim=(-height, height))
    sky = colors.LinearSegmentedColormap.from_list("sky", SKY_COLOURS)
    extent = (-width, width, -height, height)
    axes.imshow([[0.0], [1.0]], cmap=sky, interpolation="bicubic", origin="lower", extent=extent)
    fluid = frame.select(scene.fluid_type)
    cloth = scene.mesh.corners(frame)
    pins = scene.mesh.positions(frame)[scene.pinned]
    water = _discs(fluid.positions, scene.radius)
    outlines = [cloth, water, _discs(pins, PIN_RADIUS * scene.extent)]
    shades = np.concatenate([_cloth_shades(cloth), _water_shades(scene, fluid), _pin_shades(pins)])
    projected = [scene.camera.project(outline) for outline in outlines]
    depths = np.concatenate([depth.mean(axis=1) for _, depth in projected])
    polygons = [polygon for places, _ in projected for polygon in places]
    far_first = np.argsort(-depths)
    axes.add_collection(
        PolyCollection(
            [polygons[i] for i in far_first],
            facecolors=shades[far_first],
            edgecolors=0.85 * shades[far_first],
            linewidths=0.4,
        )
    )
    FigureCanvasAgg(figure).print_figure(path, dpi=100)


def _cloth_shades(corners: NDArray) -> NDArray[np.float64]:
    """Return the colour of each triangle lit from above, shape (T, 3)."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    slope = np.abs(normals[:, 2:]) / np.where(lengths > 0, lengths, 1)
    return (0.45 + 0.55 * slope) * colors.to_rgb(CLOTH_COLOUR)


def _water_shades(scene: Scene, fluid: Frame) -> NDArray[np.float64]:
    """Return the colour of each particle by its speed, shape (N, 3)."""
    return WATER(_speeds(fluid) / scene.top_speed)[:, :3]


def _pin_shades(pins: NDArray) -> NDArray[np.float64]:
    """Return one colour for all pins, shape (K, 3)."""
    return np.tile(colors.to_rgb(PIN_COLOUR), (len(pins), 1))


def _discs(centres: NDArray, radius: float) -> NDArray[np.float64]:
    """Return a hexagon that faces the camera around each centre, shape (N, 6, 3)."""
    angles = np.arange(6) * np.pi / 3
    rim = np.outer(np.cos(angles), RIGHT) + np.outer(np.sin(angles), UP)
    return centres[:, None] + radius * rim

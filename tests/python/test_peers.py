"""sphcloth bench peers: the density it measures, the cost at equal error, and what is missing."""

import io
import itertools
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from sphcloth.bench import peers, splishsplash
from sphcloth.bench.peers import Code, Point, at_equal_error, bench_peers, cost_at, front
from sphcloth.bench.water_density import DensityError, densities, density_error, inside
from sphcloth.errors import UserError
from sphcloth.run import lammps_command
from sphcloth.trajectory import Trajectory

TINY = {"across": 15, "steps": 5}


def block(*counts: int) -> np.ndarray:
    return np.array(list(itertools.product(*map(range, counts))), dtype=float)


def test_the_density_of_a_lattice_is_that_of_its_spacing() -> None:
    x = block(11, 11, 11)
    middle = np.linalg.norm(x - 5, axis=1) < 1.5
    assert densities(x, 1.0)[middle] == pytest.approx(1.003, abs=0.001)
    # squeezed by 2 % in each direction, in the same spacing
    assert densities(0.98 * x, 1.0)[middle] == pytest.approx(1.003 * 0.98**-3, abs=0.002)


def test_particles_with_water_all_around_are_inside() -> None:
    x = block(9, 8, 7)
    found = x[inside(x, 1.0)]
    # all but two layers at every face
    assert len(found) == 5 * 4 * 3
    assert (found.min(axis=0) == 2).all()
    # a hole in the place of seven is no water
    hole = x[np.linalg.norm(x - [4, 4, 3], axis=1) > 1.2]
    assert [6, 4, 3] in found.tolist()
    assert [6, 4, 3] not in hole[inside(hole, 1.0)].tolist()


def test_the_error_is_that_of_all_frames_and_its_tail() -> None:
    x = block(9, 9, 9)
    error = density_error([x, 0.99 * x], 1.0)
    assert error.samples == 2 * 125
    assert error.tail == pytest.approx(1.003 * 0.99**-3 - 1, abs=0.002)
    assert error.mean == pytest.approx(0.5 * (0.003 + 0.033), abs=0.003)
    assert error.bias == error.mean


def test_water_stays_whole_where_steps_are_unequal(tmp_path: Path) -> None:
    """By default: with steps of neighbors in a ratio of 4 holes of half the density open."""
    settings = {"code": "double", "scheme": "block", "sound": "30", "time": "0.2"}
    command = lammps_command(Path(peers.__file__).parent / "in.peers", 1, settings)
    subprocess.run(command, cwd=tmp_path, check=True, stdout=subprocess.DEVNULL)
    frames = [frame.positions for frame in Trajectory(tmp_path / "water.dump")]
    error = density_error(frames[3:], 0.05)
    assert len(frames) == 6
    assert error.mean < 0.01 and error.tail < 0.04


def test_too_little_water_is_an_error_that_says_what_to_do() -> None:
    with pytest.raises(UserError, match="--across 15 or more"):
        density_error([block(4, 4, 4)], 1.0)
    with pytest.raises(UserError, match="--steps 2 ends before"):
        bench_peers(1, 20, 2, Console(file=io.StringIO()))


def test_cost_at_an_error_follows_the_front() -> None:
    points = [(0.04, 1.0), (0.01, 4.0), (0.02, 9.0)]
    assert front(points) == [(0.04, 1.0), (0.01, 4.0)]
    assert cost_at(0.02, points) == pytest.approx(2.0)
    assert cost_at(0.01, points) == pytest.approx(4.0)
    # the cheapest is good enough; none is
    assert cost_at(0.1, points) == 1.0
    assert cost_at(0.005, points) is None
    assert cost_at(0.01, []) is None


def test_ratios_are_taken_round_by_round() -> None:
    def point(code: str, seconds: list[float], mean: float) -> Point:
        error = DensityError(mean=mean, tail=4 * mean, bias=0.0, samples=9)
        return Point(code, {"sound": 30.0}, seconds, 10, error)

    ours = [point("sphcloth double", [1.0, 2.0], 0.01), point("sphcloth mixed", [2.0, 1.0], 0.01)]
    peer = point("stock sph", [20.0, 30.0], 0.02)
    ratio = at_equal_error(peer, ours, "mean")
    assert ratio == {"value": 25.0, "least": 20.0, "most": 30.0}
    assert at_equal_error(point("stock sph", [20.0, 30.0], 0.001), ours, "mean") is None


def test_a_peer_that_is_not_installed_or_fails_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(splishsplash, "is_installed", lambda: False)
    monkeypatch.setattr(peers, "find_spec", lambda name: None)
    plan = {
        "sphcloth double": Code("sph", {"code": "double"}, [{"sound": 30}]),
        "stock sph": Code("sph", {"code": "stock", "courant": 0.12}, [{"sound": 30}]),
        "stock sph, too fast": Code("sph", {"code": "stock", "courant": 2}, [{"sound": 30}]),
        "SPlisHSPlasH DFSPH": Code("dfsph", {}, [{"max_error": 0.1}]),
    }
    said = io.StringIO()
    console = Console(file=said, width=200)
    result = bench_peers(1, **TINY, console=console, plan=plan, sheet_across=12)
    assert result["particles"] == 15 * 6 * 30
    assert set(result["water"]) == {*plan} - {"SPlisHSPlasH DFSPH"}
    ours, stock, failed = (result["water"][code][0] for code in list(plan)[:3])
    assert 0.001 < ours["density_error"]["mean"] < 0.05
    assert ours["cpu_s_per_s"]["value"] > 0
    # step and speed of sound decide the steps: 0.2 s at 0.12 h_s / c0
    assert stock["steps"] == pytest.approx(0.2 / (0.12 / 15 / 30), abs=1)
    assert set(stock["over_ours"]) == {"mean", "tail"}
    assert "LAMMPS failed" in failed["failed"]
    assert result["sheet"]["cpu_s_per_s"].keys() == {"sphcloth"}
    assert "SPlisHSPlasH is not installed: pip install 'sphcloth[peers]'" in said.getvalue()
    assert "pypbd is not installed: pip install 'sphcloth[peers]'" in said.getvalue()


def test_a_scene_has_the_particles_and_walls_of_the_others() -> None:
    tank = (np.full(3, -0.05), np.array([3.0, 0.45, 3.0]))
    weak = splishsplash.scene("wcsph", (20, 8, 40), 0.05, tank, {"sound": 35.0, "courant": 0.5})
    settings = weak["Configuration"]
    assert settings["simulationMethod"] == 0
    assert settings["particleRadius"] == 0.025
    # dp/drho at rest is gamma B / rho0
    assert settings["WCSPH"]["stiffness"] * 7 / 1000 == pytest.approx(35.0**2)
    assert settings["timeStepSize"] == pytest.approx(0.5 * 0.05 / 35.0)
    box = weak["RigidBodies"][0]
    assert np.array(box["translation"]) - 0.5 * np.array(box["scale"]) == pytest.approx(tank[0])
    free = splishsplash.scene("dfsph", (20, 8, 40), 0.05, tank, {"max_error": 0.3})
    assert free["Configuration"]["DFSPH"]["maxError"] == 0.3
    thick = splishsplash.scene(
        "dfsph", (20, 8, 40), 0.05, tank, {"max_error": 0.3, "viscosity": 0.02}
    )
    found = [each["Materials"][0]["Standard viscosity"]["viscosity"] for each in (free, thick)]
    assert found == [0.01, 0.02]


def bundled(folder: Path) -> Path:
    """A module as pip installs it, without content."""
    (folder / "pysplishsplash.libs").mkdir(parents=True)
    names = [f"{name}-0123abcd.so.1" for name in splishsplash.GL_LIBRARIES]
    for name in [*names, "libgomp-0123abcd.so.1"]:
        (folder / "pysplishsplash.libs" / name).write_text(name)
    module = folder / "pysplishsplash.cpython-311.so"
    module.write_text("module")
    return module


def test_the_copy_has_the_system_s_libraries_and_the_original_stays(tmp_path: Path) -> None:
    module = bundled(tmp_path / "site")
    before = sorted(str(p) for p in (tmp_path / "site").rglob("*"))
    system = {name: tmp_path / f"{name}.so.7" for name in splishsplash.GL_LIBRARIES}
    splishsplash.copy_with_system_gl(module, tmp_path / "copy", system)
    libraries = tmp_path / "copy/pysplishsplash.libs"
    assert (libraries / "libGLU-0123abcd.so.1").readlink() == tmp_path / "libGLU.so.7"
    assert (libraries / "libgomp-0123abcd.so.1").read_text() == "libgomp-0123abcd.so.1"
    assert (tmp_path / "copy" / module.name).read_text() == "module"
    assert sorted(str(p) for p in (tmp_path / "site").rglob("*")) == before


def test_a_system_without_opengl_is_told_what_to_install(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"needs the system's libGL\w*: apt install libglu1-mesa"):
        splishsplash.copy_with_system_gl(bundled(tmp_path / "site"), tmp_path / "copy", {})


def test_the_system_s_libraries_are_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake = tmp_path / "ldconfig"
    rows = [
        "2 libs found in cache",
        "\tlibGLU.so.1 (libc6,x86-64) => /lib/x86_64-linux-gnu/libGLU.so.1",
        "\tlibGLX.so.0 (libc6) => /lib/i386-linux-gnu/libGLX.so.0",
    ]
    fake.write_text("#!/bin/sh\ncat <<'END'\n" + "\n".join(rows) + "\nEND\n")
    fake.chmod(0o755)
    monkeypatch.setenv("PATH", os.pathsep.join([str(tmp_path), os.environ["PATH"]]))
    assert splishsplash.system_libraries() == {"libGLU": Path("/lib/x86_64-linux-gnu/libGLU.so.1")}


@pytest.mark.skipif(not splishsplash.is_installed(), reason="needs pysplishsplash")
def test_splishsplash_runs_the_same_water(tmp_path: Path) -> None:
    dam = peers.Dam(tmp_path, 10, 0.08)
    try:
        dam.prepare_splishsplash()
    except UserError as error:
        pytest.skip(str(error))
    seconds, steps, frames = dam(Code("dfsph", {}, []), {"max_error": 0.3})
    assert (len(frames), frames[0].shape) == (2, (dam.particles, 3))
    assert seconds > 0
    assert steps >= 0.08 / 0.005
    # it has begun to fall
    assert frames[-1][:, 2].mean() == pytest.approx(1.0 - 0.5 * 9.81 * 0.08**2, abs=0.02)
    assert sys.modules.get("pysplishsplash") is None

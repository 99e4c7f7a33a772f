"""What LAMMPS's releases do differently stands in one header, and atom IDs keep LAMMPS's type.

The header is compiled with declarations as each release has them; ``tests/source_check.py`` builds
and runs against real ones.
"""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src/USER-SPHCLOTH"
HEADER = PACKAGE / "lammps_util/lammps_version.h"
SOURCES = sorted(
    path for path in (ROOT / "src").rglob("*") if path.suffix in (".h", ".cpp") and path != HEADER
)

# what only the header may say: the release, and calls that releases declare differently
SPREAD = (
    r"LAMMPS_VERSION\b",
    r"domain->minimum_image(_big)?\(",
    r"utils::print\(",
)
# in a pair style, the number of values; in a dihedral style, the flag for fix adapt
SPREAD_IN = {"pair_*": r"comm->forward_comm\(", "dihedral_*": r"\breinitflag\b"}

# an atom ID has 8 bytes with LAMMPS_BIGBIG; LAMMPS's ownatom() takes an int, which it ignores
NARROWED = r"static_cast<int>\([^()]*\btag\b|\bint \w+ = \w+->tag\["
IGNORED = "ownatom(static_cast<int>(tag)"

# what differs, as releases declare it
MINIMUM_IMAGE = {
    20240829: "void minimum_image(double *) const {}",
    20250204: "void minimum_image(double *) const {}",
    20250722: "void minimum_image(const char *, int, double *) const {}",
}
FORWARD_COMM = {
    20240829: "void forward_comm(Pair *) {}",
    20250204: "void forward_comm(Pair *, int) {}",
    20250722: "void forward_comm(Pair *, int) {}",
}
REINITFLAG = {20240829: "", 20250204: "", 20250722: "int reinitflag;"}
RELEASES = sorted(MINIMUM_IMAGE)


def findings(pattern: str, sources: list[Path]) -> list[str]:
    """Return file and line of what matches; comments count, names of files do not."""
    return [
        f"{path.relative_to(ROOT)}:{n}: {line.strip()}"
        for path in sources
        for n, line in enumerate(path.read_text().splitlines(), 1)
        if re.search(pattern, line) and not line.startswith(("#include", "#ifndef", "#define"))
    ]


@pytest.mark.parametrize("pattern", SPREAD)
def test_one_header_knows_releases(pattern):
    assert re.search(pattern, HEADER.read_text())
    assert findings(pattern, SOURCES) == []


@pytest.mark.parametrize("files", SPREAD_IN)
def test_styles_ask_that_header(files):
    styles = sorted(PACKAGE.glob(f"{files}.cpp"))
    assert styles
    assert findings(SPREAD_IN[files], styles) == []


def test_atom_ids_keep_their_type():
    found = [line for line in findings(NARROWED, SOURCES) if IGNORED not in line]
    assert found == []


def stubs(folder: Path, release: int) -> None:
    """Write the headers that lammps_version.h includes, with what it calls."""
    headers = {
        "pointers.h": '#pragma once\n#define FLERR __FILE__, __LINE__\n#include "fmt.h"',
        "fmt.h": """#pragma once
            #include <string>
            namespace fmt {
            template <class... Args> struct format_string { format_string(const char *) {} };
            template <class F, class... Args> std::string format(F, Args &&...) { return {}; }
            }""",
        "force.h": """#pragma once
            #include <map>
            #include <string>
            namespace LAMMPS_NS {
            struct LAMMPS; struct Pair; struct Bond; struct Dihedral;
            template <class Style> using Creators = std::map<std::string, Style *(*)(LAMMPS *)>;
            struct Force {
              Creators<Pair> *pair_map; Creators<Bond> *bond_map; Creators<Dihedral> *dihedral_map;
            };
            }""",
        "modify.h": """#pragma once
            #include <map>
            #include <string>
            namespace LAMMPS_NS {
            struct LAMMPS; struct Fix; struct Compute;
            template <class Style>
            using CreatorsWithArgs = std::map<std::string, Style *(*)(LAMMPS *, int, char **)>;
            struct Modify {
              CreatorsWithArgs<Fix> *fix_map; CreatorsWithArgs<Compute> *compute_map;
            };
            }""",
        "input.h": """#pragma once
            #include "force.h"
            namespace LAMMPS_NS {
            struct Command; struct Input { Creators<Command> *command_map; };
            }""",
        "pair.h": "#pragma once\nnamespace LAMMPS_NS { struct Pair { int comm_forward; }; }",
        "lammps.h": "#pragma once\n"
        "namespace LAMMPS_NS { struct Update; struct Force; struct Modify; struct Input;\n"
        "struct LAMMPS { Update *update; Force *force; Modify *modify; Input *input; }; }",
        "update.h": """#pragma once
            #include <map>
            #include <string>
            namespace LAMMPS_NS {
            struct Integrate;
            struct Update {
              std::map<std::string, Integrate *(*)(LAMMPS *, int, char **)> *integrate_map;
            };
            }""",
        "comm.h": f"""#pragma once
            namespace LAMMPS_NS {{ struct Pair; struct Comm {{ {FORWARD_COMM[release]} }}; }}""",
        "domain.h": f"""#pragma once
            #include "pointers.h"
            namespace LAMMPS_NS {{ struct Domain {{ {MINIMUM_IMAGE[release]} }}; }}""",
        "use.cpp": f"""
            #include "lammps_util/lammps_version.h"
            using namespace LAMMPS_NS;
            struct Style {{ {REINITFLAG[release]} }};
            struct Plugin {{
              const char *style, *name;
              struct {{ void *(*v1)(void *); void *(*v2)(void *, int, char **); }} creator;
            }};
            void use(Domain *domain, double *d, Comm *comm, Pair *pair, Style *style, LAMMPS *lmp)
            {{
              release::add_to_each_instance(lmp, Plugin{{"pair", "name", {{}}}});
              release::minimum_image(domain, d);
              release::forward_comm(comm, pair, 2);
              release::not_for_fix_adapt(style);
            }}""",
    }
    for name, text in headers.items():
        (folder / name).write_text(text)


def compiles(folder: Path, release: int) -> tuple[bool, str]:
    """Return whether the header suits the declarations in ``folder``, and what was said."""
    options = [f"-DSPHCLOTH_LAMMPS_VERSION={release}", f"-I{folder}", f"-I{PACKAGE}"]
    done = subprocess.run(
        ["c++", "-std=c++17", "-fsyntax-only", *options, str(folder / "use.cpp")],
        capture_output=True,
        text=True,
    )
    return done.returncode == 0, done.stderr


@pytest.mark.parametrize("release", RELEASES)
def test_the_header_fits_a_release(tmp_path, release):
    stubs(tmp_path, release)
    fits, said = compiles(tmp_path, release)
    assert fits, said


@pytest.mark.parametrize(("built_for", "release"), [(20250722, 20250204), (20250204, 20240829)])
def test_the_header_of_another_release_does_not_fit(tmp_path, built_for, release):
    stubs(tmp_path, release)
    fits, said = compiles(tmp_path, built_for)
    assert not fits and "error" in said


def test_a_release_that_is_too_old_is_named(tmp_path):
    stubs(tmp_path, 20240829)
    assert "needs LAMMPS 29 Aug 2024 or newer" in compiles(tmp_path, 20230802)[1]

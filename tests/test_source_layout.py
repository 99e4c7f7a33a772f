"""The layout of the C++: which folder may include which, sizes, and words that are not ours.

A finding is a rule, a file and how often the file breaks the rule. What broke a rule when the rule
came is in ``EXCEPTIONS``, which can only shrink: a file may break a rule less often than its entry
says, never more often, and an entry that is not needed any more must be deleted.
``python tests/test_source_layout.py`` prints the entries of today.
"""

import re
from collections import Counter, defaultdict
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src/USER-SPHCLOTH"
COLUMNS, LINES, PROTOTYPES = 100, 500, 30
LICENSE_LINE = "SPDX-License-Identifier: GPL-2.0-or-later"

# From the bottom to the top: a file includes its own folder and those before it. The top, "", are
# the styles, which are flat. So core/ includes nothing of LAMMPS or outside of core/.
FLOORS = [
    *("core/util", "core/geometry", "core/timestep", "core/contact"),
    *("core/neighbor", "core/sph", "core/pbd", "core/air", "core/pores"),
    *("lammps_util", "cloth", "contact", "fluid", "stepping", "air", "pores", ""),
]

# whole words, in code and comments; CONTRIBUTING has those of the field in their place
PRIVATE_WORDS = """
who whoever somebody everybody nobody anybody someone everyone anyone
lend lends lent owe owes owed OWED arrears there_and_back keep_springs share_of_spring odometer
NearLists SheetWall SheetWalls FluidWall ClothGuest Crowd Foot feet FIRM HAIR NAP
"""
# whole names in code; a comment may use the word
PRIVATE_NAMES = """
most least far FAR MOST_\\w+ LEAST_\\w+ amount amounts own crowd sight set_sight
look looks settle unsettle settled place places Place PLACE places_then PATIENCE in_fronts
"""
# British spellings: of these stems, wherever they stand, and of words with these ends
BRITISH_STEMS = "neighbour colour behaviour centre licence catalogue travell modelle labell"
BRITISH_ENDS = "ise ised ises ising isation isations our ours oured ouring"
# words of the field, and names of others, that end so in American English, too
AMERICAN_WORDS = """
advise advised arise clockwise concise elementwise exercise likewise noise otherwise pairwise
precise premise promise raise raised raises raising revise rise rises rising wise
contour contours detour four hour hours our ours pour poured pouring pours your
"""
# where British words are data: tables of spellings, and an option of the command line
SPELLING_TABLES = ("tests/test_documentation_text.py", "tests/test_source_layout.py")
BRITISH_OPTION = "--colour-by"


def whole(names: str) -> re.Pattern:
    return re.compile(rf"\b(?:{'|'.join(names.split())})\b")


PRIVATE, NAMES = whole(PRIVATE_WORDS), whole(PRIVATE_NAMES)
BRITISH = re.compile(
    rf"(?:{'|'.join(BRITISH_STEMS.split())})"
    rf"|(?<![a-z])[a-z]+(?:{'|'.join(BRITISH_ENDS.split())})(?![a-z])",
    re.IGNORECASE,
)
QUOTED = r"""(?:"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])')"""

EXCEPTIONS: dict[tuple[str, str], int] = {}


def sources(*folders: str) -> dict[str, str]:
    paths = [path for name in folders for path in sorted((ROOT / name).rglob("*.[hc]*"))]
    return {
        str(path.relative_to(ROOT)): path.read_text()
        for path in paths
        if path.suffix in (".h", ".cpp")
    }


# includes


def floor(module: str) -> int:
    parts = module.split("/")
    return FLOORS.index("/".join(parts[: 2 if parts[0] == "core" else 1]) if parts[1:] else "")


def includes() -> dict[str, set[str]]:
    """Which files of the package, or others, each file of it includes."""
    graph = {}
    for path in sorted([*PACKAGE.rglob("*.h"), *PACKAGE.rglob("*.cpp")]):
        found = set()
        for name in re.findall(r'^#include ["<](.*)[">]', path.read_text(), re.MULTILINE):
            near = [folder / name for folder in (PACKAGE, path.parent)]
            ours = [one.resolve() for one in near if one.is_file()]
            found.add(str(ours[0].relative_to(PACKAGE)) if ours else f"outside: {name}")
        graph[str(path.relative_to(PACKAGE))] = found
    return graph


def module_of(file: str) -> str:
    """A header and its source are one."""
    return file.rpartition(".")[0]


def upward(graph: dict[str, set[str]]) -> Counter:
    found: Counter = Counter()
    for file, names in graph.items():
        for name in names:
            if name.startswith("outside: "):
                foreign = name.endswith(".h") and not name.endswith("intrin.h")
                wrong = file.startswith("core/") and foreign
            else:
                wrong = floor(module_of(name)) > floor(module_of(file))
            found["upward include", f"src/USER-SPHCLOTH/{file}"] += wrong
    return found


def cycles(graph: dict[str, set[str]]) -> Counter:
    """How many modules each module is in a cycle with, itself among them."""
    modules = defaultdict(set)
    for file, names in graph.items():
        modules[module_of(file)] |= {module_of(n) for n in names if not n.startswith("outside: ")}

    def reach(start: str) -> set[str]:
        seen, rest = set(), [start]
        while rest:
            new = modules[rest.pop()] - seen - {start}
            seen |= new
            rest += new
        return seen

    below = {module: reach(module) for module in list(modules)}
    found: Counter = Counter()
    for module, others in below.items():
        if n := sum(module in below[other] for other in others):
            found["include cycle", f"src/USER-SPHCLOTH/{module}"] = 1 + n
    return found


# sizes


def without_text(code: str) -> str:
    """The code without comments, preprocessor lines and what is in quotation marks."""
    code = re.sub(f"//[^\n]*|/\\*.*?\\*/|{QUOTED}", " ", code, flags=re.DOTALL)
    return re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", "", code, flags=re.MULTILINE)


def inside(code: str, brace: int) -> str:
    """What is between this brace and its partner, without what is between braces in it."""
    depth, out = 0, []
    for c in code[brace:]:
        depth += c == "{"
        if depth == 1 or (depth == 2 and c in "{}"):
            out.append(c)
        depth -= c == "}"
        if depth == 0:
            break
    return "".join(out)


def prototypes(code: str) -> dict[str, int]:
    """How many functions each class declares and leaves to its source file to define.

    A heuristic: a name, parameters in parentheses, perhaps const, noexcept, override, final or
    ``= 0``, and a semicolon, at the first level of the braces of the class. Constructors and what
    LAMMPS calls count as all others do; what is defined in the class at once does not.
    """
    count = {}
    code = without_text(code)
    for found in re.finditer(r"(?<!enum )\b(?:class|struct)\s+(\w+)[^;{}()=<>]*\{", code):
        parameters = r"\((?:[^(){}]|\([^(){}]*\))*\)"
        end = r"(?:\s|const|noexcept|override|final|=\s*0)*;"
        declared = re.findall(rf"\w\s*{parameters}{end}", inside(code, found.end() - 1))
        count[found[1]] = len(declared)
    return count


def sizes() -> Counter:
    found: Counter = Counter()
    for file, text in sources("src", "tests/core").items():
        lines = text.splitlines()
        found[f"above {COLUMNS} columns", file] = sum(len(line) > COLUMNS for line in lines)
        found[f"above {LINES} lines", file] = len(lines) if len(lines) > LINES else 0
        for name, n in prototypes(text).items():
            found[f"above {PROTOTYPES} prototypes: {name}", file] = n if n > PROTOTYPES else 0
    return found


def test_python_has_no_persons_either() -> None:
    """In the code and comments of tests and of the package; the lists of refused words excepted."""
    persons = re.compile(r"\b(?:who|(?:some|every|no|any)body|(?:some|every|any)one|lent|owed)\b")
    refused = ("tests/test_source_layout.py", "tests/test_documentation_text.py")
    found = {
        file: words
        for folder in ("tests", "python")
        for path in (ROOT / folder).rglob("*.py")
        if (file := str(path.relative_to(ROOT))) not in refused
        and (words := persons.findall(path.read_text()))
    }
    assert not found


def test_python_files_are_short() -> None:
    long = {
        str(path.relative_to(ROOT)): n
        for folder in ("tests", "python")
        for path in (ROOT / folder).rglob("*.py")
        if (n := len(path.read_text().splitlines())) > LINES
    }
    assert not long, f"above {LINES} lines, to be split by subject: {long}"


def test_files_of_tests_have_names_of_their_own() -> None:
    """Folders of tests are no packages: pytest collects one file alone of two with one name."""
    counts = Counter(path.name for path in (ROOT / "tests").rglob("test_*.py"))
    assert not [name for name, n in counts.items() if n > 1]


# words


def scripts() -> dict[str, str]:
    """What is neither C++ nor the package: build files, tests, and input of the examples."""
    paths = [ROOT / "Makefile", ROOT / "CMakeLists.txt", *(ROOT / "cmake").rglob("*")]
    paths += [*(ROOT / "packaging").rglob("*")]
    paths += [*(ROOT / "examples").glob("*/in.*"), *(ROOT / "tests").rglob("*.py")]
    paths += [*(ROOT / "tests").rglob("*.txt"), *(ROOT / "tests").rglob("in.*")]
    paths = [path for path in paths if path.is_file() and path.suffix != ".pyc"]
    texts = {str(path.relative_to(ROOT)): path.read_text() for path in paths}
    return {file: text for file, text in texts.items() if file not in SPELLING_TABLES}


def british(text: str) -> list[str]:
    found = [one[0].lower() for one in BRITISH.finditer(text.replace(BRITISH_OPTION, ""))]
    return [word for word in found if word not in AMERICAN_WORDS.split()]


def words() -> Counter:
    """Words in code and comments, names in code; the texts of messages may use all of them."""
    found: Counter = Counter()
    for file, source in sources("src").items():
        found["private word", file] = len(PRIVATE.findall(re.sub(QUOTED, "", source)))
    for file, source in sources("src", "tests/core").items():
        found["private name", file] = len(NAMES.findall(without_text(source)))
        found["British spelling", file] = len(british(source))
    for file, text in scripts().items():
        found["British spelling", file] = len(british(text))
    return found


def licenses() -> Counter:
    """C++ without its license in the first line."""
    return Counter(
        {
            ("no license line", file): 1
            for file, text in sources("src", "tests/core").items()
            if not text.startswith(f"// {LICENSE_LINE}\n")
        }
    )


def findings() -> Counter:
    graph = includes()
    return +(upward(graph) + cycles(graph) + sizes() + words() + licenses())


FOUND = findings()


@pytest.mark.parametrize(("rule", "file"), sorted(FOUND), ids=str)
def test_rules_are_kept(rule: str, file: str) -> None:
    allowed = EXCEPTIONS.get((rule, file), 0)
    found = FOUND[rule, file]
    assert found <= allowed, (
        f"{file}: {rule}: {found}, at most {allowed}; nothing is added to the list"
    )


def entry(rule: str, file: str) -> str:
    n = FOUND[rule, file] or EXCEPTIONS[rule, file]
    return f'    ("{rule}", "{file}"): {n},'


def test_exceptions_are_needed() -> None:
    mended = [entry(*key) for key in EXCEPTIONS if not FOUND[key]]
    assert not mended, "mended, to be deleted from EXCEPTIONS:\n" + "\n".join(mended)


def test_cycles_and_upward_includes_are_found() -> None:
    graph = {"fix_a.h": {"stepping/b.h"}, "stepping/b.cpp": {"fix_a.h"}, "core/sph/d.h": set()}
    graph |= {"stepping/b.h": set(), "core/util/c.h": {"core/sph/d.h", "outside: atom.h"}}
    package = "src/USER-SPHCLOTH"
    cycle = [("include cycle", f"{package}/{module}") for module in ("fix_a", "stepping/b")]
    assert +cycles(graph) == dict.fromkeys(cycle, 2)
    found = {file: n for (_, file), n in (+upward(graph)).items()}
    assert found == {f"{package}/stepping/b.cpp": 1, f"{package}/core/util/c.h": 2}


def test_what_a_prototype_is() -> None:
    code = """
    struct Plain { double x = 1.0; int n[3]; };
    class Some : public Other {
     public:
      Some(int a) : Other(a), b{1} {}
      ~Some() override;
      int init() override { if (b(1)) { return 2; } return f(3); }
      double g(double (*f)(double)) const noexcept;
      virtual void h(int) = 0;    // not(this);
      std::function<double(int)> member;
      template <class T> T k(const T &t) const { return t; }
    };
    """
    assert prototypes(code) == {"Plain": 0, "Some": 3}


def test_what_a_name_and_a_british_word_are() -> None:
    assert NAMES.findall(without_text('int most = at_most(MOST_ROWS);  // most of "own"')) == [
        "most",
        "MOST_ROWS",
    ]
    assert british("n_neighbours vectorised normalisation, otherwise four noise_rise") == [
        "neighbour",
        "vectorised",
        "normalisation",
    ]
    assert british("armour, the --colour-by of Poiseuille") == ["armour"]


if __name__ == "__main__":
    print("\n".join(entry(*key) for key in sorted(FOUND)))

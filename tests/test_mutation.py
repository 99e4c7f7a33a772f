"""The tool that draws mutants: what it finds and writes, and what is argued to be equivalent."""

import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src/USER-SPHCLOTH"
CODE = b"""#include <algorithm>
#include <cstdio>
constexpr int N = 3;
template <int K> int twice() { static_assert(K > 1); return K * 2; }
struct Sum { double x = 0.5; Sum eval() const { return *this; } };
int main()
{
  double a[N + 1] = {1.0, 2.0}, sum = 0.0;
  for (int k = 0; k < 2; k++) sum += a[k];    // 3
#pragma omp simd
  for (int k = 0; k < 2; k++) a[k] = -a[k];
  if (sum > 2.5 && !(a[0] == 0.0)) sum = std::max(sum,
                                                  4.0);
  else sum = 7.0;
  if constexpr (N > 2) sum *= twice<2>();
  std::printf("%g %g\\n", sum, a[1]);
}
"""


def test_equivalent_mutants_fit_the_sources():
    """Each names a line of code that is there, and a reason."""
    for entry in tomllib.loads((ROOT / "tests/mutation/equivalent.toml").read_text())["mutant"]:
        assert entry["code"] in (SOURCE / entry["file"]).read_text(), entry
        assert 0 <= entry["column"] < len(entry["code"]), entry
        assert len(entry["reason"]) > 20 and entry["right"] != entry["wrong"]


def test_faults_of_the_past_fit_the_sources():
    """Each is an expression that is there once, with what went wrong."""
    for entry in tomllib.loads((ROOT / "tests/mutation/faults.toml").read_text())["fault"]:
        assert (SOURCE / entry["file"]).read_text().count(entry["right"]) == 1, entry
        assert len(entry["what"]) > 20 and entry["right"] != entry["wrong"]


def printed(program: Path, number: int) -> str:
    done = subprocess.run(
        [program], env={"SPHCLOTH_MUTANT": str(number)}, capture_output=True, text=True, timeout=60
    )
    return done.stdout.strip() if done.returncode == 0 else f"ended with {done.returncode}"


def test_one_program_holds_all_mutants(tmp_path):
    """Without a mutant it prints what it should, with each of those below something else."""
    pytest.importorskip("tree_sitter_cpp")
    from mutation.population import put_back
    from mutation.schemata import with_mutants
    from mutation.sites import mutants_of

    one_of_each_place = {(m.start, m.end, m.operator): m for m in mutants_of("a.cpp", CODE)}
    mutants = list(one_of_each_place.values())
    # an expression in which others lie
    fault = {"file": "a.cpp", "right": "sum > 2.5 && !(a[0] == 0.0)", "wrong": "sum < 2.5"}
    mutants.append(put_back(CODE, fault))
    found = [(m.line, m.operator, m.readable(m.wrong, CODE)) for m in mutants]
    assert not [one for one in found if one[0] in (3, 4, 11) and one[1] == "comparison"]
    text = with_mutants(CODE, list(enumerate(mutants)))
    assert text.count(b"\n") == CODE.count(b"\n")
    source, program = tmp_path / "a.cpp", tmp_path / "a"
    source.write_bytes(text)
    header = ROOT / "tests/mutation/mutant.h"
    command = ["g++", "-std=c++17", "-w", "-include", header, source, "-o", program]
    subprocess.run(command, check=True, timeout=300)
    assert printed(program, -1) == "16 -2"
    for what, expected in {
        (9, "assignment", "(sum) -= (a[k])"): "28 -2",
        (9, "comparison", "(k) <= (2)"): "16 -2",
        (9, "removal", ""): "28 -2",
        (11, "negation", "(a[k])"): "16 2",
        (11, "removal", ""): "16 2",
        (12, "comparison", "(sum) >= (2.5)"): "16 -2",
        (12, "comparison", "(a[0]) != (0.0)"): "28 -2",
        (12, "logic", "(sum > 2.5) || (!(a[0] == 0.0))"): "16 -2",
        (12, "extremum", "std::min(sum, 4.0)"): "12 -2",
        (12, "constant", "static_cast<decltype(2.5)>(2 * 2.5)"): "28 -2",
        (14, "removal", ""): "16 -2",
        (15, "assignment", "(sum) /= (twice<2>())"): "1 -2",
        (12, "fault", "sum < 2.5"): "28 -2",
    }.items():
        assert what in found, f"{what} is not among {found}"
        assert printed(program, found.index(what)) == expected, what

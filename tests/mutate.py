"""Deliberate bugs in the numerics: each must be caught by a test.

``python tests/mutate.py [NAME ...]`` copies the sources, puts one bug after the other in, builds
and runs the tests that should see it. A test that sees a bug must pass without it. Nothing of the
tree or the installed package is touched. What a run has written to ``--json`` is not run again, as
long as the sources, the bug and its tests are the same.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

ROOT = Path(__file__).parents[1]
SOURCE = Path("src/USER-SPHCLOTH")
BIN = Path(sys.executable).parent
# s, for the tests of one bug: an endless loop does not pass either.  Counted in waits of a second
# each, since a machine may stop all processes for longer
PATIENCE = 300
COPIED = ("src", "cmake", "python", "tests", "examples", "docs")
DECIDING = ("src", "cmake", "tests/core", "tests/styles")
CORE = "tests/core"  # the part of it that needs no library
TEST_FAILURE = 201  # exit code of a program of Boost.Test
CORES = f"-j{len(os.sched_getaffinity(0))}"
# an order of magnitude fewer seconds for a header that all loops include
QUICK = ("-DCMAKE_BUILD_TYPE=Release", "-DSPHCLOTH_QUICK_BUILD=ON")


@dataclass(frozen=True)
class Bug:
    """What is put in the place of what, in which file, and the tests that must see it."""

    name: str
    file: str
    old: str
    new: str
    tests: str

    def places(self) -> int:
        """Return how often the sources hold what is replaced: once, if the list is up to date."""
        return (ROOT / SOURCE / self.file).read_text().count(self.old)

    def state(self) -> str:
        """Return a digest of the bug, the C++ and the tests that must see it."""
        digest = hashlib.sha256(f"{self.file}\0{self.old}\0{self.new}\0{self.tests}".encode())
        for path in sorted(one for name in DECIDING for one in (ROOT / name).rglob("*")):
            other = path.match("test_*.py") and path.name not in self.tests
            if path.suffix in (".h", ".cpp", ".cmake", ".txt", ".py") and not other:
                digest.update(str(path.relative_to(ROOT)).encode() + path.read_bytes())
        return digest.hexdigest()[:16]


STEPPING, RANKS = "tests/styles/test_stepping.py", "tests/styles/test_styles.py::test_ranks"
SOURCES, BLOCK = "tests/styles/test_sources.py", "tests/styles/test_block.py"
BLOCK_SHEET = "tests/styles/test_block_sheet.py"
PAIR, CLOTH = "tests/styles/test_pair_sph_tait.py", "tests/styles/test_cloth.py"
CONTACT, WATCH = "tests/styles/test_contact.py", "tests/styles/test_watch.py"
STABILITY = "tests/styles/test_stability.py"
CALIBRATED = "tests/styles/test_calibrated_density.py"
SCALING = "tests/styles/test_mass_scaling.py"
OBSTACLES, SUBSTEPS = "tests/styles/test_obstacles.py", "tests/styles/test_substeps.py"
FIRST_KICK, PORES = "tests/styles/test_first_kick.py", "tests/styles/test_pores.py"
LEE = "tests/styles/test_lee_and_added_mass.py"
FOLDED = "tests/styles/test_folded_sheets.py"
TOGETHER = "tests/styles/test_cloth_with_cloth.py"

BUGS = [
    Bug("sources: layers are not moved by their age", "fix_sph_emit.cpp",
        "center + pattern[k] + age * velocity", "center + pattern[k]", SOURCES),
    Bug("sources: each rank gives IDs of its own", "fix_sph_emit.cpp",
        "first_free_id(lmp, label, wanted, largest_id)", "1 + emitted * (1 + comm->me)",
        f"{SOURCES}::test_pouring_on_two_ranks_and_after_a_restart"),
    Bug("drain: only the last removal is counted", "fix_sph_drain.cpp",
        "taken[k] += all[1 + k]", "taken[k] = all[1 + k]", SOURCES),
    Bug("watch: drained mass counts as lost", "fix_sph_watch.cpp",
        "b.mass += sink->compute_vector(0)", "b.mass -= sink->compute_vector(0)", WATCH),
    Bug("watch: kinetic energy without its half", "fix_sph_watch.cpp",
        "mine[KINETIC] += 0.5 * mass", "mine[KINETIC] += mass", WATCH),
    Bug("cloth: ghosts of a color are outdated", "cloth/substepping.cpp",
        "    vertices.halo.forward_displacements(constraints.channel_of_edge_color(c), "
        "displacement,\n"
        "                                        substep_dt());\n"
        "  } else {",
        "  } else {", RANKS),
    Bug("cloth: the half-kick correction is twice as large", "cloth/half_kick_correction.h",
        "part = 0.5 * (1.0 - 1.0 / substeps)", "part = 1.0 - 1.0 / substeps",
        f"{CLOTH}::test_springs_of_other_fixes_neither_feed_nor_damp"),
    Bug("cloth: only edges that push have a load", "core/pbd/constraint_errors.cpp",
        "return std::fabs(c.lambda[m]) * s.inv_dt_sq", "return c.lambda[m] * s.inv_dt_sq",
        SUBSTEPS),
    Bug("cloth: rigid edges are as stiff as each substep makes them", "core/pbd/cloth_solver.cpp",
        "SINGLE_SWEEP_SOFTNESS * (s.softness - w)", "0.0", CORE),
    Bug("cloth: a load hardens no edge", "core/pbd/solver_softness.h",
        "(1.0 + std::min(harder, MAX_HARDENING))", "(1.0 + 0.0 * harder)", CORE),
    Bug("cloth: a hardened edge pulls back along its secant", "core/pbd/cloth_solver.cpp",
        "a + s.steeper * std::min(a, hardens)", "a", CORE),
    Bug("calibrated density: its slope is left out of the forces", "fluid/fluid_evaluation.cpp",
        "if (adapts) term *= lattices.slope(i, t, rho);", "",
        f"{CALIBRATED}::test_forces_beside_walls_are_the_gradient_of_the_energy"),
    Bug("calibrated wall: half the gradient that a layer lacks", "core/sph/wall_profile.h",
        "2.0 * missing.gradient", "missing.gradient", CORE),
    Bug("mass scaling: fluid of other ranks gets nothing", "fluid/scaled_mass.cpp",
        "  if (any_pairs) ghosts.add_from_ghosts(GhostData::IMPULSE);\n", "", SCALING),
    Bug("mass scaling: constraints move the vertex alone", "fluid/scaled_vertices.cpp",
        "kept = row.mass.scaled(by_constraints);", "kept = by_constraints;",
        f"{SCALING}::test_a_sheet_that_hangs_carries_its_water"),
    Bug("mass scaling: each vertex of a triangle gets all that a mesh carries",
        "fluid/mesh_scaling.cpp", "s.weight[q] * s.stiffness;", "s.stiffness;", SCALING),
    Bug("mass scaling: new masses bring their energy in", "fluid/scaled_mass.cpp",
        "FluidKick::new_part_of(before, now)", "0.0 * before", SCALING),
    Bug("mass scaling: vertices do not feel where the water goes", "core/sph/mass_scaling.h",
        "kept * (change + inverse_mass * carried)", "kept * change", SCALING),
    Bug("steps: a short step arrives at an output time", "core/timestep/step_limits.h",
        "remaining / std::max(1.0, steps)", "std::min(dt, remaining)",
        "tests/styles/test_stability.py::test_output_times_feed_nothing"),
    Bug("cloth: rigid edges take all of their error", "cloth/substepping.h",
        "? sphcloth::STABLE_EDGE_SHARE : 1.0", "? 1.0 : 1.0",
        "tests/styles/test_cloth_energy.py::test_a_crumpled_sheet_without_hinges_comes_to_rest"),
    Bug("cloth: the length of a substep is not in the restart file", "cloth/substepping.h",
        "    length.state = from.length;\n", "",
        f"{SUBSTEPS}::test_a_restart_goes_on_with_the_same_substeps"),
    Bug("cloth: an impact leaves the allowed strain as it was", "core/pbd/substep_length.h",
        "VARIES = 0.95;", "VARIES = 0.0;",
        f"{SUBSTEPS}::test_an_impact_gives_back_no_more_than_it_brought"),
    Bug("stability: a vertex between two sides moves as one beside water",
        "core/sph/stiffness_loops.h",
        "std::sqrt(v.trace() * v.along(s.x, s.y, s.z))", "v.along(s.x, s.y, s.z)", STABILITY),
    Bug("stability: half of what neighbors do to the density", "core/sph/stiffness_loops.h",
        "s.fluid += f_unit * f_unit * squares", "s.fluid += 0.5 * f_unit * f_unit * squares",
        STABILITY),
    Bug("cloth: the reference step has no effect", "cloth/reference_step.cpp",
        "if (given > 0.0)", "if (false)",
        f"{CLOTH}::test_with_a_reference_k_is_a_spring_that_does_not_depend_on_the_step"),
    Bug("cloth: reaction forces of pins have the wrong sign", "fix_pbd_cloth.cpp",
        "Vec3(-holders.force_on_holder(i))", "holders.force_on_holder(i)",
        "tests/styles/test_cloth_held.py"),
    Bug("pair: ghosts without density and pressure", "fluid/fluid_evaluation.cpp",
        "  ghosts.send_to_ghosts(GhostData::DENSITY);\n  if (surface", "  if (surface",
        RANKS),
    Bug("pair: one mass for all of a type", "fluid/fluid_evaluation.cpp",
        "if (mass[t] != mass_or_volume[i]) mass[t] = 0.0;", "",
        f"{PAIR}::test_particles_of_one_type_count_with_masses_of_their_own"),
    Bug("pair: stored energy of a unit mass", "pair_sph_tait.cpp",
        "fluid.mass_or_volume_of(i) *\n        fluid.stored_energy(", "fluid.stored_energy(",
        f"{PAIR}::test_energy_is_what_compression_stored"),
    Bug("step: position before velocity", "stepping/kick_drift.h",
        "      v[i][d] += kick * f[i][d];\n      x[i][d] += dt * v[i][d];",
        "      x[i][d] += dt * v[i][d];\n      v[i][d] += kick * f[i][d];",
        f"{STEPPING}::test_semi_implicit_euler"),
    Bug("step: only the limits of the first rank count", "stepping/step_control.cpp",
        "MPI_Allreduce(&in, &out, 1, MPI_DOUBLE_INT, MPI_MINLOC, world);",
        "out = in; MPI_Bcast(&out, 1, MPI_DOUBLE_INT, 0, world);", RANKS),
    Bug("block: impulses reach twice as far", "stepping/block_state.cpp",
        "static_cast<double>(clock.line.now) + half_step(i);",
        "static_cast<double>(clock.line.now) + 2.0 * half_step(i);", f"{BLOCK} {BLOCK_SHEET}"),
    Bug("block: no particle wakes across ranks", "stepping/block_state.cpp",
        "buf[m++] = mark[i]", "buf[m++] = mark[i] & ~WAKE", f"{BLOCK}::test_ranks"),
    Bug("block: the impulse of a ghost is not sent back", "stepping/block_impulses.cpp",
        "  state.reverse_given();\n", "", f"{BLOCK}::test_ranks"),
    Bug("block: steps of coarse and fine neighbors may differ by the most",
        "stepping/bin_choice.cpp",
        "octaves > 0.0 ? std::clamp(2 - static_cast<int>(octaves), 0, max_difference)",
        "octaves > 0.0 ? max_difference",
        f"{BLOCK}::test_fine_water_is_not_shaken_by_the_steps_of_coarse_water"),
    Bug("block: velocities at output times lag", "stepping/half_kick.cpp",
        "!clock.reaches_output || !clock.line.ended() || clock.uniform) return false;",
        "true) return false;",
        f"{BLOCK}::test_velocities_at_output_times_are_those_of_the_motion"),
    Bug("block: the deferred impulse of a sheet is lost", "stepping/half_kick.cpp",
        "atom->f[i][d] += state.columns.deferred_impulse(d)[i] / step;",
        "atom->f[i][d] += 0.0 * step;",
        f"{BLOCK_SHEET}::test_restart_at_an_output_time"),
    Bug("block: ghosts of ghosts are kicked by outdated impulses", "stepping/block_state.cpp",
        "atom->v[i][d] += kicks[3 * i + d] = *buf++;", "atom->v[i][d] += *buf++;",
        f"{BLOCK}::test_ranks"),
    Bug("block: free flight among neighbors under pressure", "stepping/particle_limits.cpp",
        "fluid->p_over_rho2_beside(i) * ratio * ratio", "0.0 * ratio",
        f"{BLOCK}::test_water_without_pressure_beside_water_under_pressure_does_not_fly_freely"),
    Bug("restart: the time since the last change of the step is lost", "lammps_util/atom_tools.h",
        "update->update_time();", "update->beginstep += 0;",
        f"{SOURCES}::test_time_goes_on_after_a_restart_file_of_the_middle_of_a_run"),
    Bug("restart: impulses on an obstacle are lost", "fix_cloth_contact.cpp",
        "impulses.unpack(i, record + 1);", "impulses.clear(i);",
        OBSTACLES),
    Bug("wall of a mesh: the kernel is completed beyond its border, too", "fluid/mesh_boundary.cpp",
        "closest.share * closest.value.lambda * (1.0 - closest.beyond.lambda)",
        "closest.share * closest.value.lambda", "tests/styles/test_sheet_wall.py"),
    Bug("contact: a hole in every triangle", "core/contact/point_triangle.h",
        "weight.minCoeff() >= -SEAM", "weight.minCoeff() >= 0.05", CORE),
    Bug("contact: a plane is trusted to part what passes it", "core/contact/additive_ccd.h",
        "max_approach_along(vector_at_start / distance, pair) < room",
        "max_approach_along(vector_at_start / distance, pair) < 3.0 * room", CORE),
    Bug("cloth: compliance of the wrong sign", "core/pbd/constraints.h",
        "by * (error + a * lambda)", "by * (error - a * lambda)",
        f"{CLOTH}::test_a_compliant_edge_stretches_by_the_weight"),
    Bug("limits: sound over the whole support", "core/timestep/step_limits.h",
        "ratio(lambda.acoustic * smoothing, s.sound)",
        "ratio(lambda.acoustic * s.support, s.sound)",
        f"{STEPPING}::test_acoustic_limit_uses_the_sound_speed_of_the_density"),
    Bug("pair: artificial viscosity by the density of j alone", "core/sph/force_loops.h",
        "((r_sq + t.soft) * both)", "((r_sq + t.soft) * Real(2) * rho_j)",
        f"{PAIR}::test_forces_against_a_direct_sum"),
    Bug("pair: twice the laminar viscosity", "core/sph/force_loops.h",
        "slope * t.nu * (rho_i", "Real(2) * slope * t.nu * (rho_i",
        f"{PAIR}::test_forces_against_a_direct_sum"),
    Bug("lists: a cell too few is searched", "core/neighbor/cell_lists.h",
        "to[d] = grid.along(d, x + reach)",
        "to[d] = std::max(from[d], grid.along(d, x + reach) - 1)", CORE),
    Bug("lists: inner lists without their skin", "core/neighbor/dual_lists.h",
        "near = limit[types_of_it] + now.skin", "near = limit[types_of_it]", CORE),
    Bug("lists: not rebuilt where particles have approached each other",
        "core/neighbor/dual_lists.h",
        "if (outer_hold) return;", "return;", CORE),
    Bug("lists: particles from a neighboring block are not found", "core/neighbor/blocks.h",
        "if (at > 0) take(of[b], before[b - stride]);", "", CORE),
    Bug("block: neighbors may have any steps where a base step begins",
        "core/neighbor/dual_lists.h",
        "ranges_known && ranges.greatest(block[slot], column) <= limit_of_value", "ranges_known",
        f"{BLOCK} {BLOCK_SHEET}"),
    Bug("block: all neighbors are awake where a base step begins",
        "core/neighbor/dual_lists.h",
        "ranges_known && ranges.smallest(block[slot], column) >= limit_of_value", "ranges_known",
        "tests/styles/test_sleep.py"),
    Bug("block: neighbors get nothing of what a particle gives", "core/sph/force_loops.h",
        "-= gift.scale * rows[k]", "-= 0.0 * rows[k]", BLOCK),
    Bug("sides: a line slips through between two triangles", "core/contact/sheet_layers.h",
        "(ab > -room && bc > -room && ca > -room) || (ab < room && bc < room && ca < room)",
        "(ab > room && bc > room && ca > room) || (ab < -room && bc < -room && ca < -room)", CORE),
    Bug("sides: layers on which particles look from two sides are one",
        "core/contact/sheet_layers.h",
        "return face_one_sheet(i, j) || is_crossed(i, j);", "return true;",
        f"{FOLDED}::test_each_pool_feels_itself_and_no_other_one"),
    Bug("sides: lists that are renewed part other pairs", "core/contact/sheet_layers.h",
        "positions = at_build.data();", "positions = x;",
        f"{FOLDED}::test_each_pool_keeps_its_momentum"),
    Bug("contact: a particle is put out on the other side", "contact/particle_gaps.cpp",
        "side = height_over(start) >= 0.0 ? 1.0 : -1.0",
        "side = height_over(start) >= 0.0 ? -1.0 : 1.0", OBSTACLES),
    Bug("contact: weights of two vertices are exchanged", "core/contact/point_triangle.h",
        "return {1.0 - w2 - w3, w2, w3}", "return {1.0 - w2 - w3, w3, w2}", CORE),
    Bug("contact: a mass is hardly split over its rows", "contact/contact_row.h",
        "shares[row.slots[k]][0] += share *", "shares[row.slots[k]][0] += 0.1 * share *",
        f"{CONTACT} {OBSTACLES}"),
    Bug("contact: pairs of cloth keep their distance while they move",
        "contact/cloth_candidates.h",
        "path_then = reach + both.path + both.in_step", "path_then = reach",
        f"{TOGETHER}::test_what_meets_does_not_depend_on_when_lists_were_made"),
    Bug("contact: particles keep the speed with which they come too near",
        "contact/velocity_rows.cpp", "impulse_for(pushed.change - so_far,",
        "impulse_for(0.0 * so_far,", OBSTACLES),
    Bug("steps: the first kick is whole", "stepping/first_kick.h",
        "state == RECORDED ? 1.0 : 0.5", "1.0", FIRST_KICK),
    Bug("steps: velocities that were set count as half a step old", "stepping/first_kick.h",
        "same ? STAGGERED : GIVEN", "STAGGERED", FIRST_KICK),
    Bug("stability: half of the friction", "core/timestep/step_limits.h",
        "const double half = 0.5 * friction", "const double half = 0.25 * friction", CORE),
    Bug("air: lift points to the other side", "core/air/drag_law.h",
        "n = drag * sine + lift * cosine", "n = drag * sine - lift * cosine", CORE),
    Bug("air: what is inside a triangle's shadow is not in its lee", "core/air/wind_shadow.h",
        "b + c <= 1.0", "b + c >= 1.0", CORE),
    Bug("air: added mass acts along x, whatever the normal", "air/added_mass.cpp",
        "Vec3(root / size * area[s])", "Vec3(root, 0.0, 0.0)", LEE),
    Bug("gas: the exponent counts in the pressure alone", "core/pbd/gas_law.h",
        "return exponent * pressure(gas, volume) / volume", "return pressure(gas, volume) / volume",
        CORE),
    Bug("gas: energy of the gas without what is outside", "core/pbd/gas_law.h",
        "return outside + pressure(gas, volume) * volume",
        "return pressure(gas, volume) * volume", CORE),
    Bug("pores: the net does not slow the flow", "core/pores/pore_law.h",
        "slow = 1.0 + 0.25 * loss", "slow = 1.0 + 0.0 * loss", CORE),
    Bug("pores: the quadratic part counts twice", "core/pores/pore_law.h",
        "sum * sum + 4.0 * quadratic", "sum * sum + 8.0 * quadratic", CORE),
    Bug("pores: the sheet feels half of what the water gets", "pores/pore_rows.cpp",
        "push[pair.vertices[q]] += pair.weight[q] * step;",
        "push[pair.vertices[q]] += 0.5 * pair.weight[q] * step;", PORES),
]  # fmt: skip


class Tree:
    """A copy of the sources, with a package that holds the plugin built of them."""

    def __init__(self, folder: Path) -> None:
        self.sources, self.build, self.core = folder / "tree", folder / "build", folder / "core"
        self.right = folder / "right.so"
        self.sound: set[str] = set()
        for name in COPIED:
            shutil.copytree(
                ROOT / name,
                self.sources / name,
                ignore=_no_rubbish,
                dirs_exist_ok=True,
                copy_function=self._copy_if_changed,
            )
        for name in ("CMakeLists.txt", "pyproject.toml", "README.md", "LICENSE"):
            self._copy_if_changed(ROOT / name, self.sources / name)
        self.environment = os.environ | {
            "PYTHONPATH": str(self.sources / "python"),
            "PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}",
        }
        self.plugin = self.sources / "python" / "sphcloth" / "lib" / "sphclothplugin.so"
        self.plugin.parent.mkdir(exist_ok=True)

    def text_of(self, source: Path) -> bytes:
        """Return what the copy of a file holds."""
        return source.read_bytes()

    def _copy_if_changed(self, source: str | Path, target: str | Path) -> None:
        """Whatever is copied is newer than what was built of it, also where a bug was left in."""
        text = self.text_of(Path(source))
        if not Path(target).exists() or Path(target).read_bytes() != text:
            Path(target).write_bytes(text)

    def prepare(self, bugs: list[Bug]) -> None:
        """Configure and build what the bugs need, without any of them."""
        quick = (*QUICK, f"-DPython_EXECUTABLE={sys.executable}")
        if any(bug.tests == CORE for bug in bugs):
            self._must("cmake", "-S", self.sources / CORE, "-B", self.core, *quick)
            self.make_core()
            self._must(self.core / "test_core_plain")
        if any(bug.tests != CORE for bug in bugs):
            self._must("cmake", "-S", self.sources, "-B", self.build, *quick)
            self.make()
            shutil.copy(self.plugin, self.right)

    def make(self) -> None:
        """Build the plugin and put it into the package."""
        self._must("cmake", "--build", self.build, CORES)
        self._install(self.build / "sphclothplugin.so")

    def make_core(self) -> None:
        """Build the tests of headers."""
        self._must("cmake", "--build", self.core, CORES, "--target", "test_core_plain")

    def _install(self, library: Path) -> None:
        self.plugin.unlink(missing_ok=True)
        shutil.copy(library, self.plugin)

    def _must(self, *command: object) -> None:
        code, out = self._run(*command)
        if code:
            sys.exit(f"{' '.join(map(str, command))} failed:\n{out[-4000:]}")

    def _run(self, *command: object, patience: float | None = None) -> tuple[int, str]:
        """Return exit code and output; a process beyond patience is ended, with all it started."""
        process = subprocess.Popen(
            [str(word) for word in command],
            cwd=self.sources,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        looks = 0
        while True:
            try:
                out, _ = process.communicate(timeout=1)
                return process.returncode, out
            except subprocess.TimeoutExpired:
                looks += 1
                if patience is not None and looks >= patience:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()
                    raise

    def caught(self, bug: Bug) -> str:
        """Put a bug in, run its tests, take it out; return the test that saw it, or nothing."""
        path = self.sources / SOURCE / bug.file
        right = path.read_text()
        path.write_text(right.replace(bug.old, bug.new))
        try:
            return self._core_case() if bug.tests == CORE else self._style_test(bug.tests)
        except subprocess.TimeoutExpired:
            return self._endless(bug.tests)
        finally:
            path.write_text(right)

    def _endless(self, tests: str) -> str:
        """Tests that do not end have seen a bug only if they end without it."""
        if tests == CORE:
            return f"no end within {PATIENCE} s"
        self._install(self.right)
        begin = time.monotonic()
        if self._pytest(*tests.split())[0]:
            sys.exit(f"{tests} fails without any bug")
        return f"no end within {PATIENCE} s, {time.monotonic() - begin:.0f} s without the bug"

    def _core_case(self) -> str:
        """Return the case of ``test_core_plain`` that fails first."""
        self.make_core()
        code, out = self._run(self.core / "test_core_plain", patience=PATIENCE)
        failed = re.search(r"error: in \"(\S+)\"", out)
        return failed[1] if code == TEST_FAILURE and failed else ""

    def _style_test(self, tests: str) -> str:
        """Return the test that fails first, if it passes with the right plugin."""
        self.make()
        code, out = self._pytest(*tests.split())
        failed = [line for line in out.splitlines() if line.startswith(("FAILED", "ERROR"))]
        if code == 0:
            return ""
        if code != 1 or not failed:
            sys.exit(f"{tests} could not be run:\n{out[-4000:]}")
        test = failed[0].split(" ", 1)[1].split(" - ")[0]
        self._install(self.right)
        if test not in self.sound and self._pytest(test)[0]:
            sys.exit(f"{test} fails without any bug")
        self.sound.add(test)
        return test.removeprefix("tests/")

    def _pytest(self, *tests: str) -> tuple[int, str]:
        command = (sys.executable, "-m", "pytest", "-xq", "-p", "no:cacheprovider", *tests)
        return self._run(*command, patience=PATIENCE)


def _no_rubbish(_: str, names: list[str]) -> set[str]:
    return {name for name in names if name in ("__pycache__", "lib") or name.endswith(".png")}


def told(results: list[dict]) -> Table:
    """Return the table of what is known."""
    table = Table("bug", "file", "caught by")
    for one in results:
        table.add_row(one["bug"], one["file"], one["caught"] or "[red]none[/]")
    return table


def recorded(path: Path | None) -> dict[str, dict]:
    """Return the results of earlier runs by the state they are of."""
    if path is None or not path.is_file():
        return {}
    return {one["state"]: one for one in json.loads(path.read_text()) if "state" in one}


def write(path: Path | None, results: list[dict]) -> None:
    """Keep the results at once: a run may be ended at any time."""
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(results, indent=2) + "\n")


def parsed() -> argparse.Namespace:
    """Return the arguments."""
    parser = argparse.ArgumentParser()
    parser.add_argument("names", nargs="*", help="bugs whose name holds one of these; all without")
    parser.add_argument("--folder", type=Path, help="keep copy and build here, for another time")
    parser.add_argument("--json", type=Path, help="write the results here, and go on from them")
    parser.add_argument("--count", type=int, default=len(BUGS), help="run no more bugs than these")
    return parser.parse_args()


def main() -> int:
    """Return 0 if every bug that was chosen is caught, also those left for another run."""
    given = parsed()
    bugs = [b for b in BUGS if not given.names or any(name in b.name for name in given.names)]
    if old := [
        f"{b.name}: {b.places()} times in {b.file}: {b.old!r}" for b in bugs if b.places() != 1
    ]:
        sys.exit("\n".join(old))
    known, states = recorded(given.json), {bug.state(): bug for bug in BUGS}
    chosen = [state for state, bug in states.items() if bug in bugs]
    with tempfile.TemporaryDirectory() as scratch:
        tree = Tree((given.folder or Path(scratch)).absolute())
        new = [state for state in chosen if state not in known][: given.count]
        tree.prepare([states[state] for state in new])
        for state in new:
            known[state] = {**outcome(tree, states[state]), "state": state}
            write(given.json, [known[one] for one in states if one in known])
    results = [known[state] for state in chosen if state in known]
    Console().print(told(results))
    left = len(chosen) - len(results)
    print(f"{left} bugs are left for another run")
    return 0 if all(one["caught"] for one in results) and not left else 1


def outcome(tree: Tree, bug: Bug) -> dict:
    """Run the tests of a bug; tell and return what came out."""
    begin = time.monotonic()
    seen = tree.caught(bug)
    seconds = round(time.monotonic() - begin)
    print(f"{bug.name}: {seen or 'none'} ({seconds} s)", flush=True)
    return {"bug": bug.name, "file": bug.file, "caught": seen, "seconds": seconds}


if __name__ == "__main__":
    sys.exit(main())

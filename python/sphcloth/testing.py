"""pytest plugin: run a scene in a test, and assert on what it did.

Installed with the package, so ``sphcloth_run`` is there in every test:

    from sphcloth.testing import assert_no_crossings

    def test_the_sheet_holds(sphcloth_run):
        run = sphcloth_run("in.drop", ranks=2, spacing=0.05)
        assert_no_crossings(run.cloth, run.trajectory)

pytest imports this module at its start, so nothing heavy may load with it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from sphcloth.log import ThermoTable
    from sphcloth.mesh import ClothMesh
    from sphcloth.trajectory import Frame, Trajectory


@dataclass(frozen=True)
class SceneRun:
    """A finished run of a scene.

    Attributes:
        folder: where it ran; all that it wrote is there.
    """

    folder: Path

    @cached_property
    def thermo(self) -> ThermoTable:
        """The thermo output; the script needs ``thermo_modify line yaml``."""
        from sphcloth.log import ThermoTable

        return ThermoTable.read(self.folder / "log.lammps")

    @cached_property
    def trajectory(self) -> Trajectory:
        """The frames of the one ``*.lammpstrj`` that it wrote, with their times."""
        from sphcloth.trajectory import Trajectory

        return Trajectory(self._only("*.lammpstrj"), self.folder / "log.lammps")

    @cached_property
    def cloth(self) -> ClothMesh:
        """The triangles in the one ``*.data`` that it wrote."""
        from sphcloth.mesh import ClothMesh

        return ClothMesh.read(self._only("*.data"))

    @cached_property
    def masses(self) -> Mapping[int, float]:
        """Atom type -> mass, from the one ``*.data`` that it wrote."""
        from sphcloth.mesh import read_masses

        return read_masses(self._only("*.data"))

    def _only(self, pattern: str) -> Path:
        from sphcloth.errors import UserError

        found = sorted(self.folder.glob(pattern))
        if len(found) != 1:
            names = ", ".join(path.name for path in found) or "none"
            raise UserError(f"one {pattern} is expected in {self.folder}, there is {names}")
        return found[0]


@pytest.fixture
def sphcloth_run(tmp_path: Path) -> Callable[..., SceneRun]:
    """A function that runs an input script in a folder of its own and waits for its end.

    ``sphcloth_run(script, *, ranks=1, timeout=600.0, **variables)``: the script is a path, or its
    text if it has more than one line; variables are those of ``lmp -var``. Files beside the script
    that it names are copied along. A run that fails, or takes more seconds than ``timeout``, fails
    the test with the output of LAMMPS.
    """

    def run(
        script: str | Path, *, ranks: int = 1, timeout: float = 600.0, **variables: object
    ) -> SceneRun:
        __tracebackhide__ = True
        folder = tmp_path / f"run{len(list(tmp_path.glob('run*')))}"
        folder.mkdir()
        failure = _run(_script(script, tmp_path), folder, ranks, timeout, variables)
        if failure:
            pytest.fail(f"{failure}\n  folder: {folder}", pytrace=False)
        return SceneRun(folder)

    return run


def assert_no_crossings(cloth: ClothMesh, frames: Iterable[Frame], fluid_type: int = 1) -> None:
    """Assert that no particle went through the sheet between two frames."""
    __tracebackhide__ = True
    from sphcloth import metrics

    found = metrics.crossings(cloth, frames, fluid_type)
    if found.count:
        first = (
            f"particle {found.ids[0]} before step {found.steps[0]} at {found.points[0].round(6)}"
        )
        raise AssertionError(f"{found.count} particles went through the sheet, the first: {first}")


def assert_momentum_kept(
    frames: Iterable[Frame], mass: float | Mapping[int, float], within: float
) -> None:
    """Assert that the total momentum of all frames is that of the first one.

    Args:
        frames: with velocities.
        mass: of every atom, or by type; a column ``mass`` in the dump goes before both.
        within: largest change over the largest sum of mass times speed.
    """
    __tracebackhide__ = True
    import numpy as np

    from sphcloth import metrics

    totals, scale, steps = [], 0.0, []
    for frame in frames:
        each = metrics.masses_of(frame, mass)
        totals.append(metrics.momentum(frame, each))
        scale = max(scale, float(np.sum(each * np.linalg.norm(frame.velocities, axis=1))))
        steps.append(frame.step)
    if not totals:
        raise AssertionError("there is no frame")
    changes = np.linalg.norm(np.array(totals) - totals[0], axis=1) / (scale or 1.0)
    worst = int(np.argmax(changes))
    if not changes[worst] <= within:
        raise AssertionError(
            f"momentum went from {totals[0]} to {totals[worst]} at step {steps[worst]}: "
            f"a change of {changes[worst]:.3g} of sum m |v| = {scale:.4g}, {within:.3g} allowed"
        )


def assert_density_within(
    frames: Iterable[Frame], rest_density: float, within: float, fluid_type: int = 1
) -> None:
    """Assert that no density in any frame is off by more than a share of the one at rest."""
    __tracebackhide__ = True
    import numpy as np

    from sphcloth import metrics

    off, steps = [], []
    for frame in frames:
        off.append(metrics.density_deviation(frame, rest_density, fluid_type))
        steps.append(frame.step)
    if not off:
        raise AssertionError("there is no frame")
    worst = int(np.argmax(off))  # of what is no number the first
    if not off[worst] <= within:
        raise AssertionError(
            f"a density is off by {off[worst]:.3%} of {rest_density:g} at step {steps[worst]}, "
            f"{within:.3%} allowed"
        )


def assert_close_to_reference(
    values: ArrayLike, exact: ArrayLike, within: float, what: str = "values"
) -> None:
    """Assert that the L2 norm of the difference is at most a share of that of the reference.

    Args:
        values: measured, any shape.
        exact: the reference at the same places and times, same shape.
        within: share.
        what: name of the quantity, for the message.
    """
    __tracebackhide__ = True
    import numpy as np

    values, exact = np.asarray(values, dtype=float), np.asarray(exact, dtype=float)
    if values.shape != exact.shape:
        raise AssertionError(f"{what}: shape {values.shape}, the reference has {exact.shape}")
    if not values.size:
        raise AssertionError(f"{what}: there is no value")
    error = np.linalg.norm(values - exact) / (np.linalg.norm(exact) or 1.0)
    if not error <= within:
        difference = np.nan_to_num(np.abs(values - exact), nan=np.inf)
        worst = np.unravel_index(np.argmax(difference), values.shape)
        place = f" at {tuple(map(int, worst))}" if values.shape else ""
        raise AssertionError(
            f"{what}: relative error {error:.4g}, {within:.4g} allowed; worst{place}: "
            f"{values[worst]:.6g} instead of {exact[worst]:.6g}"
        )


def _script(script: str | Path, folder: Path) -> Path:
    """Return the path of a script; a text of several lines is written to a file first."""
    if isinstance(script, str) and "\n" in script:
        path = folder / "in.scene"
        path.write_text(script, encoding="utf-8")
        return path
    return Path(script)


def _run(
    script: Path, folder: Path, ranks: int, timeout: float, variables: Mapping[str, object]
) -> str | None:
    """Run LAMMPS in a folder; returns why it failed, or None."""
    from sphcloth.run import copy_companions, lammps_command, last_words, wait_for_lammps

    if not script.is_file():
        return f"no script {script}"
    copy_companions(script, folder)
    texts = {name: str(value) for name, value in variables.items()}
    status = wait_for_lammps(lammps_command(script.resolve(), ranks, texts), folder, timeout)
    if status is None:
        return f"{script} is not finished after {timeout:g} s"
    return f"{script} fails: {' '.join(last_words(folder))}" if status else None

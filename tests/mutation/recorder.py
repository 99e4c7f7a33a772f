"""A plugin of pytest: which mutants each test reaches, and how long it takes.

What a fixture for several tests reaches counts for each test that uses it. ``SPHCLOTH_RECORD``
names the file of the results; the tests that it holds are not run again, and none is started after
``SPHCLOTH_RECORD_SECONDS``.
"""

from __future__ import annotations

import json
import mmap
import os
import time
from collections.abc import Iterator
from pathlib import Path

import pytest


class Recorder:
    """Reads and clears the bytes that the plugin of LAMMPS sets, also those of other ranks."""

    def __init__(self) -> None:
        """Open the file that the C++ writes to, and take what is recorded already."""
        self.results = Path(os.environ["SPHCLOTH_RECORD"])
        self.tests: dict[str, dict] = json.loads(self.results.read_text())["tests"]
        self.end = time.monotonic() + float(os.environ["SPHCLOTH_RECORD_SECONDS"])
        self.left = 0
        with open(os.environ["SPHCLOTH_MUTANTS_REACHED"], "r+b") as file:
            self.bytes = mmap.mmap(file.fileno(), 0)
        self.kept: set[int] = set()  # of the test, from before its fixtures
        self.of_fixture: dict[str, tuple[set[int], float]] = {}
        self.made: set[str] = set()  # in the test that runs

    def pytest_collection_modifyitems(
        self, config: pytest.Config, items: list[pytest.Item]
    ) -> None:
        """Leave out what is recorded."""
        known = [item for item in items if item.nodeid in self.tests]
        items[:] = [item for item in items if item.nodeid not in self.tests]
        config.hook.pytest_deselected(items=known)
        self.left = len(items)

    def take(self) -> set[int]:
        """Return what was reached since the last call."""
        found = {k for k, byte in enumerate(self.bytes[:]) if byte}
        self.bytes[:] = bytes(len(self.bytes))
        return found

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator:
        """Record a test."""
        self.take()
        self.kept, self.made = set(), set()
        begin = time.monotonic()
        done = yield
        seconds = time.monotonic() - begin
        shared = _shared_fixtures(item)
        reached = self.kept | self.take()
        for name in shared:
            of_fixture, alone = self.of_fixture.get(name, (set(), 0.0))
            reached |= of_fixture
            seconds += 0.0 if name in self.made else alone
        test = self.tests.setdefault(item.nodeid, {"passed": True})
        test |= {"seconds": round(seconds, 2), "shared": shared, "reached": sorted(reached)}
        self.left -= 1
        self.write()
        if time.monotonic() > self.end:
            item.session.shouldstop = "no time for more"
        return done

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef, request) -> Iterator:
        """Record a fixture that several tests use."""
        if fixturedef.scope == "function":
            return (yield)
        self.kept |= self.take()
        begin = time.monotonic()
        made = yield
        own = self.take()
        name = _name(fixturedef, request.param_index)
        self.of_fixture[name] = own, time.monotonic() - begin
        self.kept |= own
        self.made.add(name)
        return made

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Only tests that pass can tell right from wrong."""
        self.tests.setdefault(report.nodeid, {"passed": True})["passed"] &= (
            report.outcome == "passed"
        )

    def pytest_sessionfinish(self) -> None:
        """Tell that all is recorded, also where nothing was left."""
        self.write()

    def write(self) -> None:
        """Keep what is recorded, since a run may be ended at any time."""
        what = {"complete": self.left == 0, "tests": self.tests}
        self.results.write_text(json.dumps(what, indent=0))


def _shared_fixtures(item: pytest.Item) -> list[str]:
    found = []
    indices = item.callspec.indices if hasattr(item, "callspec") else {}
    for name, definitions in item._fixtureinfo.name2fixturedefs.items():
        last = definitions[-1]
        if last.scope != "function" and last.baseid:
            found.append(_name(last, indices.get(name, 0)))
    return found


def _name(fixture: pytest.FixtureDef, index: int) -> str:
    return f"{fixture.baseid}::{fixture.argname}[{index}]"


def pytest_configure(config: pytest.Config) -> None:
    """Register the recorder."""
    config.pluginmanager.register(Recorder())

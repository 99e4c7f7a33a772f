"""What all tests have in common: ranks that wait sleep, however busy the machine is."""

import os

from sphcloth.programs import YIELDING, shorten_sleep

for name, value in YIELDING.items():
    os.environ.setdefault(name, value)
shorten_sleep()

# the files that take minutes, which begin first: at the end there are short ones for all workers
LONG = (
    "test_examples.py",
    "test_demo.py",
    "test_live_pour.py",
    "test_coupled_cases.py",
    "test_cloth_cases.py",
    "test_layer_cases.py",
    "test_wheel.py",
)


def pytest_collection_modifyitems(items):
    """Sort the tests of long files to the front; others stay in their order."""
    order = {name: n for n, name in enumerate(LONG)}
    items.sort(key=lambda item: order.get(item.path.name, len(LONG)))

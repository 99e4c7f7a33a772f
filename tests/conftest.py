"""What all tests have in common: ranks that wait sleep, however busy the machine is."""

import os

from sphcloth.programs import YIELDING, shorten_sleep

for name, value in YIELDING.items():
    os.environ.setdefault(name, value)
shorten_sleep()

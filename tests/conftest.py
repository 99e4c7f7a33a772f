"""What all tests have in common: ranks that wait sleep, however busy the machine is."""

import os

from sphcloth.programs import YIELDING, end_sleep_on_time

for name, value in YIELDING.items():
    os.environ.setdefault(name, value)
end_sleep_on_time()

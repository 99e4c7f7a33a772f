"""Block steps are chosen before forces are known: what a force that comes suddenly does."""

import numpy as np
import pytest
from harness import instance
from test_block import ROWS

# The base step ends at 48 ms, where all particles are updated; the force begins just before.
SUDDEN = """variable push equal 800*(time>0.0475)
fix push slow addforce v_push 0 0
compute allowed slow sph/atom dt
compute longest slow reduce max c_allowed
thermo_style custom step time dt c_longest
run 47
"""


@pytest.mark.parametrize(("waking", "ends"), [("", 1), ("waking no", 8)])
def test_a_step_that_is_far_too_long_for_a_sudden_force_ends(waking, ends):
    """In the next smallest step, of which there are eight in a base step of 8 ms."""
    with instance() as lmp:
        lmp.commands_string(ROWS.replace("gain 1.8", f"gain 1.8 {waking}") + SUDDEN)
        steps = []
        for _ in range(9):
            lmp.command("run 1 pre no post no")
            ids = lmp.numpy.extract_atom("id")[:10]
            allowed = lmp.numpy.extract_compute("allowed", 1, 1)[:10]
            assert np.ptp(allowed[ids > 4]) == 0.0
            steps.append(allowed[ids > 4][0])
    assert steps[:ends] == [pytest.approx(8e-3)] * ends
    assert max(steps[ends:]) < 2e-3

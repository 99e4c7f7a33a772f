"""fix cloth/contact ... wall yes: what fills the kernel where the sheet ends."""

import numpy as np
import pytest
from harness import by_id, instance
from scenes import cloth_box, cloth_styles, filled, header, lattice, neighbor, sheet, sph_tait

# Water that slides over the border of a rough sheet.  Mirrored in x, it is made by the same
# commands, but for signs.
SLIDING = (
    header("f f f")
    + cloth_box("-0.5 0.5 -0.5 0.5 -0.5 0.5")
    + "mass * 0.125\n"
    + lattice()
    + filled("water", "-0.05 0.2 -0.1 0.1 0.03 0.13")
    + "group water type 1\nset group water sph/rho 1000\n"
    + "velocity water set 1.5 0.1 0 units box\n"
    + sheet(2, 4.0, "0.4 0.4", 0.05)
    + """variable uneven atom 0.002*sin(31*(x+2*y))*cos(53*y)
variable z atom z+v_uneven
set group cloth z v_z
{mirror}
"""
    + sph_tait("1 1 fluid 1000 c0 10 alpha 0.1", "2 2 none", options="tension yes")
    + cloth_styles()
    + neighbor("{skin}")
    + """timestep 0.001
fix step water sph/integrate constant
fix sheet cloth pbd/cloth pin cloth
fix contact water cloth/contact 0.01 {wall}
run 0
"""
)
MIRROR = """variable mx atom -x
variable mu atom -vx
set group all x v_mx vx v_mu"""


def slide(skin=0.06, mirror="", wall="wall yes", steps=20):
    """Return the positions and velocities of the water."""
    with instance() as lmp:
        lmp.commands_string(SLIDING.format(skin=skin, mirror=mirror, wall=wall))
        lmp.command(f"run {steps}")
        water = by_id(lmp, "type") == 1
        return by_id(lmp, "x")[water], by_id(lmp, "v")[water]


def test_water_passes_the_border():
    """Otherwise the others say nothing."""
    x, v = slide()
    start, _ = slide(steps=0)
    beyond = (x[:, 0] > 0.2) & (start[:, 0] < 0.2)
    assert beyond.sum() >= 4
    _, alone = slide(wall="")
    assert np.abs(v - alone).max() > 0.01


@pytest.mark.parametrize("skin", [0.002, 0.02])
def test_what_the_border_leaves_open_does_not_depend_on_list_builds(skin):
    (x, v), (x_other, v_other) = slide(), slide(skin)
    np.testing.assert_allclose(x_other, x, rtol=0, atol=1e-13)
    np.testing.assert_allclose(v_other, v, rtol=0, atol=1e-11)


def test_the_mirror_image_is_the_same():
    (x, v), (x_mirrored, v_mirrored) = slide(), slide(mirror=MIRROR)
    flip = np.array([-1.0, 1.0, 1.0])
    np.testing.assert_allclose(x_mirrored * flip, x, rtol=0, atol=1e-13)
    np.testing.assert_allclose(v_mirrored * flip, v, rtol=0, atol=1e-11)

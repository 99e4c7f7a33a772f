"""Dynamic groups of cloth, contact and pores: right in every step, or refused."""

import numpy as np
import pytest
from harness import by_id, instance
from scenes import cloth_box, cloth_styles, filled, header, lattice, neighbor, sheet, sph_tait

# a block of water that falls on a pinned sheet
SCENE = (
    header("f f f")
    + cloth_box("-1 1 -1 1 -1 1", 3)
    + lattice()
    + filled("block", "-0.2 0.2 -0.2 0.2 0.1 0.4")
    + "mass * 0.1209\ngroup water type 1\nvelocity water set 0 0 -1 units box\n"
    + sheet(2, 2.0, "1.0 1.0", 0.1)
    + sheet(3, 2.0, "1.0 1.0", 0.1, "center 0 0 -0.5 group other")
    + sph_tait("1 1 fluid 1000 c0 20 alpha 0.1", "2*3 2*3 none")
    + cloth_styles()
    + "region low block INF INF INF INF INF {top} units box\n"
    + "timestep 5e-4\nfix step water sph/integrate constant\n"
)
CLOTH = "fix sheet cloth pbd/cloth pin cloth\n"


@pytest.mark.parametrize(
    "fixes",
    [
        "fix contact near cloth/contact 0.01 wall yes\n",
        "fix contact water cloth/contact 0.01\nfix pores near cloth/pores 1 screen 0.3 1e-3\n",
    ],
    ids=["wall", "pores"],
)
def test_water_that_joins_a_group_within_a_run_feels_the_sheet_at_once(fixes):
    """Whenever lists are built."""
    found = []
    for skin in (0.02, 0.15):
        with instance() as lmp:
            lmp.commands_string(
                SCENE.format(top=0.045)
                + neighbor(skin, cutoff=0.5)
                + "group near dynamic water region low every 1\n"
                + f"{CLOTH}run 0\n{fixes}run 250"
            )
            found.append(by_id(lmp, "x"))
    np.testing.assert_allclose(found[1], found[0], atol=1e-12)


@pytest.mark.parametrize(
    ("keyword", "fixes"),
    [
        ("pin", "fix sheet cloth pbd/cloth pin some"),
        ("attach", "fix move some nve\nfix sheet cloth pbd/cloth attach some"),
        ("obstacle", "fix contact water cloth/contact 0.01 obstacle some"),
    ],
)
@pytest.mark.parametrize("later", [False, True])
def test_vertices_that_another_motion_moves_are_the_same_within_a_run(keyword, fixes, later):
    """Also if the group has become dynamic since; a static one may change between runs."""
    all_of = "other" if keyword == "obstacle" else "cloth"
    dynamic = f"group some dynamic {all_of} region low every 1\nrun 0\n"
    with instance() as lmp:
        lmp.commands_string(SCENE.format(top="INF") + neighbor(0.05, cutoff=0.5))
        lmp.commands_string(f"group some union {all_of}" if later else dynamic)
        lmp.commands_string(f"{fixes}\n" + ("run 1\n" if later else ""))
        with pytest.raises(Exception, match=f"{keyword} group some is dynamic.*group some static"):
            lmp.commands_string(f"{dynamic if later else ''}run 1")
        lmp.commands_string("group some static\nrun 1")

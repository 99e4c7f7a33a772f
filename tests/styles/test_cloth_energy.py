"""No solver of cloth gives it energy: stiff hinges, and stiffness in steps that vary."""

import re

import numpy as np
import pytest
from harness import by_id, instance
from scenes import cloth_box, cloth_styles, header

CRUMPLED = (
    header(boundary="f f f", cutoff=0.3)
    + """
region box block -2 2 -2 2 -2 2
create_box 1 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
  extra/angle/per/atom 8 extra/dihedral/per/atom 8
create_cloth 1 2.4 size 0.4 0.4 spacing 0.04 group cloth
displace_atoms cloth random 0.002 0.002 0.002 30 units box
pair_style zero 0.05
pair_coeff * *
"""
)
SHAKEN = """
variable v1 atom random(-0.2,0.2,77)
variable v2 atom random(-0.2,0.2,78)
variable v3 atom random(-0.2,0.2,79)
velocity cloth set v_v1 v_v2 v_v3
velocity cloth zero linear
velocity cloth zero angular
"""


@pytest.mark.parametrize("hinges", [1.0, "compliance 1e-9"])
@pytest.mark.parametrize("edges", [1.0, 0.5])
def test_a_crumpled_sheet_with_stiff_hinges_comes_to_rest(edges, hinges):
    """With hinges that take all of their error the energy grows tenfold in 200 steps."""
    lmp = instance()
    lmp.commands_string(
        CRUMPLED
        + cloth_styles(edges, hinges)
        + SHAKEN
        + """timestep 1e-4
fix sheet cloth pbd/cloth iterations 10
compute motion all ke
run 0
"""
    )
    energies = [lmp.get_thermo("ke"), *(_after(lmp, 150) for _ in range(3))]
    assert energies[1] < 0.05 * energies[0]
    assert energies[3] < energies[2] < energies[1]


def test_a_crumpled_sheet_without_hinges_comes_to_rest():
    """With edges that take all of their error it has more energy than at the start."""
    lmp = instance()
    lmp.commands_string(
        CRUMPLED
        + cloth_styles(1.0, 0)
        + SHAKEN
        + """timestep 1e-3
fix sheet cloth pbd/cloth
compute motion all ke
run 0
"""
    )
    start = lmp.get_thermo("ke")
    assert _after(lmp, 300) < 0.2 * start


def _after(lmp, steps):
    lmp.command(f"run {steps}")
    return lmp.get_thermo("ke")


DROP = (
    header(boundary="f f f")
    + cloth_box("-1.1 1.1 -1.1 1.1 -1.5 1.35")
    + """
mass 1 0.12
lattice sc 0.05
region drop block -0.2 0.2 -0.2 0.2 0.15 0.4 units box
create_atoms 1 region drop
group water type 1
displace_atoms water random 0.0025 0.0025 0.0025 30 units box
region x block -0.376 0.376 INF INF INF INF side out units box
region y block INF INF -0.376 0.376 INF INF side out units box
region held intersect 2 x y
create_cloth 2 2.4 size 0.8 0.8 spacing 0.05 group cloth pin held pins
velocity water set NULL NULL -1.96 units box
pair_style sph/tait 0.1
pair_coeff 1 1 fluid 1000.0 fluctuation 0.01 3.42 alpha 0.0
pair_coeff 2 2 boundary
"""
    + cloth_styles(0.5, 0.3)
    + """
neighbor 0.03 bin
neigh_modify every 1 delay 0 check yes
timestep 0.004
fix gravity all gravity 9.81 vector 0 0 -1
fix step water sph/integrate global mass_scaling no until {until}
run_style sph/adaptive {scheme}
fix sheet cloth pbd/cloth pin pins damping 2.0 iterations 20 {more}
fix contact water cloth/contact 0.005
compute motion all ke
variable energy equal c_motion+9.81*mass(all)*xcm(all,z)
thermo_style custom step dt v_energy
thermo 20
"""
)


def drop(scheme="global", until=0.12, more=""):
    lmp = instance()
    lmp.commands_string(DROP.format(scheme=scheme, until=until, more=more))
    return lmp


def test_a_soft_sheet_gains_no_energy_in_steps_that_vary(tmp_path):
    """With a k that acts in full in each step it has 1.8 times the energy of the start."""
    lmp = drop()
    log = tmp_path / "log"
    lmp.command(f"log {log}")
    lmp.command("thermo 5")
    lmp.command("run 100000")
    lmp.command("log none")
    rows = re.findall(r"^ +(\d+) +(\S+) +(\S+) *$", log.read_text(), re.MULTILINE)
    energy = np.array([float(row[2]) for row in rows])
    steps = np.array([float(row[1]) for row in rows])
    assert steps.max() > 4 * steps.min()
    assert len(energy) > 20
    # the water of the start is a little compressed
    assert energy.max() < 1.05 * energy[0]


@pytest.mark.parametrize("scheme", ["global", "block"])
def test_a_soft_stiffness_is_that_of_the_first_step(scheme, tmp_path):
    """The step is named in a warning, can be given, and is kept in the restart file."""
    plain = drop(scheme)
    log = tmp_path / "log"
    plain.command(f"log {log}")
    plain.command("run 150")
    plain.command("log none")
    step = re.search(r"first step, ([-+.e\d]+); give 'reference'", log.read_text())
    assert step
    plain.command("run 150")

    parts = drop(scheme)
    parts.command("run 150")
    parts.command(f"write_restart {tmp_path}/half")
    script = DROP.format(scheme=scheme, until=0.12, more="")
    kept = script[script.index("pair_style") : script.index("fix contact")]
    again = instance()
    again.commands_string(
        f"read_restart {tmp_path}/half\ncomm_modify vel yes\n"
        + kept
        + "fix contact water cloth/contact 0.005\nrun 150\n"
    )
    assert np.array_equal(by_id(plain, "x"), by_id(again, "x"))

    given = drop(scheme, more=f"reference {step.group(1)}")
    given.command("run 300")
    assert np.allclose(by_id(plain, "x"), by_id(given, "x"), rtol=0, atol=1e-6)
    other = drop(scheme, more=f"reference {10 * float(step.group(1))}")
    other.command("run 300")
    assert not np.allclose(by_id(plain, "x"), by_id(other, "x"), rtol=0, atol=1e-6)


def test_no_warning_without_a_soft_stiffness_or_steps_that_vary(tmp_path):
    for scheme, edges, more in (
        ("constant", 0.5, ""),
        ("global", 1.0, ""),
        ("global", 0.5, "reference 1e-3"),
    ):
        lmp = instance()
        log = tmp_path / "log"
        text = DROP.format(scheme=scheme, until=0.12, more=more)
        text = text.replace("bond_coeff 1 0.5", f"bond_coeff 1 {edges}")
        if edges == 1.0:
            text = text.replace("dihedral_coeff 1 0.3", "dihedral_coeff 1 1.0")
        lmp.commands_string(f"log {log}\n" + text + "timestep 1e-4\nrun 2\nlog none\n")
        assert "first step" not in log.read_text()

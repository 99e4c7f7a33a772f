"""Fixes, pair styles and commands of LAMMPS that contradict the styles: an error or a warning that
names both and the remedy, where results would be wrong, and none where they are right."""

import numpy as np
import pytest
from harness import by_id, instance, run, write
from scenes import FLUID, SMALL_SHEET, box, header, jitter, lattice, neighbor, sph_tait

SHEET = SMALL_SHEET + "fix sheet cloth pbd/cloth\n"
SCHEMES = ("constant", "global", "individual", "block")
UNIFORM = ("constant", "global")


def water(fixes, options="", pair="", scheme="global", speed=0.0):
    """A periodic lattice of water."""
    return (
        header(atoms=FLUID)
        + box("0 0.4 0 0.4 0 0.4")
        + lattice()
        + "create_atoms 1 box\nmass 1 0.125\nset group all sph/rho 1000\n"
        + f"velocity all ramp vx {-speed} {speed} y 0 0.4 units box\n"
        + (pair or sph_tait("1 1 fluid 1000 c0 20 alpha 0.1", options=options))
        + neighbor(0.03)
        + f"timestep 1e-3\nfix step all sph/integrate global\nrun_style sph/adaptive {scheme}\n"
        + "compute rho all sph/atom density\ncompute mean all reduce ave c_rho\n"
        + "thermo_style custom step time dt lx vol c_mean\n"
        + fixes
    )


def error_of(script):
    with instance() as lmp:
        try:
            lmp.commands_string(script)
        except Exception as error:
            return str(error)
    return ""


TILT = "change_box all triclinic\n"


def warnings_of(tmp_path, script):
    said = run(write(tmp_path, script)).splitlines()
    return [line for line in said if line.startswith("WARNING: fix ")]


# steps


@pytest.mark.parametrize("scheme", SCHEMES)
def test_no_other_fix_changes_the_step(scheme):
    message = error_of(water("fix reset all dt/reset 1 NULL 1e-3 0.02\nrun 1", scheme=scheme))
    assert "fix step sph/integrate: fix reset dt/reset would change the steps" in message
    assert "'unfix reset', and use the scheme global, whose longest step is 'max'" in message


def test_it_may_be_defined_before(tmp_path):
    reset = "fix reset all dt/reset 1 NULL 1e-3 0.02\nfix step all"
    message = error_of(water("run 1").replace("fix step all", reset))
    assert "fix reset dt/reset would change the steps" in message


OTHERS = "lj/cut 0.1", "sph/tait 0.1"
COEFFICIENTS = """pair_coeff 1 1 sph/tait fluid 1000 c0 20 alpha 0.1
pair_coeff 1 1 lj/cut 0.02 0.045
"""


def hybrid(order, scheme):
    pair = f"pair_style hybrid/overlay {' '.join(order)}\n{COEFFICIENTS}"
    script = water(jitter(0.005, 17) + "run 30", pair=pair, scheme=scheme, speed=2.0)
    return script.replace("timestep 1e-3", "timestep 2e-4") if scheme == "constant" else script


@pytest.mark.parametrize("order", [OTHERS, OTHERS[::-1]])
def test_block_steps_need_the_pair_style_alone(order):
    message = error_of(hybrid(order, "block"))
    assert (
        "fix step sph/integrate: with run_style sph/adaptive block pair_style hybrid/overlay"
        in message
    )
    assert "use sph/tait alone, or another scheme" in message


@pytest.mark.parametrize("scheme", SCHEMES[:3])
def test_the_order_of_pair_styles_does_not_matter_with_other_schemes(scheme):
    ends = []
    for order in (OTHERS, OTHERS[::-1]):
        with instance() as lmp:
            lmp.commands_string(hybrid(order, scheme))
            ends.append(by_id(lmp, "v"))
    assert np.abs(ends[0]).max() > 1.0
    np.testing.assert_allclose(ends[1], ends[0], rtol=0, atol=1e-10)


VARIABLES = "variable added equal 0.2*time\nvariable rate equal 0.2\n"


def deform(style):
    return f"{TILT}{VARIABLES}fix grow all {style} remap v units box\nrun 0\n"


@pytest.mark.parametrize(
    "style", ["deform 1 x vel 0.2", "deform/pressure 1 x pressure 0 0.1 y vel 0.2"]
)
def test_deform_by_the_number_of_steps_is_a_warning(style, tmp_path):
    (warning,) = warnings_of(tmp_path, water(deform(style)))
    assert f"fix step sph/integrate: fix grow {style.split()[0]} takes all steps" in warning
    assert "but by its style 'variable'" in warning


def test_deform_is_right_with_constant_steps(tmp_path):
    assert not warnings_of(tmp_path, water(deform("deform 1 x vel 0.2"), scheme="constant"))


def test_a_box_that_deforms_by_the_time_has_the_rate_that_is_asked_for():
    """In two runs, the second from another time on; by steps it grows too slowly."""
    rates = {}
    for style in ("vel 0.2", "variable v_added v_rate"):
        with instance() as lmp:
            lmp.commands_string(
                water("run 20", speed=5.0).replace("timestep 1e-3", "timestep 1e-2")
                + "\nvariable begin equal $(time)\nvariable rate equal 0.2\n"
                + "variable added equal 0.2*(time-v_begin)\n"
                + f"fix grow all deform 1 x {style} remap v units box\nrun 30"
            )
            begin = lmp.extract_variable("begin")
            rates[style] = (lmp.get_thermo("lx") - 0.4) / (lmp.get_thermo("time") - begin)
    assert rates["variable v_added v_rate"] == pytest.approx(0.2, rel=1e-10)
    assert abs(rates["vel 0.2"] - 0.2) > 0.005


# density by continuity

BERENDSEN = """compute vir all pressure NULL virial
fix press all press/berendsen iso 1e3 1e3 0.05 modulus 4e5
fix_modify press press vir
"""
REMAPPED = {
    "press/berendsen": BERENDSEN,
    "nph": "fix press all nph iso 0 0 1\n",
    "deform": "fix press all deform 1 x scale 0.9 remap x\n",
}


@pytest.mark.parametrize("scheme", UNIFORM)
@pytest.mark.parametrize("name", REMAPPED)
def test_continuity_does_not_follow_particles_that_move_with_the_box(name, scheme):
    message = error_of(water(REMAPPED[name] + "run 1", "density continuity", scheme=scheme))
    assert f"fix step sph/integrate: fix press {name} moves particles with the box" in message
    assert (
        "use 'density summation' or 'density calibrated', or 'run_style sph/adaptive b" in message
    )
    assert ("remap v" in message) == (name == "deform")


ALLOWED = {
    "barostat and summation": (BERENDSEN, ""),
    "barostat and calibrated": (BERENDSEN, "density calibrated"),
    "remap x and summation": (REMAPPED["deform"], ""),
    "remap v": ("fix grow all deform 1 x scale 0.99 remap v\n", "density continuity"),
    "remap none": ("fix grow all deform 1 x scale 0.99 remap none\n", "density continuity"),
    "shear": (f"{TILT}fix grow all deform 1 xy erate 1 remap x\n", "density continuity"),
    "balance": ("fix even all balance 1 1.0 shift x 5 1.1\n", "density continuity"),
}


@pytest.mark.parametrize("name", ALLOWED)
def test_other_changes_of_the_box_are_allowed(name):
    fixes, options = ALLOWED[name]
    assert not error_of(water(fixes + "run 2", options))


def test_block_steps_follow_positions():
    with instance() as lmp:
        fixes = REMAPPED["deform"].replace("0.9", "0.99") + "run 100\n"
        lmp.commands_string(water(fixes, "density continuity delta 0 tension yes", scheme="block"))
        density = lmp.extract_compute("mean", 0, 0)
    # of the lattice: the sum over kernels misses a part of the change
    assert density == pytest.approx(1000 / 0.99, rel=2e-3)


def test_minimize_and_rerun_have_no_velocities(tmp_path):
    scene = water("", "density continuity", scheme="constant")
    message = error_of(f"{scene}minimize 0 0 1 1")
    assert "pair_style sph/tait: minimize moves particles without velocities" in message
    assert "use 'density summation' or 'density calibrated'" in message
    dump = tmp_path / "now.dump"
    message = error_of(
        f"{scene}run 0\nwrite_dump all custom {dump} id type x y z\nrerun {dump} dump x y z"
    )
    assert "fix step sph/integrate: rerun reads no densities" in message
    assert "use 'density summation' or 'density calibrated'" in message


# cloth

BONDS = {
    "bond/break": "cloth bond/break 1 1 0.2",
    "bond/create": "all bond/create 1 2 2 0.01 1",
    "bond/swap": "cloth bond/swap 50 0.5 1.3 598934",
}


@pytest.mark.parametrize("name", BONDS)
def test_no_other_fix_changes_the_bonds_of_cloth(name):
    message = error_of(f"{SHEET}fix other {BONDS[name]}\nrun 0")
    assert f"fix sheet pbd/cloth: fix other {name} would change bonds of the cloth" in message
    assert "remove it with 'unfix other' or give it a group without vertices" in message


def test_bonds_of_other_atoms_may_change():
    assert not error_of(f"{SHEET}fix other water bond/break 1 1 0.2\nrun 1")


def test_bonds_that_are_deleted_between_runs_are_gone():
    """As the message says: the next run knows them no more."""
    with instance() as lmp:
        lmp.commands_string(SHEET + "run 1")
        before = lmp.extract_global("nbonds")
        lmp.commands_string(
            "group half id 1:25\ndelete_bonds half bond 1 remove\n"
            "delete_bonds half dihedral 1 remove\nrun 1"
        )
        assert lmp.extract_global("nbonds") < before


REFLECTED = "fix mirror water wall/reflect zlo -0.9\n"
CONTACT = "fix contact water cloth/contact 0.005\n"


def test_reflection_behind_contact_is_a_warning(tmp_path):
    sheet = SHEET.replace("boundary p p p", "boundary p p f")
    (warning,) = warnings_of(tmp_path, f"{sheet}{CONTACT}{REFLECTED}run 0")
    assert "fix contact cloth/contact: fix mirror wall/reflect is defined after it" in warning
    assert "define it before" in warning
    assert not warnings_of(tmp_path, f"{sheet}{REFLECTED}{CONTACT}run 0")

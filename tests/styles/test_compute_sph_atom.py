"""compute sph/atom: every column against its definition, and when it has values."""

import math

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from scenes import TWO_FLUIDS, header, neighbor, sph_tait

KEYWORDS = "density pressure energy sound volume neighbors dt active"

STYLES = (
    sph_tait(
        "1 1 fluid 1000 c0 20 alpha 0.5",
        "2 2 fluid 1200 c0 30 gamma 4 nu 0.01 support 0.12",
        "3 3 boundary",
    )
    + "special_bonds lj/coul 1 1 1\n"
    + neighbor(0.03)
    + """timestep 0.001
group fluid type 1 2
group floor type 3
fix step fluid sph/integrate global acoustic 0.5
"""
)


def scene(commands):
    lmp = instance()
    lmp.commands_string(TWO_FLUIDS + STYLES + commands)
    return lmp


def columns(lmp, name="c"):
    """Columns of the compute by keyword, sorted by atom ID."""
    owned = lmp.extract_setting("nlocal")
    order = np.argsort(lmp.numpy.extract_atom("id")[:owned])
    table = np.array(lmp.numpy.extract_compute(name, 1, 2))[:owned]
    return dict(zip(KEYWORDS.split(), table[order].T, strict=True))


def distances(lmp):
    d = by_id(lmp, "x")[:, None] - by_id(lmp, "x")[None]
    d[..., :2] -= 0.3 * np.round(d[..., :2] / 0.3)
    return np.linalg.norm(d, axis=2)


@pytest.fixture(scope="module")
def ran():
    return scene(f"compute c all sph/atom {KEYWORDS}\nrun 5")


def test_state_of_the_fluid(ran):
    c, kind, rho = columns(ran), by_id(ran, "type"), by_id(ran, "rho")
    fluid = kind < 3
    rho0 = np.choose(kind - 1, [1000.0, 1200.0, 1.0])
    k = np.choose(kind - 1, [400.0, 900.0, 0.0])
    gamma = np.choose(kind - 1, [7.0, 4.0, 1.0])
    mass = np.choose(kind - 1, [0.125, 0.15, 0.0])
    p = np.maximum(k * rho0 / gamma * ((rho / rho0) ** gamma - 1), 0)
    assert (p[fluid] == 0).any() and (p[fluid] > 0).any()
    np.testing.assert_array_equal(c["density"], np.where(fluid, rho, 0))
    np.testing.assert_allclose(c["pressure"], np.where(fluid, p, 0), rtol=1e-11, atol=1e-9)
    sound = np.sqrt(k) * (rho / rho0) ** ((gamma - 1) / 2)
    np.testing.assert_allclose(c["sound"], np.where(fluid, sound, 0), rtol=1e-13)
    np.testing.assert_allclose(c["volume"][fluid], mass[fluid] / rho[fluid], rtol=1e-14)


def test_the_energies_add_up_to_the_pair_energy(ran):
    assert columns(ran)["energy"].sum() == pytest.approx(ran.get_thermo("pe"), rel=1e-12)


def test_neighbors_and_volumes_of_the_floor_against_all_distances(ran):
    c, kind, r = columns(ran), by_id(ran, "type"), distances(ran)
    support = np.array(
        [[0, 0, 0, 0], [0, 0.1, 0.11, 0.1], [0, 0.11, 0.12, 0.12], [0, 0.1, 0.12, 0]]
    )
    near = (r < support[kind[:, None], kind[None]]) & (r > 0)
    np.testing.assert_array_equal(c["neighbors"], near.sum(axis=1))
    q = r / 0.1
    kernel = np.where(q < 1, 21 / (2 * math.pi) / 0.1**3 * (1 - q) ** 4 * (1 + 4 * q), 0)
    floor = kind == 3
    volume = 1 / kernel[np.ix_(floor, floor)].sum(axis=1)
    np.testing.assert_allclose(c["volume"][floor], volume, rtol=1e-12)


def test_particles_without_a_role_have_nothing():
    lmp = instance()
    styles = STYLES.replace("3 3 boundary", "3 3 none")
    lmp.commands_string(f"{TWO_FLUIDS}{styles}compute c all sph/atom {KEYWORDS}\nrun 1")
    kind, found = by_id(lmp, "type"), columns(lmp)
    assert (kind == 3).any() and (found["volume"][kind < 3] > 0).all()
    for name, values in found.items():
        assert not values[kind == 3].any(), name


def test_the_smallest_of_the_own_steps_is_the_next_step(ran):
    c, fluid = columns(ran), by_id(ran, "type") < 3
    assert ran.extract_fix("step", 0, 1, 0) in (1, 2, 3, 4, 5)  # a particle sets it
    assert c["dt"][fluid].min() == ran.extract_global("dt")
    assert c["dt"][fluid].min() < c["dt"][fluid].max()
    assert np.all(c["dt"][~fluid] == 0)
    np.testing.assert_array_equal(c["active"], fluid)


def test_with_a_constant_scheme_the_own_step_is_the_constant():
    lmp = scene(
        f"unfix step\nfix step fluid sph/integrate constant\ncompute c all sph/atom {KEYWORDS}\n"
        "run 2"
    )
    assert set(columns(lmp)["dt"]) == {0.0, 0.001}


def test_order_vector_group_and_repetition(ran):
    ran.commands_string("""
        compute one all sph/atom pressure
        compute two fluid sph/atom volume density volume
        run 0""")
    c = columns(ran)
    owned = ran.extract_setting("nlocal")
    order = np.argsort(ran.numpy.extract_atom("id")[:owned])
    one = np.array(ran.numpy.extract_compute("one", 1, 1))[:owned][order]
    two = np.array(ran.numpy.extract_compute("two", 1, 2))[:owned][order]
    np.testing.assert_array_equal(one, c["pressure"])
    volume = np.where(by_id(ran, "type") < 3, c["volume"], 0)
    np.testing.assert_array_equal(two, np.stack([volume, c["density"], volume], axis=1))


def test_what_comes_between_two_runs_changes_nothing(tmp_path):
    """Other commands initialize LAMMPS anew; lists and values outlive that."""
    compute = f"compute c all sph/atom {KEYWORDS}\n"
    whole = scene(compute + "run 10")
    parts = scene(compute + f"run 4\nwrite_data {tmp_path / 'x.data'}")
    assert columns(parts)["neighbors"].max() > 20
    parts.command("run 6 pre no")
    for name, values in columns(whole).items():
        np.testing.assert_array_equal(columns(parts)[name], values, err_msg=name)


@pytest.mark.parametrize("before", ["", "run 3\ncreate_atoms 1 single 0.1 0.1 0.4\n"])
def test_particles_that_were_not_evaluated(before, tmp_path):
    lmp = scene(f"compute c all sph/atom {KEYWORDS}\n" + before)
    lmp.command(f"write_data {tmp_path / 'x.data'}")  # initializes everything, without a step
    with pytest.raises(Exception, match=r"compute c sph/atom: .*not evaluated.*run 0"):
        lmp.numpy.extract_compute("c", 1, 2)
    lmp.command("run 0")
    assert columns(lmp)["density"].max() > 1000


def test_a_scene_without_fluid():
    lmp = scene(
        "delete_atoms group fluid\nunfix step\npair_coeff 1*2 1*2 boundary volume 1\n"
        "pair_coeff 3 3 boundary volume 2e-4\ncompute c all sph/atom neighbors volume\nrun 0"
    )
    table = lmp.numpy.extract_compute("c", 1, 2)[: lmp.extract_setting("nlocal")]
    assert table.tolist() == [[0, 2e-4]] * 36


def test_ranks(tmp_path):
    run(write(tmp_path, TWO_FLUIDS + "write_data start.data", "in.make"))
    script = write(
        tmp_path,
        header("p p f") + f"read_data start.data\n{STYLES}compute c all sph/atom {KEYWORDS}\n"
        "dump d all custom 20 ${out} id c_c[*]\n"
        "dump_modify d sort id format float %.17g\nrun 20\n",
    )
    for ranks in (1, 4):
        run(script, ranks, out=f"{ranks}.txt")
    one, four = (last_frame(tmp_path / f"{ranks}.txt") for ranks in (1, 4))
    np.testing.assert_array_equal(one[:, 6], four[:, 6])
    scale = np.abs(one).max(axis=0)
    np.testing.assert_allclose(four / scale, one / scale, rtol=0, atol=1e-11)


ERRORS = {
    "none": ("compute c all sph/atom", r"compute c sph/atom: keyword is missing"),
    "empty": ('compute c all sph/step ""', r"compute c sph/step: unknown keyword ''"),
    "unknown": ("compute c all sph/atom rho", r"unknown keyword 'rho'.*density, pressure"),
    "no pair": (
        "unfix step\ncompute c all sph/atom density\npair_style zero 0.1\npair_coeff * *\nrun 0",
        r"compute c sph/atom: pair_style zero .*'pair_style sph/tait'",
    ),
    "dt": (
        "unfix step\ncompute c all sph/atom dt\nrun 0",
        r"dt and active.*fix sph/integrate.*add",
    ),
    "side": (
        "compute c all sph/atom side\nrun 0",
        r"compute c sph/atom: sides are known to fix cloth/contact alone: add that fix",
    ),
    "active": ("unfix step\ncompute c all sph/atom active\nrun 0", r"fix sph/integrate"),
    "fix gone": (
        "compute c all sph/atom active\nrun 0\nunfix step\n"
        "write_dump all custom /dev/null id c_c\nrun 1",
        r"fix sph/integrate",
    ),
}


@pytest.mark.parametrize("name", ERRORS)
def test_errors(name):
    commands, message = ERRORS[name]
    with pytest.raises(Exception, match=message):
        scene(commands)

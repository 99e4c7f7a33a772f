"""compute sph/step, pbd/cloth and cloth/contact: each keyword is an element of a fix's vector."""

import ctypes

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from reference_sph import H, lattice
from scenes import DROP, END, FREE_SHEET, MAKE_DROP

LIMITS = "velocity force acoustic viscous density relative wetted cloth max"
OF_STEPS = f"{LIMITS} min growth fluctuation output"
STEP = (
    "dt limit active updates compression clamped {} {} output next/output sleeping updates/ideal "
    "wait/max wait/mean sound sound/work pairs"
)
CLOTH = "force/x force/y force/z strain residual sweeps energy halfkick/x halfkick/y halfkick/z"
CLOTH += " unconverged"
CONTACT = (
    "contacts stops caught overlap impulse/x impulse/y impulse/z force/x force/y force/z cpu "
    "cloth/contacts cloth/stops cloth/caught cloth/gap"
)


def counts(prefix, limits):
    return " ".join(f"{prefix}/{limit}" for limit in limits.split())


PARTICLES = counts("particles", LIMITS)
# style -> ID of the fix, whether it has a scalar, names in the order of its scalar and its vector
NAMES = {
    "sph/step": ("step", True, STEP.format(counts("steps", OF_STEPS), PARTICLES).split()),
    "pbd/cloth": ("sheet", False, CLOTH.split()),
    "cloth/contact": ("contact", False, CONTACT.split()),
}
EXTENSIVE = {
    "sph/step": ["updates", "updates/ideal", "sleeping", "sound/work", "pairs", *PARTICLES.split()],
    "pbd/cloth": [n for n in CLOTH.split() if n not in ("strain", "residual", "sweeps")],
    "cloth/contact": [n for n in CONTACT.split() if n not in ("overlap", "cpu", "cloth/gap")],
}
YAML = "thermo_modify line yaml format float %.17g\n"
COMPUTES = "".join(
    f"compute {fix} all {style} {' '.join(names)}\n" for style, (fix, _, names) in NAMES.items()
)
COLUMNS = " ".join(
    f"c_{fix}[*] {f'f_{fix} ' if scalar else ''}f_{fix}[*]" for fix, scalar, _ in NAMES.values()
)


def thermo_rows(text):
    rows = [line.strip(" -[],").split(", ") for line in text.splitlines() if line[:5] == "  - ["]
    return np.array(rows, dtype=float)


def of_fix(lmp, style, name):
    """The number by its place in the vector of the fix."""
    fix, scalar, names = NAMES[style]
    place = names.index(name) - scalar
    return lmp.extract_fix(fix, 0, 0) if place < 0 else lmp.extract_fix(fix, 0, 1, place)


@pytest.fixture(scope="module")
def free_sheet():
    lmp = instance()
    lmp.commands_string(FREE_SHEET.replace("3 3 boundary", "3 3 none") + "run 60")
    yield lmp
    lmp.close()


# a scene in which most values are not 0, and how many columns at least
BUSY = (
    DROP.replace("pair_coeff 2 2 boundary", "pair_coeff 2 2 none")
    .replace("bond_coeff 1 1.0", "bond_coeff 1 compliance 1e-4")
    .replace("cloth/contact 0.015", "cloth/contact 0.02 friction 0.1 restitution 0.5")
)
SCHEMES = {
    "global": (
        "output 0.02 relative 0.1 acoustic 1 wetted 0.8 cloth 0.1 min 3e-4 below clamp growth 1.5",
        "",
        60,
    ),
    "block": ("output 0.02 velocity 0.06", "run_style sph/adaptive block\n", 50),
}


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_each_keyword_is_an_element_of_the_vector(tmp_path, ranks, scheme):
    run(write(tmp_path, MAKE_DROP, "in.make"))
    words, style, least = SCHEMES[scheme]
    scene = BUSY.replace("global gain 1", f"global gain 1 {words}") + style
    table = f"thermo 1\nthermo_style custom step {COLUMNS}\n" + YAML
    rows = thermo_rows(run(write(tmp_path, scene + COMPUTES + table + END), ranks))[:, 1:]
    assert len(rows) == 101
    assert (rows != 0).any(axis=0).sum() >= least
    first = 0
    for _, _, names in NAMES.values():
        by_name, by_number = np.split(rows[:, first : first + 2 * len(names)], 2, axis=1)
        np.testing.assert_array_equal(by_name, by_number)
        first += 2 * len(names)
    assert first == rows.shape[1]


def test_asking_changes_nothing(tmp_path):
    run(write(tmp_path, MAKE_DROP, "in.make"))
    frames = []
    for number, asked in enumerate(("", f"{COMPUTES}thermo 1\nthermo_style custom {COLUMNS}\n")):
        run(write(tmp_path, DROP + asked + END), dump=f"end.{number}")
        frames.append(last_frame(tmp_path / f"end.{number}"))
    np.testing.assert_array_equal(*frames)


@pytest.mark.parametrize("style", NAMES)
def test_one_keyword_gives_a_scalar_several_a_vector(free_sheet, style):
    lmp = free_sheet
    names = NAMES[style][2]
    singles = [f"one{n}" for n in range(len(names))]
    for single, name in zip(singles, names, strict=True):
        lmp.command(f"compute {single} all {style} {name}")
    lmp.command(f"compute back all {style} {' '.join(reversed(names))}")
    lmp.command("thermo_style custom step " + " ".join(f"c_{s}" for s in singles) + " c_back[*]")
    lmp.command("run 5")
    back = [lmp.extract_compute("back", 0, 1)[n] for n in range(len(names))]
    for single, name, last in zip(singles, names, reversed(back), strict=True):
        value = lmp.extract_compute(single, 0, 0)
        assert value == last == of_fix(lmp, style, name), name
    lmp.command("thermo_style one")
    for compute in [*singles, "back"]:
        lmp.command(f"uncompute {compute}")


@pytest.mark.parametrize("style", NAMES)
def test_extensive_values_are_those_of_more_when_there_is_more(free_sheet, style, tmp_path):
    """Thermodynamic output divides them by the number of atoms on demand, and no others."""
    lmp = free_sheet
    names = [name for name in NAMES[style][2] if name != "cpu"]
    lmp.command(f"compute all all {style} {' '.join(names)}")
    for name in ("updates", "strain", "contacts"):
        if name in names:
            lmp.command(f"compute one all {style} {name}")
            single = name
    lmp.command(f"log {tmp_path / 'log'}")
    lmp.command("thermo_style custom step c_all[*] c_one")
    for norm in ("no", "yes"):
        lmp.command(f"thermo_modify line yaml format float %.17g norm {norm}")
        lmp.command("run 0")
    lmp.command("log none")
    plain, divided = thermo_rows((tmp_path / "log").read_text())[:, 1:]
    factor = [lmp.get_natoms() if n in EXTENSIVE[style] else 1 for n in [*names, single]]
    assert (plain != 0).sum() >= 4
    np.testing.assert_allclose(divided * factor, plain, rtol=1e-15)
    lmp.command("thermo_style one")
    lmp.command("uncompute all")
    lmp.command("uncompute one")


def test_an_asterisk_stands_for_all_names_that_begin_so(free_sheet):
    lmp = free_sheet
    lmp.command("compute steps all sph/step steps/* dt")
    lmp.command("compute pins all pbd/cloth force/*")
    lmp.command("compute all all cloth/contact *")
    lmp.command("thermo_style custom step c_steps[*] c_pins[*] c_all[*]")
    lmp.command("run 3")
    names = [*counts("steps", OF_STEPS).split(), "dt"]
    shown = {"steps": ("sph/step", names), "all": ("cloth/contact", NAMES["cloth/contact"][2])}
    shown["pins"] = ("pbd/cloth", ["force/x", "force/y", "force/z"])
    for compute, (style, those) in shown.items():
        vector = lmp.extract_compute(compute, 0, 1)
        assert [vector[n] for n in range(len(those))] == [of_fix(lmp, style, n) for n in those]
    lmp.command("thermo_style one")
    for compute in shown:
        lmp.command(f"uncompute {compute}")


def test_the_step_for_thermodynamic_output_works_by_name(tmp_path):
    """Output times are known after the variable is asked: a stale number would lose them."""
    run(write(tmp_path, MAKE_DROP, "in.make"))
    scene = DROP.replace("global gain 1", "global gain 1 output 0.002")
    steps = []
    for next_step in ("f_step[29]", "c_next"):
        ask = (
            f"compute next all sph/step next/output\nvariable next equal {next_step}\n"
            "thermo v_next\nthermo_style custom step time v_next\n"
        )
        steps.append(thermo_rows(run(write(tmp_path, scene + ask + YAML + END))))
    np.testing.assert_array_equal(*steps)
    assert len(steps[0]) > 5


SECOND = """
create_cloth 3 5.0 center 0 0 -0.6 size 0.2 0.2 spacing 0.05 group second
fix other second pbd/cloth iterations 5
"""


def test_of_several_fixes_one_is_chosen():
    lmp = instance()
    lmp.commands_string(FREE_SHEET.replace("fix contact", SECOND + "fix contact"))
    for compute, words in (("a", "fix sheet strain"), ("b", "strain fix other"), ("c", "strain")):
        lmp.command(f"compute {compute} all pbd/cloth {words}")
    with pytest.raises(Exception, match=r"compute c pbd/cloth: .*several.*sheet, other"):
        lmp.command("run 0")
    lmp.command("uncompute c")
    lmp.command("thermo_style custom step c_a c_b")
    lmp.command("run 20")
    a, b = (lmp.extract_compute(compute, 0, 0) for compute in "ab")
    assert a == lmp.extract_fix("sheet", 0, 1, 3) > 0
    assert b == lmp.extract_fix("other", 0, 1, 3) != a
    # the one that is left is the only one
    lmp.commands_string("unfix contact\nunfix sheet\nuncompute a\ncompute c all pbd/cloth strain")
    lmp.commands_string("group cloth clear\nthermo_style custom step c_b c_c\nrun 1")
    assert lmp.extract_compute("c", 0, 0) == lmp.extract_compute("b", 0, 0)
    lmp.command("unfix other")
    lmp.command("fix other second pbd/cloth iterations 5")
    lmp.command("run 1")
    lmp.close()


@pytest.mark.parametrize("style", NAMES)
@pytest.mark.parametrize(
    ("words", "error"),
    [
        ("", "keyword is missing"),
        ("nonsense", "unknown keyword 'nonsense': use one of fix, "),
        ("nonsense/*", "unknown keyword"),
        ("{name} nonsense", "unknown keyword 'nonsense'"),
        ("fix", "fix is missing"),
        ("fix {fix}", "keyword is missing"),
        ("{name} fix", "fix is missing"),
    ],
)
def test_wrong_words_are_errors_that_name_them(free_sheet, style, words, error):
    fix, _, names = NAMES[style]
    words = words.format(fix=fix, name=names[0])
    with pytest.raises(Exception, match=rf"(?s)compute x {style}: {error}"):
        free_sheet.command(f"compute x all {style} {words}")


@pytest.mark.parametrize("style", NAMES)
def test_a_fix_that_is_not_there_is_an_error(free_sheet, style, tmp_path):
    fix, _, names = NAMES[style]
    of_fix_style = {"sph/step": "sph/integrate"}.get(style, style)
    lmp = free_sheet
    for other in ("nonsense", "gone"):
        lmp.command(f"compute x all {style} {names[0]} fix {other}")
        remedy = f"give the ID of a fix {of_fix_style}: {fix}"
        with pytest.raises(Exception, match=rf"compute x {style}: fix is '{other}': {remedy}"):
            lmp.command("run 0")
        lmp.command("uncompute x")
    bare = instance()
    bare.commands_string("region b block 0 1 0 1 0 1\ncreate_box 1 b\nmass 1 1")
    bare.command(f"compute x all {style} {names[0]}")
    bare.command(f"write_data {tmp_path}/early.data")  # which initializes, before a run
    with pytest.raises(Exception, match=rf"compute x {style}: there is no fix {of_fix_style}"):
        bare.command("run 0")
    bare.close()


def test_no_cloth_is_near_before_the_first_step():
    lmp = instance()
    gap = "compute gap all cloth/contact cloth/gap\nthermo_style custom step c_gap\nrun 0"
    lmp.commands_string(FREE_SHEET + gap)
    assert lmp.extract_compute("gap", 0, 0) == 0.03
    lmp.close()


def test_clear_takes_the_compute_along():
    lmp = instance()
    ask = "compute x all sph/step updates compression\nthermo_style custom step c_x[*]\n"
    for _ in range(2):
        lmp.commands_string(FREE_SHEET + ask + "run 3")
        vector = ctypes.cast(lmp.extract_compute("x", 0, 1), ctypes.POINTER(ctypes.c_double))
        assert vector[0] == of_fix(lmp, "sph/step", "updates") > 0
        lmp.command("clear")
        assert not lmp.has_id("compute", "x")
    lmp.close()


def test_pairs_are_the_neighbors_that_loops_evaluate():
    """Of each particle and step once for its density and once for its force, and a few behind."""
    lmp = lattice(
        "fix step all sph/integrate constant\ncompute it all sph/step pairs updates\nrun 0"
    )
    x = by_id(lmp, "x")
    d = x[:, None] - x[None]
    d -= 0.4 * np.round(d / 0.4)
    inside = (np.linalg.norm(d, axis=2) < H).sum() - len(x)
    counts = []
    for _ in range(2):
        lmp.command("run 10 post no")
        counts.append(np.array(lmp.numpy.extract_compute("it", 0, 1)))
    (pairs, updates), before = counts[1], counts[0]
    assert updates == 20 * len(x)
    assert 2 * 20 * inside <= pairs < 3 * 22 * inside
    assert pairs - before[0] == pytest.approx(before[0], rel=0.2)


def test_a_variable_that_reads_no_compute_asks_for_no_virial():
    """By loops that would be counted, in each step."""
    pairs = []
    for speed in ("0.1", "v_speed"):
        with instance() as lmp:
            lmp.commands_string(
                "variable speed equal 0.1\n"
                + FREE_SHEET.replace("damping 1.0", f"pin cloth velocity {speed} 0 0")
                + "compute it all sph/step pairs\nthermo 100\nrun 20"
            )
            pairs.append(lmp.extract_compute("it", 0, 0))
    assert pairs[0] == pairs[1] > 0

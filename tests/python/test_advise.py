"""Advice is right where the scene needs it, and silent where it does not."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

from sphcloth.advice.command import Advice, advise
from sphcloth.advice.commands import Commands, Fluid
from sphcloth.advice.evidence import Evidence
from sphcloth.advice.probe import Probe
from sphcloth.advice.unused import unused
from sphcloth.cli import app
from sphcloth.errors import UserError
from sphcloth.fix_values import FIX_OF, LIMITS, NUMBERS, SET_BY, set_by

# a column of water, 12 particles wide and 24 high, collapses in a corner
COLUMN = {
    "sound": "50.0",
    "more": "alpha 0.05",
    "skin": "0.03",
    "dt": "0.01",
    "scheme": "global acoustic 0.8 velocity 0 force 0 viscous 0 density 0",
    "walls": "xlo 0.0 ylo 0.0",
    "extra": "",
    "steps": "300",
}
WATER = """
units           si
dimension       2
atom_style      sph
comm_modify     vel yes
boundary        f f p
region          box block -0.2 8.0 -0.2 3.0 -0.05 0.05
create_box      1 box
mass            1 $(1000.0*0.05^2/1.0079)
lattice         sq 0.05 origin 0.5 0.5 0
region          column block 0.0 0.6 0.0 1.2 INF INF units box
create_atoms    1 region column
group           water type 1
pair_style      sph/tait 0.15
pair_coeff      1 1 fluid 1000.0 c0 {sound} {more}
neighbor        {skin} bin
neigh_modify    every 1 delay 0 check yes
timestep        {dt}
fix             gravity water gravity 9.81 vector 0 -1 0
fix             step water sph/integrate {scheme}
fix             tank water wall/sph {walls}
fix             flat all enforce2d
{extra}
variable        n index {steps}
run             ${{n}}
"""

# water beside a square sheet that swings from one edge
SHEET = {
    "hinges": "0.02",
    "height": "1.0",
    "solver": "iterations 40",
    "contact": "fix contact water cloth/contact 0.005",
    "areal": "4.0",
    "steps": "200",
}
CLOTH = """
units           si
atom_style      hybrid sph molecular
comm_modify     vel yes cutoff 0.4
boundary        f f f
region          box block -1 1 -1 1 -2 3
create_box      2 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
                extra/angle/per/atom 8 extra/dihedral/per/atom 8
mass            1 0.12
lattice         sc 0.05
region          drop block -0.09 0.09 -0.09 0.09 {height} $({height}+0.2) units box
create_atoms    1 region drop
group           water type 1
region          edge block INF -0.39 INF INF INF INF
create_cloth    2 {areal} size 0.8 0.8 spacing 0.1 group cloth pin edge pins
special_bonds   lj/coul 1.0 1.0 1.0
pair_style      sph/tait 0.1
pair_coeff      1 1 fluid 1000.0 c0 60
pair_coeff      2 2 none
bond_style      pbd
bond_coeff      1 1.0
angle_style     zero
angle_coeff     *
dihedral_style  pbd
dihedral_coeff  1 {hinges}
neighbor        0.05 bin
timestep        5e-4
fix             gravity all gravity 9.81 vector 0 0 -1
fix             step water sph/integrate global acoustic 0.8
fix             sheet cloth pbd/cloth pin pins {solver}
{contact}
run             {steps}
"""


def write(folder: Path, text: str, values: dict[str, str], **changes: str) -> Path:
    script = folder / "in.scene"
    script.write_text(text.format(**values | changes))
    return script


def ask(script: Path, steps: int = 2000, **given: float) -> Advice:
    return advise(Probe(script, {}, 1, steps, 600.0), Console(quiet=True), **given)


def water(folder: Path, **changes: str) -> Advice:
    return ask(write(folder, WATER, COLUMN, **changes))


def topics(advice: Advice) -> dict[str, str]:
    """What is advised, topic -> line to type."""
    return {each.topic: each.line for each in [*advice.needs, *advice.unused] if each.line}


def test_what_sets_the_step_is_said_in_words() -> None:
    """By their share; a limit that set one step in a thousand is left out."""
    told = set_by({"velocity": 2, "wetted": 400, "force": 500, "output": 98})
    assert told == "accuracy (force) 50%, stability at the sheet 40%, output 10%"
    assert {*LIMITS, "min", "growth", "fluctuation", "output"} == {*SET_BY}


def test_what_a_fix_says_is_no_command(tmp_path: Path) -> None:
    log = tmp_path / "log.lammps"
    log.write_text(
        "fix touch water cloth/contact 0.01 cloth yes\n"
        "fix touch cloth/contact: ghost cutoff raised from 0.2 to 0.4\n"
    )
    (found,) = Commands.read(log).styled("cloth/contact")
    assert (found.id, found.group, found.value("cloth", "no")) == ("touch", "water", "yes")


def test_a_scene_that_is_set_up_well_gets_no_advice(tmp_path: Path) -> None:
    before = write(tmp_path, WATER, COLUMN)
    text = before.read_text()
    advice = ask(before)
    assert not advice.needs and not advice.unused
    assert advice.run.whole and advice.run.steps == 300
    assert before.read_text() == text and list(tmp_path.iterdir()) == [before]
    facts = {each.topic: each.measured for each in advice.facts}
    assert "set by stability of the water" in facts["time step"]
    assert "c0 = 50" in facts["sound, type 1"]


def test_a_probe_computes_what_the_script_does(tmp_path: Path) -> None:
    """The places at the end, to the last bit, with and without what the probe adds."""
    from sphcloth import Trajectory
    from sphcloth.run import lammps_command, start_lammps

    dump = "write_dump all custom end.dump id type x y z modify sort id format float %.17g"
    script = write(tmp_path, WATER + dump + "\n", COLUMN, steps="60")
    Probe(script, {}, 1, 2000, 600.0).run(tmp_path / "probe")
    assert start_lammps(lammps_command(script, 1, {}), tmp_path).wait(600) == 0
    ends = [Trajectory(folder / "end.dump")[-1] for folder in (tmp_path, tmp_path / "probe")]
    assert (ends[0].positions == ends[1].positions).all()


def test_water_that_is_too_stiff_or_too_soft(tmp_path: Path) -> None:
    stiff = topics(water(tmp_path, sound="300.0", scheme="global", steps="1500"))["sound"]
    assert stiff.startswith("pair_coeff 1 1 fluid 1000.0 c0 ") and stiff.endswith("alpha 0.05")
    better = float(stiff.split()[6])
    assert 20 < better < 200
    soft = topics(water(tmp_path, sound="20.0"))["sound"]
    assert float(soft.split()[6]) > 40


def test_an_expected_speed_counts_beside_the_measured_one(tmp_path: Path) -> None:
    script = write(tmp_path, WATER, COLUMN, steps="20")
    assert "c0 80" in topics(ask(script, speed=8.0))["sound"]


def test_the_acoustic_limit_and_what_a_longer_step_does(tmp_path: Path) -> None:
    scheme = "global acoustic 0.4 velocity 0 force 0 viscous 0 density 0"
    advice = water(tmp_path, scheme=scheme)
    assert topics(advice)["time step"] == "fix step water sph/integrate ... acoustic 0.8"
    step = advice.needs[0]
    assert "acoustic set " in step.measured and "times as long" in step.measured


def test_a_step_that_is_as_long_as_is_stable_has_no_advice(tmp_path: Path) -> None:
    advice = water(tmp_path, scheme="global velocity 0 force 0 density 0")
    assert "time step" not in topics(advice)


def test_a_ceiling_that_sets_the_step(tmp_path: Path) -> None:
    found = topics(water(tmp_path, dt="1e-4", steps="100"))
    assert found["time step"] == "fix step water sph/integrate ... max 0.0002"


@pytest.mark.parametrize("is_quoted", [False, True])
def test_keywords_for_a_fix_without_a_scheme_come_with_one(tmp_path: Path, is_quoted: bool) -> None:
    """The lines are right as they are printed, and so is the command that is tried."""
    text, plain = WATER, "fix             step water sph/integrate {scheme}\n"
    if is_quoted:
        text = WATER.replace(plain, f'if "1 > 0" then "{plain.strip()}" else "print none"\n')
    advice = ask(write(tmp_path, text, COLUMN, scheme="", dt="1e-4", steps="100"))
    found = topics(advice)
    assert found["time step"] == "fix step water sph/integrate global max 0.0002"
    (step,) = [each for each in advice.needs if each.topic == "time step"]
    assert "with max 0.0002 steps are " in step.measured and "fails" not in step.measured
    (limits,) = [line for topic, line in found.items() if topic.startswith("limit")]
    assert limits == "fix step water sph/integrate global velocity 0 force 0 density 0"


@pytest.mark.parametrize("steps", [1, 4, 7])
def test_a_few_steps_are_enough_to_measure(tmp_path: Path, steps: int) -> None:
    """The last of them counts, too."""
    found = ask(write(tmp_path, WATER, COLUMN, scheme="global", dt="1e-4"), steps=steps)
    assert found.run.steps == steps
    assert found.run.time == pytest.approx(steps * 1e-4, rel=1e-12)
    facts = {each.topic: each.measured for each in found.facts}
    assert facts["time step"].startswith("mean 0.0001, ")
    (step,) = [each for each in found.needs if each.topic == "time step"]
    assert "with max 0.0002 steps are 2.00 times as long" in step.measured


def test_the_mean_step_is_that_of_the_steps_taken(tmp_path: Path) -> None:
    """Of a script whose time does not begin at 0."""
    text = WATER.replace("run ", "reset_timestep 7 time 3.0\nrun ")
    found = ask(write(tmp_path, text, COLUMN, scheme="constant", dt="1e-4", steps="13"))
    assert found.run.time == pytest.approx(3 + 13e-4, rel=1e-12)
    assert found.facts[0].measured == "mean 0.0001, constant"


def test_a_constant_step_that_is_short(tmp_path: Path) -> None:
    found = topics(water(tmp_path, scheme="constant", dt="1e-4", steps="50"))
    assert float(found["time step"].split()[1]) == pytest.approx(0.5 * 0.075 / 50, rel=0.02)


def test_a_few_fast_particles_set_the_step_for_all(tmp_path: Path) -> None:
    shot = (
        "create_atoms 1 single 3.0 2.0 0.0 units box\n"
        "region shot block 2.9 3.1 1.9 2.1 INF INF units box\n"
        "group shot region shot\ngroup water union water shot\nvelocity shot set 60.0 0 0 units box"
    )
    scheme = "global acoustic 0.8 force 0 viscous 0 density 0 velocity 0.1"
    advice = water(tmp_path, extra=shot, scheme=scheme, steps="60")
    line = topics(advice).get("time step")
    assert line == "run_style sph/adaptive block", advice.needs
    step = next(each for each in advice.needs if each.topic == "time step")
    assert "tightest for 1 of 289 particles" in step.measured


def test_a_skin_that_is_too_thin(tmp_path: Path) -> None:
    skin = float(topics(water(tmp_path, skin="0.002"))["neighbor lists"].split()[1])
    assert 0.01 < skin <= 0.18


def test_walls_that_nothing_touches(tmp_path: Path) -> None:
    found = topics(water(tmp_path, walls="xlo 0.0 xhi 7.9 ylo 0.0 yhi 2.9"))
    assert found == {"wall xhi, yhi": "fix tank water wall/sph xlo 0.0 ylo 0.0"}
    moving = "xlo 0.0 ylo 0.0 xhi 7.9 yhi 2.9 slip yes velocity ylo 0.2 0 0 pressure mirror"
    found = topics(water(tmp_path, walls=f"{moving} velocity xhi 0 0.1 0", steps="60"))
    left = "xlo 0.0 ylo 0.0 slip yes velocity ylo 0.2 0 0 pressure mirror"
    assert found["wall xhi, yhi"] == f"fix tank water wall/sph {left}"


def test_limits_that_set_no_step(tmp_path: Path) -> None:
    found = topics(water(tmp_path, scheme="global acoustic 0.8 viscous 0"))
    (line,) = found.values()
    assert line.startswith("fix step water sph/integrate global acoustic 0.8 viscous 0 ")
    assert line.endswith("density 0")


def test_limits_that_accuracy_stands_for_are_not_switched_off(tmp_path: Path) -> None:
    """They are errors beside it; those that it leaves alone may go."""
    scheme = "global accuracy 0.02 relative 100"
    found = topics(water(tmp_path, scheme=scheme, dt="1e-4", steps="60"))
    assert found["limit relative"] == "fix step water sph/integrate global accuracy 0.02 relative 0"
    assert not [topic for topic in found if "velocity" in topic or "density" in topic]


def test_viscosity_that_does_nothing(tmp_path: Path) -> None:
    """Water that flies freely has no use for it; water that collapses has."""
    flying = {"walls": "ylo -0.15", "more": "nu 1e-9", "steps": "60"}
    found = topics(water(tmp_path, **flying))
    assert found["viscosity"] == "pair_coeff 1 1 fluid 1000.0 c0 50.0"
    assert "viscosity" not in topics(water(tmp_path, more="alpha 0.3"))


def test_a_sheet_far_from_water_needs_neither_contact_nor_hinges(tmp_path: Path) -> None:
    advice = ask(write(tmp_path, CLOTH, SHEET, hinges="1e-12"))
    found = topics(advice)
    assert found["contact"] == "# fix contact water cloth/contact"
    assert found.get("bending") == "dihedral_style none"
    assert "stretch" not in found


def test_hinges_and_contact_that_act_are_not_talked_away(tmp_path: Path) -> None:
    found = topics(ask(write(tmp_path, CLOTH, SHEET, hinges="0.5", height="0.03")))
    assert not {"contact", "bending"} & set(found)


def test_substeps_for_a_stretch_are_measured(tmp_path: Path) -> None:
    script = write(
        tmp_path, CLOTH, SHEET, solver="iterations 1", hinges="0.0", contact="", steps="100"
    )
    advice = ask(script, stretch=2e-5)
    (stretch,) = [each for each in advice.needs if each.topic == "stretch"]
    assert stretch.line.startswith("fix sheet cloth pbd/cloth ... iterations ")
    more = int(stretch.line.split()[-1])
    changed = write(
        tmp_path, CLOTH, SHEET, solver=f"iterations {more}", hinges="0.0", contact="", steps="100"
    )
    less, was = (each.run.largest("f_sheet[4]") for each in (ask(changed, stretch=1.0), advice))
    assert less < 0.5 * was


def test_a_probe_that_is_cut_says_so(tmp_path: Path) -> None:
    script = write(tmp_path, WATER, COLUMN, walls="xlo 0.0 xhi 7.9 ylo 0.0")
    advice = ask(script, steps=40)
    assert (advice.run.steps, advice.run.whole) == (40, False)
    assert advice.run.time < 0.2


def test_runs_in_loops_branches_and_includes_are_probed(tmp_path: Path) -> None:
    (tmp_path / "more.in").write_text("run 7\n")
    text = WATER.replace(
        "run             ${{n}}",
        "label again\nvariable k loop 3\nrun 10 post no\nnext k\njump SELF again\n"
        'if "1 > 0" then "run 5" else "run 500"\nrun 50 upto\ninclude more.in',
    )
    script = write(tmp_path, text, COLUMN)
    run = Probe(script, {}, 1, 1000, 600.0).run(tmp_path / "all")
    assert (run.steps, run.whole) == (57, True)
    run = Probe(script, {}, 1, 33, 600.0).run(tmp_path / "part")
    assert (run.steps, run.whole) == (33, False)


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("end", ["quit 3", 'if "1 > 0" then "quit 3"'])
def test_a_script_may_end_with_a_status_of_its_own(tmp_path: Path, end: str, ranks: int) -> None:
    script = write(tmp_path, WATER + end + "\n", COLUMN, steps="20")
    run = Probe(script, {}, ranks, 1000, 600.0).run(tmp_path / "probe")
    assert (run.steps, run.whole) == (20, True)


def test_an_error_behind_a_run_is_an_error(tmp_path: Path) -> None:
    script = write(tmp_path, WATER + "no_such_command\nquit 3\n", COLUMN, steps="20")
    with pytest.raises(UserError, match=r"in.scene fails: ERROR: Unknown command: no_such_command"):
        ask(script)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("run             ${{n}}", "", "has no 'run' command"),
        ("c0 {sound}", "c0 fast", "c0 is 'fast'"),
        ("fix             step", "#", "has no 'fix sph/integrate'"),
    ],
)
def test_scripts_that_cannot_be_probed(tmp_path: Path, old: str, new: str, message: str) -> None:
    with pytest.raises(UserError, match=message):
        ask(write(tmp_path, WATER.replace(old, new), COLUMN))


def test_a_scene_without_our_water_is_refused(tmp_path: Path) -> None:
    script = tmp_path / "in.lj"
    script.write_text(
        "lattice fcc 0.8\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\ncreate_atoms 1 box\n"
        "mass 1 1\npair_style lj/cut 2.5\npair_coeff * * 1 1\nfix 1 all nve\nrun 5\n"
    )
    with pytest.raises(UserError, match="no 'pair_style sph/tait' but lj/cut"):
        ask(script)


def test_the_command_line(tmp_path: Path) -> None:
    script, out = write(tmp_path, WATER, COLUMN, walls="xlo 0.0 xhi 7.9 ylo 0.0"), tmp_path / "a"
    arguments = ["advise", str(script), "--set", "n=30", "--json", str(out), "--ranks", "2"]
    shown = CliRunner().invoke(app, arguments)
    assert shown.exit_code == 0, shown.output
    assert "not needed" in shown.output and "wall xhi" in shown.output
    found = json.loads(out.read_text())
    assert found["probe"]["steps"] == 30 and found["probe"]["whole"]
    assert found["unused"][0]["line"] == "fix tank water wall/sph xlo 0.0 ylo 0.0"
    missing = CliRunner().invoke(app, ["advise", str(tmp_path / "none")])
    assert isinstance(missing.exception, UserError) and "no script" in str(missing.exception)


def test_settings_are_called_set_as_in_other_commands(tmp_path: Path) -> None:
    shown = CliRunner().invoke(app, ["advise", "--help"], env={"COLUMNS": "200"}).output
    assert "--set" in shown and "--var" not in shown
    script = write(tmp_path, WATER, COLUMN)
    for option in ("--set", "--var"):
        done = CliRunner().invoke(app, ["advise", str(script), option, "n=5", "--probe-steps", "9"])
        assert "probe of" in done.output and "5 steps" in done.output


def test_a_variable_that_no_script_mentions_is_refused(tmp_path: Path) -> None:
    script = write(tmp_path, WATER, COLUMN)
    probe = Probe(script, {"spacng": "3"}, 1, 2, 600.0)
    with pytest.raises(UserError, match=r"^in.scene has no variable 'spacng'$"):
        advise(probe, Console(quiet=True))
    with pytest.raises(UserError, match=r"^in.scene has no variable 'water'$"):  # but a group
        advise(Probe(script, {"water": "1"}, 1, 2, 600.0), Console(quiet=True))
    scene, more = script.read_text(), tmp_path / "in.more"
    more.write_text("print '${spacng}'\nquit 3\n")
    for include in (f"include {more}\n", f"variable file index {more}\ninclude ${{file}}\n"):
        script.write_text(include + scene)
        with pytest.raises(UserError, match=r"in.scene fails: "):  # by LAMMPS, which has the word
            advise(probe, Console(quiet=True))


@pytest.mark.parametrize(
    ("option", "value"),
    [("--speed", "nan"), ("--speed", "-1"), ("--probe-time", "inf"), ("--stretch", "inf")],
)
def test_numbers_are_finite_and_above_zero(tmp_path: Path, option: str, value: str) -> None:
    done = CliRunner().invoke(app, ["advise", str(write(tmp_path, WATER, COLUMN)), option, value])
    assert isinstance(done.exception, UserError)
    assert str(done.exception) == f"{option} {value}: give a finite number above 0"


@pytest.mark.parametrize(
    "line", ["variable water index 3", "print ${water}", "print $(v_water+1)", "print v_water"]
)
def test_a_variable_is_what_the_script_uses_as_one(tmp_path: Path, line: str) -> None:
    script = write(tmp_path, WATER, COLUMN, steps="2")
    script.write_text(f"{line}\n{script.read_text()}")
    assert Probe(script, {"water": "1"}, 1, 2, 600.0).run(tmp_path / "probe").steps == 2


def test_a_script_may_hold_any_bytes(tmp_path: Path) -> None:
    script = write(tmp_path, WATER, COLUMN, steps="5")
    script.write_bytes(b"# \xe9crit \xe0 la main\n" + script.read_bytes())
    assert ask(script).run.steps == 5


def test_the_command_without_viscosity_repeats_no_word() -> None:
    words = "1 1 fluid 1000 c0 50 alpha 0.1 nu 1e-6 switch 0.2 spacing 0.05"
    assert Fluid.of(words.split(), 0.1).inviscid == "pair_coeff 1 1 fluid 1000 c0 50 spacing 0.05"


def test_a_finished_run_tells_the_same_from_its_log() -> None:
    """The reference log of pour: thermo columns stand for the values of the fixes."""
    log = Path(__file__).parents[2] / "examples/pour/log.22Jul2025.pour.tiny.1"
    run = Evidence.of_log(log)
    meant = {"f_contact[1]": "contacts", "f_step[3]": "updates", "f_sheet[4]": "strain"}
    for value, name in meant.items():
        assert run.last(value) == run.last(f"v_{name}") is not None
    by_limit = {"velocity": 18, "force": 11, "acoustic": 46, "max": 182, "output": 1}
    assert run.commands.steps_by_limit == by_limit
    found = {each.topic: each.line for each in unused(run)}
    assert found == {
        "drain": "# fix drain fluid sph/drain",
        "limit density": "fix step fluid sph/integrate global until 0.5 density 0",
    }


def test_values_that_computes_give_by_keyword_are_known(tmp_path: Path) -> None:
    """Their columns stand for elements of the vectors of the fixes."""
    log = tmp_path / "log.lammps"
    log.write_text(
        "fix s all sph/integrate global\nfix one a pbd/cloth\nfix two b pbd/cloth\n"
        "compute c all sph/step dt particles/max limit\ncompute n all sph/step updates\n"
        "compute strain all pbd/cloth strain fix two\ncompute which all pbd/cloth strain\n"
        "compute all all sph/step *\nvariable limit equal c_c[3]\n---\n"
        "keywords: ['Step', 'Time', 'c_c[1]', 'c_c[2]', 'v_limit', 'c_n', 'c_strain', 'c_which', "
        "'c_all[4]', ]\ndata:\n  - [0, 0, 1, 2, 3, 4, 5, 6, 7, ]\n...\n"
    )
    columns = Evidence.of_log(log).columns
    known = {name: values[-1] for name, values in columns.items() if name.startswith("f_")}
    assert known == {"f_s[27]": 2, "f_s[1]": 3, "f_s[3]": 4, "f_two[4]": 5}


def test_keywords_are_those_of_the_computes() -> None:
    """Their numbers are those of the sources, or of the page where these count on from others."""
    folder = Path(__file__).parents[2] / "src/USER-SPHCLOTH"
    for style, numbers in NUMBERS.items():
        compute = next(name for name, fix in FIX_OF.items() if fix == style)
        text = (folder / f"compute_{compute.replace('/', '_')}.cpp").read_text()
        known = {name: int(n) for name, n in re.findall(r'\{"([\w/]+)", (\d+),', text)}
        for keyword, number in numbers.items():
            if keyword != "pairs" and not keyword.startswith("particles/"):
                assert known[keyword] == number, keyword
    page = (folder.parents[1] / "docs/styles/fix_sph_integrate.md").read_text()
    assert f"| `f_ID[{NUMBERS['sph/integrate']['pairs']}]` | how often the loops of" in page
    for n, limit in enumerate(LIMITS, start=1):
        number = NUMBERS["sph/integrate"][f"particles/{limit}"]
        assert re.search(rf"^\| {n} \| `?{limit}`? \|.*\| `f_ID\[{number}\]` \|$", page, re.M)


def test_settings_are_read_as_lammps_echoes_them(tmp_path: Path) -> None:
    log = tmp_path / "log.lammps"
    log.write_text(
        "pair_style sph/tait ${h}\npair_style sph/tait 0.1\n"
        "pair_coeff 1 1 fluid 1000 fluctuation 0.04 3.0 alpha 0.1 nu 1e-3\n"
        "fix sheet cloth pbd/cloth iterations 5\nfix sheet cloth pbd/cloth iterations 9 # more\n"
    )
    commands = Commands.read(log)
    (fluid,) = commands.fluids.values()
    assert (fluid.sound, fluid.alpha, fluid.nu, fluid.support) == (15.0, 0.1, 1e-3, 0.1)
    assert commands.fixes["sheet"].value("iterations", "10") == "9"

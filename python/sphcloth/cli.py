"""The command ``sphcloth``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from sphcloth.errors import UserError

app = typer.Typer(
    help="SPH water on cloth in LAMMPS.", no_args_is_help=True, pretty_exceptions_enable=False
)

# options that several commands share
JsonFile = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", help="Write the result here too.")
]
Ranks = Annotated[int, typer.Option(min=1, help="Number of MPI ranks.")]

DOCTOR_EXAMPLES = """
Examples:

sphcloth doctor

sphcloth doctor --json doctor.json
"""

RUN_EXAMPLES = """
Examples:

sphcloth run pour --size small --ranks 2

sphcloth run pour --set hold=corners --set scheme=block --out corners

sphcloth run pour --set keep=500 --out pour; sphcloth run pour --set keep=500 --out pour --resume
"""

VALIDATE_EXAMPLES = """
Examples:

sphcloth validate --list

sphcloth validate hydrostatic --quick

sphcloth validate oscillating-drop --set sigma=0.3 --ranks 2 --json drop.json
"""

BENCH_EXAMPLES = """
Examples:

sphcloth bench pair

sphcloth bench cloth --rounds 3 --json cloth.json

sphcloth bench peers --rounds 3 --json peers.json
"""

REPORT_EXAMPLES = """
Examples:

sphcloth report

sphcloth report pour build/validate --out report.html --title "Water on a sheet"
"""

MESH_EXAMPLES = """
Examples:

sphcloth mesh flag.obj --areal-mass 0.2 --pin 'x<0.01' --data flag.data

sphcloth mesh front.obj back.obj --areal-mass 0.2 --scale 0.01 --sew 0.004 --data shirt.data

sphcloth mesh --from-dump run.lammpstrj --data shirt.data --out meshes --format vtk
"""

TRADEOFF_EXAMPLES = """
Examples:

sphcloth tradeoff dam-break --quick

sphcloth tradeoff two-resolutions --scheme constant,global --vary acoustic=0.5,1.0,1.5 --error 0.02

sphcloth tradeoff my.in --vary dt=1e-3,5e-4 --reference dt=1e-5 --quantity KinEng
"""

ADVISE_EXAMPLES = """
Examples:

sphcloth advise in.drop

sphcloth advise in.pour --var hold=corners --ranks 2 --probe-steps 3000 --speed 4
"""

STRESS_EXAMPLES = """
Examples:

sphcloth stress --quick

sphcloth stress impact-3-normal --scheme global,block --ranks 1,2

sphcloth stress --json stress.json
"""

RENDER_EXAMPLES = """
Examples:

sphcloth render pour.lammpstrj --frames 12 --out pictures

sphcloth render pour.lammpstrj --time 0.5:2 --format mp4 --size 1920x1080

sphcloth render pour.lammpstrj --frames 1 --turntable --format gif --size 640x480

sphcloth render run.dump --data run.data --fluid 1,3 --colour-by speed --camera 4,-6,3
"""


@app.callback()
def sphcloth() -> None:
    """Keep the names of the commands, however few there are."""


@app.command(epilog=DOCTOR_EXAMPLES)
def doctor(
    json_file: JsonFile = None,
) -> None:
    """Check that LAMMPS, MPI and the styles work together on this machine."""
    from sphcloth.doctor import examine

    findings = examine()
    findings.show(Console())
    if json_file is not None:
        findings.write(json_file)
    raise typer.Exit(0 if findings.passed else 1)


@app.command(epilog=RUN_EXAMPLES)
def run(
    example: Annotated[str, typer.Argument(metavar="EXAMPLE", help="Name of a packaged example.")],
    size: Annotated[
        str, typer.Option(help="One of the sizes in the example's sizes.toml.")
    ] = "small",
    ranks: Ranks = 1,
    out: Annotated[
        Path | None, typer.Option(help="Output folder.", show_default="sphcloth-EXAMPLE-SIZE")
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Set a variable of the script."),
    ] = None,
    pictures: Annotated[bool, typer.Option(help="Draw pictures afterwards.")] = True,
    frames: Annotated[int, typer.Option(min=1, help="Number of pictures.")] = 12,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume",
            help="Go on from the newest restart file in --out; give the other options again.",
        ),
    ] = False,
    json_file: JsonFile = None,
) -> None:
    """Run an example, draw it and print a summary of what went right or wrong."""
    from sphcloth.examples import parse_settings
    from sphcloth.run import run_example

    code = run_example(
        example,
        size,
        ranks,
        out or Path(f"sphcloth-{example}-{size}"),
        parse_settings(settings or []),
        frames if pictures else None,
        Console(),
        json_file,
        resume,
    )
    raise typer.Exit(code)


@app.command(epilog=VALIDATE_EXAMPLES)
def validate(
    case: Annotated[
        str | None, typer.Argument(metavar="CASE", help="Name of a case; --list shows them.")
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter of the case."),
    ] = None,
    ranks: Ranks = 1,
    quick: Annotated[
        bool, typer.Option("--quick", help="Run the smaller variant with its own limits.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Output folder.", show_default="sphcloth-validate-CASE")
    ] = None,
    json_file: JsonFile = None,
    show_list: Annotated[
        bool, typer.Option("--list", help="Show all cases and their parameters.")
    ] = False,
) -> None:
    """Compare a case with its reference solution; exit code 0 only if all limits are met."""
    from sphcloth.examples import parse_settings
    from sphcloth.validation.validate import find_case, show_cases
    from sphcloth.validation.validate import validate as run_case

    console = Console()
    if show_list:
        show_cases(console)
        return
    if case is None:
        raise UserError("which case? sphcloth validate --list shows them")
    found = find_case(case)
    folder = out or Path(f"sphcloth-validate-{case}")
    result = run_case(found, parse_settings(settings or []), ranks, quick, folder, console)
    if json_file is not None:
        result.write(json_file)
    result.show(found, console)
    raise typer.Exit(0 if result.passed else 1)


@app.command(epilog=MESH_EXAMPLES)
def mesh(
    files: Annotated[
        list[Path] | None,
        typer.Argument(metavar="FILE ...", help="Meshes: OBJ, STL, PLY and what trimesh reads."),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option("--data", help="Data file to write; to read, with --from-dump."),
    ] = None,
    molecule: Annotated[
        Path | None, typer.Option(help="Molecule template to write, for create_atoms ... mol.")
    ] = None,
    groups: Annotated[
        Path | None,
        typer.Option(help="Script of groups to write.", show_default="DATA with .groups"),
    ] = None,
    json_file: JsonFile = None,
    areal_mass: Annotated[
        list[float] | None,
        typer.Option(help="Mass per area; once, or once for each file, as the types below."),
    ] = None,
    per_atom_mass: Annotated[
        bool, typer.Option("--per-atom-mass", help="Write each vertex's own mass.")
    ] = False,
    vertex_type: Annotated[
        list[int] | None, typer.Option(help="Atom type of vertices.", show_default="1")
    ] = None,
    bond_type: Annotated[
        list[int] | None, typer.Option(help="Bond type of edges.", show_default="1")
    ] = None,
    angle_type: Annotated[
        list[int] | None, typer.Option(help="Angle type of triangles.", show_default="1")
    ] = None,
    dihedral_type: Annotated[
        list[int] | None,
        typer.Option(help="Dihedral type of hinges, 0 for none.", show_default="1"),
    ] = None,
    atom_style: Annotated[
        str, typer.Option(help="hybrid sph molecular, or molecular.")
    ] = "hybrid sph molecular",
    scale: Annotated[float, typer.Option(help="Factor on all coordinates.")] = 1.0,
    rotate: Annotated[
        tuple[float, float, float],
        typer.Option(metavar="X Y Z", help="Then degrees about x, then y, then z."),
    ] = (0.0, 0.0, 0.0),
    translate: Annotated[
        tuple[float, float, float], typer.Option(metavar="X Y Z", help="Then a displacement.")
    ] = (0.0, 0.0, 0.0),
    margin: Annotated[
        float | None,
        typer.Option(help="Distance from cloth to box.", show_default="longest edge"),
    ] = None,
    box: Annotated[
        tuple[float, float, float, float, float, float] | None,
        typer.Option(metavar="XLO XHI YLO YHI ZLO ZHI", help="The box, instead of a margin."),
    ] = None,
    merge: Annotated[
        float | None,
        typer.Option(
            help="Vertices of a file closer than this are one.", show_default="1e-7 of its extent"
        ),
    ] = None,
    sew: Annotated[
        float | None,
        typer.Option(metavar="DISTANCE", help="Join borders of different pieces so close."),
    ] = None,
    seam_type: Annotated[
        int | None, typer.Option(help="Sew with bonds of this type instead of welding.")
    ] = None,
    pins: Annotated[
        list[str] | None,
        typer.Option(
            "--pin",
            metavar="SELECTION",
            help="Held vertices: 'z>0.9 and x<0', 'box XLO XHI YLO YHI ZLO ZHI', 'border' or "
            "'ids 1,5-9'; several add up.",
        ),
    ] = None,
    pin_type: Annotated[int | None, typer.Option(help="Atom type of held vertices.")] = None,
    rest: Annotated[
        str, typer.Option(help="Hinges rest as the model is, or flat: model or flat.")
    ] = "model",
    from_dump: Annotated[
        Path | None, typer.Option(metavar="DUMP", help="The other way: meshes from a dump.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for the meshes.")] = None,
    form: Annotated[str, typer.Option("--format", help="obj, ply or vtk.")] = "vtk",
    log: Annotated[Path | None, typer.Option(help="Log of the run, for times in ParaView.")] = None,
    first: Annotated[int, typer.Option(help="First frame, from 0.")] = 0,
    last: Annotated[
        int | None, typer.Option(help="Last frame.", show_default="the dump's last")
    ] = None,
    every: Annotated[int, typer.Option(help="Write every so many frames.")] = 1,
) -> None:
    """Turn triangle meshes into cloth for LAMMPS, or the cloth of a dump into meshes."""
    from sphcloth.meshing import command

    console = Console()
    if from_dump is not None:
        if files:
            raise UserError("--from-dump takes no mesh files")
        command.make_sequence(from_dump, data, out, form, log, (first, last, every), console)
        return
    if not files:
        raise UserError("which mesh? sphcloth mesh FILE, or --from-dump DUMP")
    types = {
        "vertex_type": vertex_type or [1],
        "bond_type": bond_type or [1],
        "angle_type": angle_type or [1],
        "dihedral_type": dihedral_type or [1],
    }
    recipe = command.Recipe(
        materials=command.make_materials(areal_mass, types, len(files)),
        placement=command.Placement(scale, rotate, translate),
        merge=merge,
        sew=sew,
        seam_type=seam_type,
        pins=pins or [],
        pin_type=pin_type,
    )
    output = command.Output(
        data, molecule, groups, json_file, atom_style, margin, box, per_atom_mass, rest
    )
    command.make_cloth(files, recipe, output, console)


@app.command(epilog=RENDER_EXAMPLES)
def render(
    dump: Annotated[Path, typer.Argument(metavar="DUMP", help="Text dump by 'dump custom'.")],
    data: Annotated[
        Path | None,
        typer.Option(
            help="Data file: triangles of the cloth, and which types are water.",
            show_default="DUMP with .data, if there is one",
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder.", show_default="DUMP-pictures")] = None,
    frames: Annotated[
        int | None, typer.Option(min=1, help="Draw so many frames.", show_default="all")
    ] = None,
    every: Annotated[int | None, typer.Option(min=1, help="Draw every so many frames.")] = None,
    time: Annotated[
        str | None, typer.Option(metavar="FROM:TO", help="Draw the frames between two times.")
    ] = None,
    log: Annotated[
        Path | None,
        typer.Option(help="Log with the times.", show_default="log.lammps beside DUMP"),
    ] = None,
    spheres: Annotated[bool, typer.Option("--spheres", help="Draw water as balls.")] = False,
    camera: Annotated[
        str | None, typer.Option(metavar="X,Y,Z", help="Where the camera stands.")
    ] = None,
    target: Annotated[str | None, typer.Option(metavar="X,Y,Z", help="What it looks at.")] = None,
    turntable: Annotated[
        bool, typer.Option("--turntable", help="Walk around the scene once.")
    ] = False,
    size: Annotated[str, typer.Option(metavar="WxH", help="Pixels of a picture.")] = "1280x960",
    form: Annotated[str, typer.Option("--format", help="png, gif or mp4.")] = "png",
    spacing: Annotated[
        float | None,
        typer.Option(help="Of the particles.", show_default="from the data file, or found out"),
    ] = None,
    colour_by: Annotated[
        str, typer.Option(help="speed, pressure, density or none: water's own colour.")
    ] = "none",
    fluid: Annotated[
        str | None,
        typer.Option(metavar="TYPES", help="Types of water.", show_default="from the data file"),
    ] = None,
    cloth: Annotated[
        str | None,
        typer.Option(
            metavar="TYPES",
            help="Types of the vertices of cloth; other triangles are obstacles.",
            show_default="all triangles that ever move",
        ),
    ] = None,
    json_file: JsonFile = None,
) -> None:
    """Draw a dump: water as a surface, cloth, walls; pictures or a film."""
    from sphcloth.rendering import command

    report = command.render(
        dump,
        out or Path(f"{dump.stem}-pictures"),
        data=data,
        log=log,
        frames=command.Frames(frames, every, time),
        choice=command.make_choice(fluid, cloth, spacing, colour_by),
        view=command.View(camera, target, turntable, size, spheres),
        form=form,
        console=Console(),
    )
    if json_file is not None:
        command.write_report(report, json_file)


@app.command(epilog=BENCH_EXAMPLES)
def bench(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            help="What to measure: pair, cloth, coupling, watch, messages, peers, size, activity.",
        ),
    ],
    rounds: Annotated[
        int | None,
        typer.Option(
            min=1, help="How often everything is measured.", show_default="5; 1 for peers"
        ),
    ] = None,
    across: Annotated[
        int | None,
        typer.Option(
            min=8,
            max=400,
            help="Particles along an edge of the water (of the largest for size), vertices along a "
            "side (cloth).",
            show_default="by what is measured, 20 to 160",
        ),
    ] = None,
    steps: Annotated[
        int | None,
        typer.Option(
            min=5,
            help="Length of a timed run; for peers in frames of 0.04 s.",
            show_default="by what is measured, 18 to 400",
        ),
    ] = None,
    json_file: JsonFile = None,
) -> None:
    """Measure speed as ratios, side by side in one run, with the spread."""
    import json

    from sphcloth.bench.activity import bench_activity
    from sphcloth.bench.cloth import bench_cloth
    from sphcloth.bench.coupling import bench_coupling
    from sphcloth.bench.messages import bench_messages
    from sphcloth.bench.pair import bench_pair
    from sphcloth.bench.peers import bench_peers
    from sphcloth.bench.size import bench_size
    from sphcloth.bench.watch import bench_watch

    known = {
        "pair": (bench_pair, 5, 48, 30),
        "cloth": (bench_cloth, 5, 160, 40),
        "coupling": (bench_coupling, 5, 40, 60),
        "watch": (bench_watch, 5, 20, 60),
        "messages": (bench_messages, 3, 24, 20),
        "peers": (bench_peers, 1, 20, 18),
        "size": (bench_size, 5, 100, 30),
        "activity": (bench_activity, 5, 32, 400),
    }
    if name not in known:
        raise UserError(f"no benchmark '{name}': use {', '.join(known)}")
    measure, usual_rounds, usual_across, usual_steps = known[name]
    size = (rounds or usual_rounds, across or usual_across, steps or usual_steps)
    figures = measure(*size, Console())
    if json_file is not None:
        json_file.write_text(json.dumps(figures, indent=2) + "\n")


@app.command(epilog=TRADEOFF_EXAMPLES)
def tradeoff(
    scene: Annotated[
        str | None,
        typer.Argument(metavar="SCENE", help="A packaged scene (--list), or an input script."),
    ] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=A,B,...",
            help="Values to try of a variable of the script, or of a limit of fix sph/integrate; "
            "several make all combinations. In the place of what the scene varies by itself.",
        ),
    ] = None,
    scheme: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,...",
            help="Schemes: constant, global, individual, block.",
            show_default="those that the scene names; a script's own",
        ),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Set a variable in all runs."),
    ] = None,
    over: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=A,B,...",
            help="Run all, the reference too, with each of these values of a variable, and take "
            "means: for scenes where single runs differ by chance. A setting that fails once has "
            "failed.",
        ),
    ] = None,
    reference: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Settings of the run that is taken for exact."),
    ] = None,
    quantity: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME[:NORM]",
            help="A quantity of the scene or a column of the log; norm rms, max or end. The first "
            "one ranks the settings.",
        ),
    ] = None,
    error: Annotated[
        float, typer.Option(min=0.0, help="Relative error within which the cheapest is sought.")
    ] = 0.01,
    quick: Annotated[bool, typer.Option("--quick", help="Run the smaller variant.")] = False,
    ranks: Annotated[int, typer.Option(min=1, help="Number of MPI ranks of a run.")] = 1,
    jobs: Annotated[
        int,
        typer.Option(
            min=0,
            help="Runs side by side, 0 for as many as the cores allow. Wall times are only good "
            "with 1.",
        ),
    ] = 1,
    repeat: Annotated[
        int,
        typer.Option(min=1, help="How often each wall time is measured; the shortest counts."),
    ] = 1,
    last_run: Annotated[
        bool,
        typer.Option("--last-run", help="Of a script of your own, look at the last run alone."),
    ] = False,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Forget the runs that are in the folder.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Output folder.", show_default="sphcloth-tradeoff-SCENE")
    ] = None,
    json_file: JsonFile = None,
    show_list: Annotated[bool, typer.Option("--list", help="Show the packaged scenes.")] = False,
) -> None:
    """Run a scene with many settings: error against particle updates and wall time."""
    from sphcloth.examples import parse_settings
    from sphcloth.tradeoff import command
    from sphcloth.tradeoff.report import show, write_all
    from sphcloth.tradeoff.study import Plan, study

    console = Console()
    if show_list:
        command.show_scenes(console)
        return
    if scene is None:
        raise UserError("which scene? sphcloth tradeoff --list shows them")
    found = command.find_scene(scene, quantity or [], last_run)
    plan = Plan(
        command.find_schemes(found, scheme),
        command.parse_variations(vary or []),
        parse_settings(settings or []),
        parse_settings(reference or [], "--reference"),
        error,
        quick,
        command.parse_variations(over or [], "--over"),
    )
    folder = out or Path(f"sphcloth-tradeoff-{found.name}")
    many = command.number_of_jobs(jobs, ranks)
    effort = {"ranks": ranks, "jobs": many, "repeat": repeat, "fresh": fresh}
    result = study(found, plan, folder, console, **effort)
    files = write_all(result, folder)
    if json_file is not None:
        result.write(json_file)
    show(result, console)
    console.print(*(str(file) for file in files), sep="\n", highlight=False, soft_wrap=True)


@app.command(epilog=ADVISE_EXAMPLES)
def advise(
    script: Annotated[Path, typer.Argument(metavar="IN", help="Input script; it is not changed.")],
    settings: Annotated[
        list[str] | None,
        typer.Option("--var", "--set", metavar="NAME=VALUE", help="Set a variable of the script."),
    ] = None,
    ranks: Ranks = 1,
    steps: Annotated[
        int, typer.Option("--probe-steps", min=1, help="Stop after so many steps.")
    ] = 1000,
    seconds: Annotated[
        float, typer.Option("--probe-time", min=1.0, help="Stop after so many seconds.")
    ] = 60.0,
    speed: Annotated[
        float | None, typer.Option(help="Largest speed that you expect, beside the one measured.")
    ] = None,
    stretch: Annotated[
        float, typer.Option(min=1e-9, help="Largest strain of an edge that you accept.")
    ] = 0.01,
    json_file: JsonFile = None,
) -> None:
    """Run a script for a short time and say what the scene needs, and what it does not."""
    from sphcloth.advice.command import advise as find_advice
    from sphcloth.advice.probe import Probe
    from sphcloth.examples import parse_settings

    probe = Probe(script, parse_settings(settings or [], "--var"), ranks, steps, seconds)
    found = find_advice(probe, Console(), speed=speed, stretch=stretch)
    found.show(Console())
    if json_file is not None:
        found.write(json_file)


@app.command(epilog=REPORT_EXAMPLES)
def report(
    folders: Annotated[
        list[Path] | None,
        typer.Argument(metavar="FOLDER ...", help="Where results are.", show_default="here"),
    ] = None,
    out: Annotated[Path, typer.Option(help="The page.")] = Path("sphcloth-report.html"),
    title: Annotated[str, typer.Option(help="Title of the page.")] = "SPHCLOTH report",
    viewers: Annotated[
        int, typer.Option("--trajectories", min=0, help="Show so many trajectories at most.")
    ] = 2,
) -> None:
    """Write one HTML page of what runs have shown: tables, plots, and scenes to turn."""
    from sphcloth.report.command import report as write_report

    write_report(folders or [Path()], out, title, viewers, Console())


@app.command(epilog=STRESS_EXAMPLES)
def stress(
    case: Annotated[
        str | None,
        typer.Argument(metavar="CASE", help="Name of a case; all without one; --list shows them."),
    ] = None,
    scheme: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,...",
            help="Schemes: constant, global, individual, block.",
            show_default="all that are meaningful",
        ),
    ] = None,
    ranks: Annotated[
        str | None,
        typer.Option(
            metavar="N,M,...", help="Numbers of MPI ranks.", show_default="1,2,4; quick 1,2"
        ),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Run the smaller variants.")] = False,
    out: Annotated[
        Path | None, typer.Option(help="Keep what the runs wrote in this folder.")
    ] = None,
    json_file: JsonFile = None,
    show_list: Annotated[
        bool, typer.Option("--list", help="Show all cases and what must happen.")
    ] = False,
) -> None:
    """Run the extremes; exit code 1 if one of them does not do what it must."""
    from sphcloth.stress import command

    console = Console()
    if show_list:
        command.show_cases(console)
        return
    found = command.stress(case, scheme, ranks, quick, out, json_file, console)
    raise typer.Exit(0 if all(verdict.passed for verdict in found) else 1)


def main() -> None:
    """Run the command line; a mistake of the user's is one line and exit code 2."""
    try:
        app()
    except UserError as error:
        Console(stderr=True).print(f"[bold red]error:[/] {error}", highlight=False)
        sys.exit(2)

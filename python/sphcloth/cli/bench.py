"""``sphcloth bench``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import typer
from rich.console import Console

from sphcloth.cli.options import JsonFile
from sphcloth.errors import UserError

EXAMPLES = """
Examples:

sphcloth bench pair

sphcloth bench cloth --rounds 3 --json cloth.json

sphcloth bench peers --rounds 3 --json peers.json
"""


def _known() -> dict[str, tuple[Callable[..., dict], int, int, int]]:
    """Return name -> function, usual number of rounds, particles across and steps."""
    from sphcloth.bench.activity import bench_activity
    from sphcloth.bench.air import bench_air
    from sphcloth.bench.block import bench_block
    from sphcloth.bench.cloth import bench_cloth
    from sphcloth.bench.coupling import bench_coupling
    from sphcloth.bench.layers import bench_layers
    from sphcloth.bench.messages import bench_messages
    from sphcloth.bench.pair import bench_pair
    from sphcloth.bench.peers import bench_peers
    from sphcloth.bench.size import bench_size
    from sphcloth.bench.watch import bench_watch

    return {
        "pair": (bench_pair, 5, 48, 30),
        "cloth": (bench_cloth, 5, 160, 40),
        "coupling": (bench_coupling, 5, 40, 60),
        "layers": (bench_layers, 5, 50, 200),
        "watch": (bench_watch, 5, 20, 60),
        "messages": (bench_messages, 3, 24, 20),
        "peers": (bench_peers, 1, 20, 18),
        "size": (bench_size, 5, 100, 30),
        "activity": (bench_activity, 5, 32, 400),
        "air": (bench_air, 5, 50, 200),
        "block": (bench_block, 3, 32, 400),
    }


def bench(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            help="What to measure: pair, cloth, coupling, layers, watch, messages, peers, size, "
            "activity, air, block.",
        ),
    ],
    rounds: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="How often everything is measured.",
            show_default="5; 3 for messages and block, 1 for peers",
        ),
    ] = None,
    across: Annotated[
        int | None,
        typer.Option(
            min=8,
            max=400,
            help="Particles along an edge of the water (of the largest for size), vertices along a "
            "side (cloth), edges (layers, air).",
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
    only: Annotated[
        str | None,
        typer.Option(metavar="METRIC", help="Measure this one of the metrics of block alone."),
    ] = None,
    json_file: JsonFile = None,
) -> None:
    """Measure speed as ratios, side by side in one run, with the spread."""
    from sphcloth.programs import endings_interrupt
    from sphcloth.results import write_json

    known = _known()
    if name not in known:
        raise UserError(f"no benchmark '{name}': use {', '.join(known)}")
    if only is not None and name != "block":
        raise UserError(f"--only {only}: only block has metrics to choose from, not {name}")
    measure, usual_rounds, usual_across, usual_steps = known[name]
    size = (rounds or usual_rounds, across or usual_across, steps or usual_steps)
    with endings_interrupt():
        figures = measure(*size, Console(), **({} if only is None else {"only": only}))
    if json_file is not None:
        write_json(json_file, figures)

"""The command `semtopo`: map a drive, ask about a map, write it for other programs.

Bad input of any sort gives exit status 2 and one line on stderr, never a traceback.
"""

from __future__ import annotations

import io
import sys
from collections.abc import Iterable
from importlib.metadata import version
from pathlib import Path
from time import perf_counter
from typing import Annotated, Any

import typer
from pydantic import ValidationError

from semtopo import codec
from semtopo.answers import answer
from semtopo.documents import SensorDocument
from semtopo.errors import InvalidOptionError, SemtopoError
from semtopo.exports import EXPORTS, RADIUS_MAX, Format
from semtopo.formats.fault import describe_fault
from semtopo.journey import WayOptions
from semtopo.sensor import Sensor
from semtopo.types import Edges, Identity, MappingOptions, Passages, Sensing
from service import console
from service.folder import read_chart, read_folder
from service.mapping_run import (
    Drive,
    Extras,
    TimedStep,
    recorded_drive,
    simulated_drive,
    timed_steps,
    write_map,
)
from service.painting import Form

BAD_INPUT = 2
INTERRUPTED = 130  # 128 + SIGINT, as shells have it


app = typer.Typer(
    help="Semantic and topological maps for robots: zones, a graph and routes.",
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.add_typer(console.app)


def main() -> None:
    """Run the command, and turn every error that has a cause outside into one line."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # a label may be in any script
    try:
        status = app(standalone_mode=False)
        sys.stdout.flush()  # so that a full disk is met here
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(INTERRUPTED)
    except (SemtopoError, ValidationError, OSError, typer.TyperException) as error:
        typer.echo(f"semtopo: {_one_line(error)}", err=True)
        sys.exit(BAD_INPUT)
    sys.exit(status)


def _one_line(error: Exception) -> str:
    """Return what went wrong, in one line."""
    if isinstance(error, ValidationError):
        text = describe_fault(error)
    elif isinstance(error, typer.TyperException):
        text = error.format_message()
    elif isinstance(error, OSError) and error.filename is not None:
        text = f"{error.filename}: {error.strerror}"
    else:
        text = str(error)
    return " ".join(text.split())


def _print_version(wanted: bool) -> None:  # noqa: FBT001 -- typer calls it with the flag
    if wanted:
        typer.echo(f"semtopo {version('semtopo')}")
        raise typer.Exit


@app.callback()
def _semtopo(
    *,
    show_version: Annotated[
        bool, typer.Option("--version", callback=_print_version, help="Print the version.")
    ] = False,
) -> None:
    """Semantic and topological maps for robots: zones, a graph and routes."""


PathArgument = Annotated[Path | None, typer.Argument(help="CSV x,y[,theta].", show_default=False)]
PassagesOption = Annotated[Passages, typer.Option(help="Between two zones: the first, or all.")]
IdentityOption = Annotated[
    Identity, typer.Option(help="What is one zone: a label, or each place of it.")
]
FramesOption = Annotated[Form | None, typer.Option(help="A picture for each change of the graph.")]
SensingOption = Annotated[Sensing, typer.Option(help="At samples, or where beams cross walls.")]


@app.command("map")
def map_drive(  # noqa: PLR0913 -- one parameter for each option
    *,
    world: Annotated[Path | None, typer.Argument(help="World: JSON.", show_default=False)] = None,
    path: PathArgument = None,
    out: Annotated[Path, typer.Option(help="Folder to write to.")],
    scans: Annotated[Path | None, typer.Option(help="Recording: JSON lines, or gzip.")] = None,
    beams: Annotated[int | None, typer.Option(show_default="72")] = None,
    sensor_range: Annotated[
        float | None, typer.Option("--range", help="In m.", show_default="2")
    ] = None,
    samples: Annotated[int | None, typer.Option(help="On each beam.", show_default="20")] = None,
    edges: Annotated[Edges, typer.Option(help="Which zones are linked.")] = Edges.SEEN,
    passages: PassagesOption = Passages.FIRST,
    identity: IdentityOption = Identity.LABEL,
    sensing: SensingOption = Sensing.SAMPLED,
    min_zone_area: Annotated[float, typer.Option(help="In m^2.")] = 0.0,
    tolerance: Annotated[float, typer.Option(help="Of borders, in m.")] = 0.0,
    frames: FramesOption = None,
    animation: Annotated[Path | None, typer.Option(help="A .gif or .webp to write.")] = None,
) -> None:
    """Map a simulated drive through WORLD along PATH, or a real one recorded in --scans."""
    started = perf_counter()
    extras = Extras(frames, animation)
    options = MappingOptions(
        edges=edges,
        passages=passages,
        identity=identity,
        sensing=sensing,
        min_zone_area=min_zone_area,
        tolerance=tolerance,
    )
    given = {"beams": beams, "range": sensor_range, "samples": samples}
    drive = _drive(world, path, scans, given, sensing)
    steps = _with_progress(timed_steps(drive.looks, options), drive.count)
    state = write_map(steps, drive.count, out, extras)
    seconds = perf_counter() - started
    typer.echo(
        f"{state.seq} steps, {len(state.graph.nodes)} zones, {len(state.graph.passages)} passages"
        f" in {seconds:.1f} s"
    )


def _drive(
    world: Path | None,
    path: Path | None,
    scans: Path | None,
    sensor: dict[str, float | None],
    sensing: Sensing,
) -> Drive:
    """Return the drive that the arguments speak of."""
    given = {name: value for name, value in sensor.items() if value is not None}
    if scans is not None:
        if world is not None or given:
            raise InvalidOptionError("--scans takes no WORLD, no PATH and no simulated sensor")
        return recorded_drive(scans)
    if world is None or path is None:
        raise InvalidOptionError("expected WORLD and PATH, or --scans")
    return simulated_drive(world, path, _sensor(given), sensing)


def _sensor(given: dict[str, Any]) -> Sensor:
    return SensorDocument(**given).value()


def _with_progress(steps: Iterable[TimedStep], count: int) -> Iterable[TimedStep]:
    """Return the steps; on a terminal, show how far they are."""
    if not sys.stderr.isatty():
        return steps
    from rich.console import Console  # noqa: PLC0415
    from rich.progress import track  # noqa: PLC0415

    return track(steps, "mapping", total=count, console=Console(stderr=True), transient=True)


@app.command()
def route(
    directory: Annotated[Path, typer.Argument(help="A folder that `semtopo map` wrote.")],
    question: Annotated[str, typer.Argument(help='Like "path from corridor to C".')],
    *,
    json: Annotated[bool, typer.Option("--json", help="Answer as JSON.")] = False,
    radius: Annotated[
        float | None, typer.Option(help="Of the robot, in m: ways with a path for it.")
    ] = None,
    two_way: Annotated[
        bool, typer.Option("--two-way", help="Use passages against their direction too.")
    ] = False,
) -> None:
    """Answer a question about a map: the way, what lies where, what changed."""
    folder = read_folder(directory)
    found = answer(folder.atlas, question, folder.history, WayOptions(radius, two_way))
    typer.echo(codec.to_json(codec.answer_document(found)).decode() if json else found.sentence)


@app.command()
def export(
    directory: Annotated[Path, typer.Argument(help="A folder that `semtopo map` wrote.")],
    form: Annotated[Format, typer.Argument(metavar="FORMAT", help=", ".join(Format))],
    file: Annotated[Path | None, typer.Argument(help="To write to; standard output else.")] = None,
    *,
    radius: Annotated[
        float, typer.Option(help="Of the robot, in m; for nav2.", min=0, max=RADIUS_MAX)
    ] = 0.0,
) -> None:
    """Write a map for another program."""
    content = EXPORTS[form].write(read_chart(directory, radius))
    if file is None:
        typer.echo(content, nl=False)
    else:
        file.write_bytes(content)

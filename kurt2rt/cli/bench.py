"""`kurt2rt bench`."""

import tempfile
from pathlib import Path
from typing import Annotated

import anyio
import typer
from rich.console import Console
from rich.progress import Progress

from hal.kurt2_settings import load_kurt2
from kurt2rt.checks.bench.report import as_json, measure_machine, print_report
from kurt2rt.checks.bench.robot_under_test import SEED, BenchFixture, OnProgress
from kurt2rt.checks.bench.suite import FULL, QUICK, BenchName, Lengths, SuiteOutcome, run_suite
from kurt2rt.cli.json_output import AsJson, JsonFile, require_json_file
from kurt2rt.cli.options import task_option
from kurt2rt.cli.tables import console_of
from kurt2rt.core.task_settings import TaskSettings, load_task

_ALL = ",".join(BenchName)

_Quick = Annotated[bool, typer.Option("--quick", help="Measure less, in under a minute; rare lateness may hide.")]
_Only = Annotated[
    str, typer.Option(metavar="NAME,...", help=f"Measure only these: {', '.join(BenchName)}.", show_default=False)
]
_Folder = Annotated[
    Path, typer.Option(exists=True, file_okay=False, writable=True, help="A folder on the disk to measure.")
]


def bench(
    file: JsonFile = None,
    quick: _Quick = False,
    only: _Only = _ALL,
    json: AsJson = False,
    folder: _Folder = Path(),
    task: Annotated[str, task_option("Default: wall_following.")] = "wall_following",
) -> None:
    """Measure what the runtime takes, on this machine, with the simulated robot: 7 minutes.

    lateness  how late ticks begin in a minute of driving; with asyncio.sleep
    tick      what each stage of these ticks takes
    program   what share of a core the robot's program takes in real time, with
              its simulated robot in a process of its own; with an empty loop
    match     how long the nearest RLA is sought; with a brute force
    loop      how many times real time a lesson in lockstep runs on one core
    lesson    how long a teacher waits until a lesson is durable; with fsync
    channel   over UDP: from a press to the wheels, also on the teacher's page;
              what it costs the loop that a teacher is there; lessons until
              answered
    batch     exams of many robots at once, and lessons, in compiled loops (extra
              fast); with the CAN bus

    The ratio says how many times longer the reference took in the same run.
    The goals are meant for an idle machine; a benchmark informs, and ends with
    code 0 whether they are met or not. If one fails, the others are told.

    For example:

        kurt2rt bench --quick
        kurt2rt bench --only match,lesson --json
        kurt2rt bench --only batch --task streets
    """
    benches = _chosen(only)
    require_json_file(file, as_json=json)
    machine = measure_machine()
    results, errors = _measure(benches, folder, QUICK if quick else FULL, load_task(task))
    if json and file is None:
        typer.echo(as_json(results, machine))
    else:
        print_report(results, machine, console_of())
    if file is not None:
        file.write_text(as_json(results, machine) + "\n", encoding="utf-8")
    if errors:
        raise ExceptionGroup("benchmarks failed", errors)


def _measure(benches: frozenset[BenchName], folder: Path, lengths: Lengths, task: TaskSettings) -> SuiteOutcome:
    # Late imports: the simulator and the recorder are extras that a robot does not need.
    if benches & {BenchName.PROGRAM, BenchName.RECORDING}:
        import kurt2rt.runs.recording.recorder  # noqa: F401 # told before the measurements, not after minutes
    from simbridge.simulation import Kurt2SimulationFactory

    settings = load_kurt2()
    factory = Kurt2SimulationFactory(settings)
    fixture = BenchFixture(
        settings, task, lambda purpose: factory.open(task.teaching.world, SEED, purpose), batches=factory
    )
    # No automatic refresh: it would run in the middle of a measurement.
    with (
        Progress(console=Console(stderr=True), auto_refresh=False) as progress,
        tempfile.TemporaryDirectory(prefix=".kurt2rt-bench-", dir=folder) as scratch,
    ):

        def start_job(what: str) -> OnProgress:
            task_id = progress.add_task(what, total=1.0)
            progress.refresh()
            return lambda share: progress.update(task_id, completed=share, refresh=True)

        return anyio.run(run_suite, benches, fixture, Path(scratch), lengths, start_job)


def _chosen(names: str) -> frozenset[BenchName]:
    chosen = {name.strip() for name in names.split(",")}
    unknown = sorted(chosen - set(BenchName))
    if unknown:
        raise typer.BadParameter(
            f"there is no {', '.join(unknown)}; give some of {', '.join(BenchName)}", param_hint="--only"
        )
    return frozenset(map(BenchName, chosen))

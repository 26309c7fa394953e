"""`kurt2rt faults`."""

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Annotated, get_args

import anyio
import typer
from rich.console import Console
from rich.progress import Progress

from hal.errors import ExitCode
from hal.kurt2_settings import load_kurt2
from kurt2rt.checks.faults.table import KINDS, TARGETS, FaultCase, FaultTable, Kind, Target, cases_of, load_faults
from kurt2rt.cli.json_output import AsJson, JsonFile, require_json_file
from kurt2rt.cli.tables import console_of
from kurt2rt.core.task_settings import load_task

if TYPE_CHECKING:
    from kurt2rt.checks.faults.suite import FaultTrial


_TargetNames = Annotated[
    list[str] | None,
    typer.Option(help=f"Try only what fails here; repeat for several: {', '.join(TARGETS)}.", show_default=False),
]
_KindNames = Annotated[
    list[str] | None,
    typer.Option(help=f"Try only what fails so; repeat for several: {', '.join(KINDS)}.", show_default=False),
]
_Seeds = Annotated[
    int,
    typer.Option(
        metavar="N", min=1, help="Try each case with so many seeds: noise, and the moment in a cycle when it fails."
    ),
]
_Table = Annotated[str, typer.Option(help="What must come of what, by name (config/faults) or a path.")]


def faults(
    file: JsonFile = None,
    target: _TargetNames = None,
    kind: _KindNames = None,
    seeds: _Seeds = 1,
    json: AsJson = False,
    table: _Table = "kurt2",
) -> None:
    """Break everything that can break, on the simulated robot, and see that it stands: 10 seconds.

    Twelve parts fail in seven ways each, in simulated time: the robot drives,
    something fails for two seconds and is well again. The table says what must
    come of it, within which time, and what lets the robot drive on. Whatever
    fails, no frame leaves the envelope: speed, slew, a rest before a change of
    direction, no command older than 20 ms, brakes while the robot is to stay
    stopped. An observer at the robot's end of the bus sees to that, who shares
    no code with the guard.

    Ends with code 1 when a case is not as the table says. Known gaps are said.

    For example:

        kurt2rt faults
        kurt2rt faults --target tick --kind stuck --seeds 5
    """
    # Late imports: the simulator is an extra that a robot does not need.
    from kurt2rt.checks.faults.report import as_json, print_report
    from kurt2rt.checks.faults.stop_times import stop_times

    require_json_file(file, as_json=json)
    chosen = load_faults(table)
    trials = _try(chosen, list(cases_of(chosen, _targets(target), _kinds(kind))), seeds)
    times = stop_times(chosen, trials)
    if json and file is None:
        typer.echo(as_json(trials, times))
    else:
        print_report(trials, times, console_of())
    if file is not None:
        file.write_text(as_json(trials, times) + "\n", encoding="utf-8")
    if not all(trial.verdict.passed for trial in trials):
        raise typer.Exit(ExitCode.FAILED)


def _try(table: FaultTable, cases: Sequence[FaultCase], seeds: int) -> "list[FaultTrial]":
    from kurt2rt.checks.faults.suite import try_cases
    from simbridge.faults.fault_rig import FaultRigFactory

    settings, task = load_kurt2(table.robot), load_task(table.task)
    with Progress(console=Console(stderr=True)) as progress:
        bar = progress.add_task("faults", total=len(cases) * seeds)

        def on_done(trial: "FaultTrial") -> None:
            progress.update(bar, advance=1, description=str(trial.case))

        rigs = FaultRigFactory(settings)
        run = partial(try_cases, seeds=range(1, seeds + 1), on_done=on_done)
        return anyio.run(run, rigs, cases, table, settings, task)


def _targets(names: list[str] | None) -> tuple[Target, ...]:
    _require_known(names, get_args(Target), "--target")
    return tuple(each for each in TARGETS if not names or each in names)


def _kinds(names: list[str] | None) -> tuple[Kind, ...]:
    _require_known(names, get_args(Kind), "--kind")
    return tuple(each for each in KINDS if not names or each in names)


def _require_known(names: list[str] | None, known: tuple[str, ...], option: str) -> None:
    unknown = sorted(set(names or ()) - set(known))
    if unknown:
        raise typer.BadParameter(
            f"there is no {', '.join(unknown)}; give some of {', '.join(known)}", param_hint=option
        )

"""`kurt2rt replay`."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from config.errors import ExitCode
from kurt2rt.cli.json_output import AsJson, plain, print_json
from kurt2rt.cli.knowledge.shared import change_lines
from kurt2rt.cli.options import RecordedRun, RunsFolder, SettingsName
from kurt2rt.cli.progress import job_bars
from kurt2rt.cli.tables import say
from kurt2rt.runs.recording.run_folder import find_run
from kurt2rt.runs.replay.counterfactual import counterfactual
from kurt2rt.runs.replay.counterfactual_policy import load_policy
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.run import Run, progress_reporter
from kurt2rt.runs.replay.trial import format_answer
from kurt2rt.runs.replay.verify import ReplayVerdict, verify
from kurt2rt.service.settings import load_service

_DIFFERENCES = 10


def replay(
    run: RecordedRun = None,
    compare: Annotated[
        Path | None,
        typer.Option(
            metavar="KNOWLEDGE",
            help="Compare with this knowledge file: tell where it would have decided otherwise.",
        ),
    ] = None,
    runs: RunsFolder = None,
    as_json: AsJson = False,
    settings: SettingsName = "default",
) -> None:
    """Replay a recorded run, and compare it bit for bit.

    Sensor readings, commands and settings of the run go through the same tick
    again; nothing moves, and no knowledge file is touched. Ends with 1 and tells
    the first difference, if there is one.

    With --compare other knowledge decides on the very same situations, without
    acting: what would an undo, or another afternoon of teaching, have changed?

        kurt2rt replay
        kurt2rt replay 20261122T031005Z-wall_following --compare other.knowledge
    """
    found = read_run(find_run(run, runs or Path(load_service(settings).recordings)))
    if compare is None:
        _verify(found, as_json=as_json)
    else:
        _compare(found, compare, as_json=as_json)


def _verify(run: Run, *, as_json: bool) -> None:
    with job_bars() as report:
        verdict = verify(run, progress_reporter(run, report))
    if as_json:
        told = {"run": run.name, "task": run.head.task, "recorded_by": run.head.kurt2rt, "same": verdict.same}
        differences = [
            {**each._asdict(), "recorded": repr(each.recorded), "replayed": repr(each.replayed)}
            for each in verdict.differences
        ]
        print_json({**told, **plain(replace(verdict, differences=())), "differences": differences})
    else:
        for line in _verdict_in_words(run, verdict):
            say(line)
    if not verdict.same or not verdict.whole:
        raise typer.Exit(ExitCode.FAILED)


def _verdict_in_words(run: Run, verdict: ReplayVerdict) -> Iterator[str]:
    yield _title(run)
    if verdict.same:
        yield (
            f"the same: {verdict.ticks} ticks ({verdict.lasted_s:.1f} s) were decided again as they were, and what is "
            f"known had the same hash {verdict.knowledge} times"
        )
    else:
        first = verdict.differences[0]
        yield (
            f"not the same: {verdict.ticks} ticks ({verdict.lasted_s:.1f} s) were decided again as they were; in the "
            f"next one, tick {first.tick},"
        )
        for each in verdict.differences[:_DIFFERENCES]:
            yield f"  {each.text}"
        if len(verdict.differences) > _DIFFERENCES:
            yield f"  and {len(verdict.differences) - _DIFFERENCES} more"
    if verdict.trouble:
        yield verdict.trouble


def _compare(run: Run, knowledge: Path, *, as_json: bool) -> None:
    policy = load_policy(run, knowledge)
    with job_bars() as report:
        found = counterfactual(run, policy, on_entry=progress_reporter(run, report))
    if as_json:
        stretches = [
            {**each._asdict(), "was": format_answer(each.was), "would_be": format_answer(each.would_be)}
            for each in found.stretches
        ]
        told = {"run": run.name, "knowledge": knowledge, "same": found.same}
        print_json({**told, **plain(replace(found, stretches=())), "stretches": stretches})
        return
    say(f"{_title(run)}; with {knowledge}:")
    for line in change_lines(Path(run.name).name, found):
        say(line)
    if found.trouble:
        say(found.trouble)


def _title(run: Run) -> str:
    head = run.head
    return f"{run.name}: task {head.task}, robot {head.robot} on {head.bus}, recorded by kurt2rt {head.kurt2rt}"

"""`kurt2rt replay`."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from config.errors import ExitCode
from kurt2rt.cli.json_output import AsJson, plain, print_json
from kurt2rt.cli.options import RecordedRun, RunsFolder, SettingsName
from kurt2rt.cli.progress import job_bars
from kurt2rt.cli.tables import console_of
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.platform.text_table import TextTable, print_whole
from kurt2rt.runs.recording.run_folder import find_run
from kurt2rt.runs.replay.counterfactual import Counterfactual, DifferingStretch, counterfactual
from kurt2rt.runs.replay.counterfactual_policy import PolicyAnswer, load_policy
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import ReplayedTick
from kurt2rt.runs.replay.run import Run
from kurt2rt.runs.replay.verify import ReplayVerdict, verify
from kurt2rt.service.settings import load_service

_TELL_EVERY_TICKS = 100
_DIFFERENCES = 10

OnTick = Callable[[ReplayedTick], None]


def replay(
    run: RecordedRun = None,
    compare: Annotated[
        Path | None,
        typer.Option(
            metavar="KNOWLEDGE",
            help="Compare with this knowledge file: list where it would have decided otherwise.",
        ),
    ] = None,
    runs: RunsFolder = None,
    limit: Annotated[
        int, typer.Option(metavar="N", min=1, help="With --compare: number of differences to list, longest first.")
    ] = 30,
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
        _compare(found, compare, limit, as_json=as_json)


def _verify(run: Run, *, as_json: bool) -> None:
    with _bar(run) as on_tick:
        verdict = verify(run, on_tick)
    if as_json:
        told = {"run": run.name, "task": run.head.task, "recorded_by": run.head.kurt2rt, "same": verdict.same}
        differences = [
            {**each._asdict(), "recorded": repr(each.recorded), "replayed": repr(each.replayed)}
            for each in verdict.differences
        ]
        print_json({**told, **plain(replace(verdict, differences=())), "differences": differences})
    else:
        for line in _verdict_in_words(run, verdict):
            typer.echo(line)
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


def _compare(run: Run, knowledge: Path, limit: int, *, as_json: bool) -> None:
    policy = load_policy(run, knowledge)
    with _bar(run) as on_tick:
        found = counterfactual(run, policy, on_tick=on_tick)
    if as_json:
        stretches = [
            {**each._asdict(), "was": _data(each.was), "would_be": _data(each.would_be)} for each in found.stretches
        ]
        told = {"run": run.name, "knowledge": knowledge, "same": found.same}
        print_json({**told, **plain(replace(found, stretches=())), "stretches": stretches})
        return
    typer.echo(_title(run))
    for line in _shares(found, knowledge):
        typer.echo(line)
    if found.stretches:
        _print_stretches(console_of(), found, limit)
    if found.trouble:
        typer.echo(found.trouble)


def _shares(found: Counterfactual, knowledge: Path) -> Iterator[str]:
    decided = max(found.decided, 1)
    yield f"{found.ticks} ticks, in {found.decided} of them knowledge had a say; with {knowledge}:"
    for count, what in (
        (found.other_action, "another action"),
        (found.would_drive, "would drive where it asked"),
        (found.would_ask, "would ask where it drove"),
        (found.mid_otherwise, "another way at the mid level"),
    ):
        if count:
            yield f"  {100 * count / decided:5.1f} %  {what} ({count} ticks)"
    if found.same:
        yield "  not one decision would have differed"


def _print_stretches(console: Console, found: Counterfactual, limit: int) -> None:
    longest = sorted(found.stretches, key=lambda each: -each.ticks)[:limit]
    title = "where it would have decided otherwise"
    if len(found.stretches) > limit:
        title += f": the longest {limit} of {len(found.stretches)} stretches"
    table = TextTable(title=title)
    for name in ("from s", "to s", "ticks"):
        table.add_column(name, number=True)
    for name in ("was", "would be", "nearest of R"):
        table.add_column(name)
    for each in sorted(longest, key=lambda each: each.from_s):
        table.add_row(*_row(each))
    print_whole(console, table)


def _row(stretch: DifferingStretch) -> tuple[str, ...]:
    at = "" if stretch.level == BASIC else f" ({stretch.level} level)"
    return (
        f"{stretch.from_s:.2f}",
        f"{stretch.to_s:.2f}",
        str(stretch.ticks),
        f"{_said(stretch.was)}{at}",
        f"{_said(stretch.would_be)}{at}",
        f"{stretch.was.share_of_radius:.2f}, would be {stretch.would_be.share_of_radius:.2f}",
    )


def _said(answer: PolicyAnswer) -> str:
    return "asks" if answer.rla is None else f"{answer.action} by {answer.rla.title}"


def _data(answer: PolicyAnswer) -> dict[str, object]:
    nearest = answer.nearest
    return {
        "action": answer.action,
        "rla": None if answer.rla is None else answer.rla.rla_id,
        "nearest": None if nearest is None else nearest.rla_id,
        "share_of_radius": None if nearest is None else answer.share_of_radius,
    }


def _title(run: Run) -> str:
    head = run.head
    return f"{run.name}: task {head.task}, robot {head.robot} on {head.bus}, recorded by kurt2rt {head.kurt2rt}"


@contextmanager
def _bar(run: Run) -> Iterator[OnTick]:
    whole_s = run.duration_s
    with job_bars() as report:

        def on_tick(tick: ReplayedTick) -> None:
            if tick.entry.number % _TELL_EVERY_TICKS == 0:
                report("replay", run.elapsed_s(tick.entry), max(whole_s, run.elapsed_s(tick.entry)))

        yield on_tick

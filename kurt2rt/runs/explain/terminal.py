"""Terminal rendering of an explanation and of a run's timeline."""

import math
from functools import partial

from rich.console import Group, RenderableType
from rich.text import Text

from kurt2rt.core.perception.sensor_words import NO_WORDS, SensorWords
from kurt2rt.knowledge.show.table_cells import printable
from kurt2rt.platform.text_table import Column, TextTable
from kurt2rt.runs.explain.attribution import contrast_attribution, distance_attribution
from kurt2rt.runs.explain.counterfactual import SensorCounterfactual
from kurt2rt.runs.explain.facts import DecisionFacts, LevelFacts, RlaFacts
from kurt2rt.runs.explain.reasons import format_reasons, headline
from kurt2rt.runs.explain.sentences import (
    format_counterfactuals,
    format_held,
    format_mid_level,
    format_runner_up,
    format_stamp,
    format_teaching,
    format_usage,
)
from kurt2rt.runs.explain.timeline import Kind, Stretch, Timeline, format_summary

_FEATURES = 6
_STYLES = {Kind.DRIVES: "green", Kind.LED: "magenta", Kind.ASKS: "red", Kind.STANDS: "yellow"}
_BAR = 20
_number = partial(Column, number=True)


def render_why(
    facts: DecisionFacts, found: tuple[SensorCounterfactual, ...], where: str, words: SensorWords = NO_WORDS
) -> RenderableType:
    """Return the text of one decision for a terminal.

    `found`: changes of one reading that would have changed it. `where`: run and time. `words`: for the robot's sensors.
    """
    parts: list[RenderableType] = [Text.assemble((where, "dim")), Text(headline(facts), style="bold")]
    parts += [printable(line) for line in format_reasons(facts)]
    parts += _of_level(*facts.deciding, words)
    changes = format_counterfactuals(found)
    if changes:
        parts.append(Text("\nWhat would have changed it, one reading alone:", style="bold"))
        parts += [printable(f"  {line}") for line in changes]
    if format_held(facts):
        parts.append(printable(format_held(facts)))
    above = format_mid_level(facts)
    if above:
        parts.append(Text(""))
        parts += [printable(line) for line in above]
    return Group(*parts)


def _of_level(level: LevelFacts, rla: RlaFacts | None, words: SensorWords) -> list[RenderableType]:
    """Render the RLA that decided, its rivals and the features."""
    if rla is None:
        return []
    parts: list[RenderableType] = [printable(line) for line in format_runner_up(level)]
    parts.append(_differences(level, rla, words))
    parts += [Text("Taught", style="bold"), printable(format_teaching(rla)), printable(format_usage(rla))]
    if len(rla.acts) > 1:
        parts.append(_history(rla))
    return parts


def _differences(level: LevelFacts, rla: RlaFacts, words: SensorWords) -> RenderableType:
    found = distance_attribution(level, rla)
    other = level.contrast_of(rla)
    pull = {} if other is None else contrast_attribution(level, rla, other)
    theirs = {} if other is None else dict(zip(level.names, other.condition, strict=True))
    rival: list[str | Column] = [] if other is None else [_number(other.name), "speaks for"]
    table = TextTable("feature", _number("here"), _number(rla.name), "of the distance", *rival)
    for share in found[:_FEATURES]:
        cells: list[str | Text] = [
            printable(words.place(share.name)),
            *(words.reading(share.name, each) for each in (share.here, share.there)),
        ]
        cells.append(f"{100 * share.share:3.0f} % {'█' * round(_BAR * share.share)}")
        if other is not None:
            of_feature = pull.get(share.name, 0.0)
            ahead = f"{100 * abs(of_feature):.0f} %"
            side = rla if of_feature > 0 else other
            cells += [
                words.reading(share.name, theirs[share.name]),
                "" if abs(of_feature) < 0.005 else f"{ahead} for {side.name}",
            ]
        table.add_row(*cells)
    hidden = len(found) - table.row_count
    if not found:
        return Text("It is the very situation that was taught." if rla.distance == 0 else "")
    return Group(table, Text(f"and {hidden} more features that differ", style="dim")) if hidden > 0 else table


def _history(rla: RlaFacts) -> TextTable:
    table = TextTable("when", "by", "phase", "what")
    for act in rla.acts:
        text = f"{act.text} (taken back)" if act.undone else act.text
        table.add_row(printable(format_stamp(act)), printable(act.teacher), str(act.phase), printable(text))
    return table


def render_timeline(timeline: Timeline, where: str, most: int) -> RenderableType:
    """Return the table of the stretches of a run for a terminal.

    If there are more than `most`, show only those in which the robot did not drive by itself.
    """
    whole_s = max(timeline.to_s - timeline.from_s, 1e-9)
    parts: list[RenderableType] = [
        Text(where, style="dim"),
        Text(format_summary(timeline), style="bold"),
        _shares(timeline, whole_s),
    ]
    rows = list(timeline.stretches)
    if len(rows) > most:
        rows = [stretch for stretch in rows if stretch.kind is not Kind.DRIVES]
        parts.append(
            Text(
                f"{len(timeline.stretches)} stretches; here are those in which it did not drive by itself. "
                "Give --from and --to for all of a shorter time."
            )
        )
    times = map(_number, ("from s", "to s", "lasts s"))
    table = TextTable(*times, "what", "RLAs (share of the time)", _number("farthest"), "guard")
    for stretch in rows[:most]:
        table.add_row(*_row(stretch))
    parts.append(table)
    if len(rows) > most:
        parts.append(Text(f"and {len(rows) - most} more"))
    notes = timeline.notes[:most]
    if notes:
        told = TextTable(_number("at s"), "what happened")
        for note in notes:
            told.add_row(
                f"{note.at_s:.2f}", printable(f"{note.kind}: {note.text}" if note.kind == "alarm" else note.text)
            )
        parts.append(told)
        if len(timeline.notes) > most:
            parts.append(Text(f"and {len(timeline.notes) - most} more"))
    return Group(*parts)


def _shares(timeline: Timeline, whole_s: float) -> TextTable:
    """Return the activities with their total times, longest first."""
    lasts: dict[tuple[Kind, str], float] = {}
    times: dict[tuple[Kind, str], int] = {}
    for stretch in timeline.stretches:
        key = stretch.kind, stretch.what
        lasts[key] = lasts.get(key, 0.0) + stretch.lasts_s
        times[key] = times.get(key, 0) + 1
    table = TextTable("what", _number("s"), _number("times"), "share of the time")
    for kind, what in sorted(lasts, key=lambda key: -lasts[key]):
        share = lasts[kind, what] / whole_s
        bar = f"{100 * share:3.0f} % {'█' * round(_BAR * share)}"
        table.add_row(
            Text(_format_stretch(kind, what), style=_STYLES[kind]),
            f"{lasts[kind, what]:.1f}",
            str(times[kind, what]),
            bar,
        )
    return table


def _row(stretch: Stretch) -> list[str | Text]:
    ticks = sum(stretch.rlas.values())
    drove = sorted(stretch.rlas.items(), key=lambda each: -each[1])[:4]
    rlas = ", ".join(f"{rla_id} ({100 * count / ticks:.0f} %)" for rla_id, count in drove)
    more = len(stretch.rlas) - len(drove)
    what = _format_stretch(stretch.kind, stretch.what)
    return [
        f"{stretch.from_s:.2f}",
        f"{stretch.to_s:.2f}",
        f"{stretch.lasts_s:.2f}",
        Text(f"{what} ({stretch.behaviour})" if stretch.behaviour else what, style=_STYLES[stretch.kind]),
        f"{rlas} and {more} more" if more else rlas,
        "far off" if math.isinf(stretch.worst) else f"{stretch.worst:.2f} R" if stretch.rlas else "",
        ", ".join(stretch.guarded),
    ]


def _format_stretch(kind: Kind, what: str) -> str:
    return f"led: {what}" if kind is Kind.LED else f"stands: {what}" if kind is Kind.STANDS else what

"""A run as stretches: what the robot did from when to when."""

import re
from collections.abc import Iterator
from io import StringIO
from itertools import pairwise
from pathlib import Path

import pytest
from rich.console import Console

from kurt2rt.core.rla.rla import Phase
from kurt2rt.runs.explain.terminal import render_timeline
from kurt2rt.runs.explain.timeline import MOST_SAMPLES, build_timeline, format_summary
from kurt2rt.runs.explain.timeline_picture import draw_timeline
from tests.runs.explain.helpers import ROBOT, Lesson
from tests.teacher.helpers import correct, resume, set_phase, stop, teach


@pytest.fixture(scope="module")
def lesson() -> Iterator[Lesson]:
    """Asks for 0.2 s, drives ahead for a second, is corrected, stopped for half a second, and drives on."""
    # A correction that replaces: two RLAs next to each other would drive in turn, by the noise of the sensors.
    lesson = Lesson(changes={"learning.insert_radius_fraction": "0.2"})
    lesson.go_on(20)
    lesson.go_on(100, teach("forward"))
    lesson.go_on(50, set_phase(Phase.CORRECTIONS), correct("bear_right"))
    lesson.go_on(50, stop())
    lesson.go_on(30, resume())
    yield lesson
    lesson.close()


def test_a_part_of_a_run_is_told_by_the_runs_own_seconds(lesson: Lesson) -> None:
    part = build_timeline(lesson.entries, ROBOT, from_s=1.0, to_s=1.5)
    assert [stretch.what for stretch in part.stretches] == ["forward", "bear_right"]
    assert part.from_s == pytest.approx(1.0)
    assert part.to_s == pytest.approx(1.51)
    # The way is reckoned from the beginning of the run all the same.
    whole = build_timeline(lesson.entries, ROBOT, every=1)
    beginning = next(sample for sample in whole.samples if sample.at_s >= 1.0 - 1e-9)
    assert (part.samples[0].x_m, part.samples[0].y_m) == (beginning.x_m, beginning.y_m)


def said(lesson: Lesson, most: int) -> str:
    console = Console(width=120, file=StringIO())
    with console.capture() as capture:
        console.print(render_timeline(build_timeline(lesson.entries, ROBOT), "a run", most))
    return capture.get()


def test_in_words_the_shares_come_first_then_what_happened_when(lesson: Lesson) -> None:
    text = said(lesson, 40)
    timeline = build_timeline(lesson.entries, ROBOT)
    summary, note = format_summary(timeline), timeline.notes[1].text
    assert re.findall(r"(\d+) %", summary) == ["72", "8", "20"]  # drove, asked, stood
    assert text.index(summary) < text.index("from s") < text.index(note)


def test_the_picture_is_drawn_also_of_nothing(lesson: Lesson, tmp_path: Path) -> None:
    for name, entries in (("run", lesson.entries), ("nothing", [])):
        draw_timeline(build_timeline(entries, ROBOT), "a run", tmp_path / f"{name}.svg")
        assert b"a run" in (tmp_path / f"{name}.svg").read_bytes()


def test_timeline_of_many_stretches_draws_shares_fewer_samples(lesson: Lesson, tmp_path: Path) -> None:
    entries = lesson.entries
    long = (
        entry._replace(tick=entry.tick + 250 * again, now_s=entry.now_s + 2.5 * again)
        for again in range(84)
        for entry in entries
    )
    timeline = build_timeline(long, ROBOT, every=1)
    assert len(timeline.stretches) == 420
    assert MOST_SAMPLES <= len(timeline.samples) < 2 * MOST_SAMPLES
    apart = {round(b.at_s - a.at_s, 3) for a, b in pairwise(timeline.samples)}
    assert apart == {0.04}
    draw_timeline(timeline, "a long run", tmp_path / "long.png")
    assert (tmp_path / "long.png").stat().st_size > 10_000

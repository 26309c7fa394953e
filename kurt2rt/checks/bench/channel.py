"""Benchmark of the teacher's channel over UDP, from the device to the wheels and to the disk."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from kurt2rt.checks.bench.channel_lesson import measure_channel_lessons
from kurt2rt.checks.bench.channel_load import LoadShifts, measure_load
from kurt2rt.checks.bench.press_to_wheel import measure_presses, measure_presses_on_page
from kurt2rt.checks.bench.result import BenchResult
from kurt2rt.checks.bench.robot_under_test import BenchFixture, OnProgress

_PAGE_PACKAGES = ("starlette", "uvicorn", "websockets")


@dataclass(frozen=True, slots=True)
class ChannelLengths:
    """Numbers of measurements of the channel."""

    presses: int
    shifts: LoadShifts
    lessons: int


async def measure_channel(
    fixture: BenchFixture, folder: Path, lengths: ChannelLengths, start_job: Callable[[str], OnProgress]
) -> tuple[BenchResult, ...]:
    """Measure presses with and without the page, the loop with a teacher, and lessons.

    Files go to folders in `folder`. The page is left out if its optional packages are missing. Raises LessonLostError,
    KnowledgeError, ChannelError, CredentialsError, HelperLostError, OSError without a timerfd.
    """
    results = [
        await measure_presses(fixture, folder / "press", lengths.presses, start_job("pressing, in a teacher's program"))
    ]
    if all(find_spec(package) for package in _PAGE_PACKAGES):
        results.append(
            await measure_presses_on_page(
                fixture, folder / "press_on_page", lengths.presses, start_job("pressing, on the teacher's page")
            )
        )
    results += await measure_load(
        fixture, folder / "load", lengths.shifts, start_job("driving, with and without a teacher there")
    )
    results.append(
        await measure_channel_lessons(fixture, folder / "lessons", lengths.lessons, start_job("teaching over UDP"))
    )
    return tuple(results)

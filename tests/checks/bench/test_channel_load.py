"""Cost of connected pages and teachers for the loop, from load phases with known numbers."""

import pytest

from kurt2rt.checks.bench.channel_load import Load, LoadPhase, LoadPhases, load_results
from kurt2rt.platform.ledger import Percentiles


def phases(lateness_p99_us: float, *each: LoadPhase) -> LoadPhases:
    return LoadPhases(Percentiles(70.0, lateness_p99_us, 2 * lateness_p99_us), each)


def stay(work_us: float, messages: int, missed: int = 0) -> LoadPhase:
    """Return a load phase of two seconds; `work_us` is processor time per second."""
    return LoadPhase(seconds=2.0, processor_us=2 * work_us, messages=messages, missed_ticks=missed)


def test_load_results_separate_state_and_message_costs() -> None:
    late, work, picture, message = load_results(
        {
            Load.ALONE: phases(200.0, stay(100_000.0, 0), stay(110_000.0, 0)),
            Load.ONLOOKER: phases(250.0, stay(108_000.0, 2), stay(118_000.0, 2)),
            Load.TEACHER: phases(400.0, stay(124_000.0, 66), stay(134_000.0, 66)),
        },
        period_s=0.01,
        driving_share=0.97,
    )
    assert picture.took.median_us == pytest.approx(8000.0 / 20)
    assert message.took.median_us == pytest.approx(16_000.0 / 32)
    assert work.took.median_us == pytest.approx(24_000.0)
    assert work.note.startswith("2.4 %")
    assert late.reference is not None
    assert late.reference.ratio == pytest.approx(0.5)
    assert all(goal.met for result in (late, work) for goal in result.goals)
    assert "32 messages in" in late.note
    assert "97%" in late.note


def test_a_missed_tick_misses_the_goal() -> None:
    late, *_ = load_results(
        {
            Load.ALONE: phases(200.0, stay(100_000.0, 0)),
            Load.ONLOOKER: phases(200.0, stay(110_000.0, 2)),
            Load.TEACHER: phases(410.0, stay(150_001.0, 66, missed=1)),
        },
        period_s=0.01,
        driving_share=1.0,
    )
    assert [goal.met for goal in late.goals] == [False]

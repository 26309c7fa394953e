"""Agreement of critic and teacher, from journal events."""

import pytest

from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.settings import AgreementSettings
from kurt2rt.core.rla.events import (
    ActionReplaced,
    Appraised,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    RlaRewarded,
    TeachingEvent,
)
from kurt2rt.core.rla.rla import CRITIC, Origin, Phase, Rla
from tests.core.critic.helpers import SETTINGS, appraisal, origin

PERIOD_S = 0.01

NAMES = {-1: "bad", 0: "neutral", 1: "good"}


def agreement(bound: float = 0.8, window: int = 5, least: int = 2, apart_s: float = 0.0) -> Agreement:
    settings = AgreementSettings(bound=bound, window=window, least=least, apart_s=apart_s)
    return Agreement(settings, SETTINGS.values, PERIOD_S)


def rewarded(value: int, said: int | None, said_by: Origin | None = None) -> RlaRewarded:
    return RlaRewarded(7, value, 0, said_by or origin(), said=said)


def agreed(value: int, times: int = 1) -> list[TeachingEvent]:
    return [Appraised(NAMES[value], value, 0, origin()) for _ in range(times)]


def test_agreement_too_few_signals_no_trust() -> None:
    one = agreement()
    one.replay([*agreed(1, 5), *agreed(0, 5), *agreed(-1, 1)])
    assert (one.share, one.trusted) == (None, False)
    one.replay(agreed(-1))
    assert (one.share, one.trusted) == (1.0, True)


def test_agreement_values_have_equal_weight() -> None:
    one = agreement(bound=0.75)
    one.on_event(appraisal(1, "bad"))
    one.replay([*agreed(-1), *agreed(1, 5)])
    assert one.share == (0.5 + 1.0) / 2
    assert one.trusted
    one.on_event(rewarded(-1, said=1))
    assert one.share == (1 / 3 + 1.0) / 2
    assert not one.trusted


@pytest.mark.parametrize("right", [(6, 8, 10), (5, 9, 10), (7, 8, 9)])
def test_agreement_at_the_very_bound_is_trusted(right: tuple[int, int, int]) -> None:
    one = agreement(bound=0.8, window=10, least=10)
    for value, times in zip((-1, 0, 1), right, strict=True):
        one.replay([*agreed(value, times), *(appraisal(each, NAMES[value]) for each in range(10 - times))])
    assert (one.share, one.trusted) == (0.8, True)


def test_agreement_window_keeps_the_newest() -> None:
    one = agreement(window=3)
    one.replay([*agreed(1, 3), *agreed(-1, 3), *[rewarded(1, said=None) for _ in range(3)]])
    assert one.share == 1.0  # it has no appraisal yet that could have said anything
    one.on_event(appraisal(1, "neutral"))
    one.replay([rewarded(1, said=None) for _ in range(3)])
    assert (one.share, one.count_for(1)) == (0.5, 3)
    one.replay(agreed(1, 3))
    assert one.share == 1.0


def test_agreement_neutral_counts_from_enough_on() -> None:
    one = agreement()
    one.replay([*agreed(1, 2), *agreed(-1, 2), appraisal(1, "neutral")])
    assert one.share == 1.0
    one.on_event(appraisal(2, "neutral"))
    assert one.share == 2 / 3
    assert one.count_for(0) == 2


def test_agreement_lesson_to_critic_is_disagreement() -> None:
    one = agreement()
    one.replay([*agreed(1, 2), *agreed(-1, 2)])
    one.on_event(RlaCreated(Rla(1, (0.0,), "good", None, origin())))
    one.on_event(ActionReplaced(1, "bad", "good", origin()))
    assert (one.count_for(1), one.count_for(-1)) == (2, 2)
    one.on_event(appraisal(2, "good"))
    assert one.share == 5 / 6
    one.on_event(ActionReplaced(2, "bad", "good", origin()))
    assert one.share == 2 / 3


def test_agreement_ignores_events_of_the_critic() -> None:
    one = agreement()
    one.on_event(appraisal(1, "bad"))
    one.on_event(rewarded(-1, said=-1, said_by=origin(teacher=CRITIC, phase=Phase.AUTONOMOUS)))
    assert one.count_for(-1) == 1


def test_agreement_undone_signal_is_removed() -> None:
    one = agreement()
    one.replay([*agreed(1, 2), *agreed(-1, 2)])
    mistaken = origin("mistaken")
    one.on_event(appraisal(1, "bad", said_by=mistaken))
    assert one.share == 5 / 6
    one.on_event(LessonUndone("mistaken", origin()))
    one.on_event(LessonUndone("unknown", origin()))
    assert (one.share, one.count_for(-1)) == (1.0, 2)
    one.on_event(LessonRedone("mistaken", origin()))
    one.on_event(LessonRedone("unknown", origin()))
    assert one.share == 5 / 6


def said_at(tick: int, *, right: bool) -> TeachingEvent:
    by = origin(tick=tick)
    return Appraised("good", 1, tick, by) if right else rewarded(1, said=-1, said_by=by)


def test_agreement_signal_soon_after_another_is_ignored() -> None:
    """Ten clicks of "good" in one place would count ten times otherwise; and only agreements would be lost."""
    one = agreement(apart_s=5.0)
    one.on_event(appraisal(1, "good", said_by=origin(tick=100)))
    one.replay([said_at(100 + after, right=after % 2 == 0) for after in range(1, 500, 50)])
    assert one.count_for(1) == 1
    one.replay([said_at(600, right=True), said_at(1099, right=False), said_at(1100, right=False)])
    one.replay(Appraised("bad", -1, tick, origin(tick=tick)) for tick in (2000, 3000))
    assert (one.count_for(1), one.share) == (3, 2 / 3)


def test_agreement_ticks_of_a_new_run_count() -> None:
    one = agreement(apart_s=5.0)
    one.replay([appraisal(1, "good", said_by=origin(tick=9000)), said_at(10, right=True), said_at(20, right=True)])
    assert one.count_for(1) == 2

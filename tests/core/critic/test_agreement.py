"""Agreement of critic and teacher, from journal events."""

from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.settings import AgreementSettings
from kurt2rt.core.rla.events import Appraised, LessonRedone, LessonUndone, TeachingEvent
from tests.core.critic.helpers import SETTINGS, appraisal, origin

PERIOD_S = 0.01

NAMES = {-1: "bad", 0: "neutral", 1: "good"}


def agreement(bound: float = 0.8, window: int = 5, least: int = 2, apart_s: float = 0.0) -> Agreement:
    settings = AgreementSettings(bound=bound, window=window, least=least, apart_s=apart_s)
    return Agreement(settings, SETTINGS.values, PERIOD_S)


def agreed(value: int, times: int = 1) -> list[TeachingEvent]:
    return [Appraised(NAMES[value], value, 0, origin()) for _ in range(times)]


def test_agreement_too_few_signals_no_trust() -> None:
    one = agreement()
    one.replay([*agreed(1, 5), *agreed(0, 5), *agreed(-1, 1)])
    assert (one.share, one.trusted) == (None, False)
    one.replay(agreed(-1))
    assert (one.share, one.trusted) == (1.0, True)


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

"""Signals of the critic in phase 5."""

from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.autonomy import Autonomy
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.critic.settings import ActivationSettings, AgreementSettings, SignalEverySettings
from kurt2rt.core.rla.events import Appraised, RlaRewarded
from tests.core.critic.helpers import SETTINGS, appraisal, origin

BAD = Opinion(-1, "bad", 0.7, None, 0.1, 1.0, True)
GOOD = Opinion(1, "good", 0.5, None, 0.1, 1.0, True)
NEUTRAL = Opinion(0, "neutral", 0.7, None, 0.1, 1.0, True)
UNKNOWN = Opinion(0, "", 0.0, None, 2.0, 1.0, False)
ALWAYS = ActivationSettings(bad_share=0.0, mean_s=1.0, first_s=0.0)
RATES = SETTINGS.model_copy(
    update={"signal_every_s": SignalEverySettings(bad=1.0, good=2.0), "patience_s": 0.0, "need": ALWAYS}
)


def agreement(*, trusted: bool = True) -> Agreement:
    heard = Agreement(AgreementSettings(bound=0.8, window=2, least=1, apart_s=0.0), SETTINGS.values, 0.01)
    heard.on_event(Appraised("bad", -1, 0, origin()))
    if trusted:
        heard.on_event(Appraised("good", 1, 0, origin()))
    assert heard.trusted is trusted
    return heard


def test_autonomy_signals_are_rate_limited() -> None:
    speaking = Autonomy(RATES, agreement(), 0.01)
    assert [tick for tick in range(450) if speaking.signal(tick, BAD, True)] == [0, 100, 200, 300, 400]
    assert [tick for tick in range(450) if speaking.signal(tick, GOOD, True)] == [0, 200, 400]


def test_autonomy_neutral_unknown_or_standing_no_signal() -> None:
    speaking = Autonomy(RATES, agreement(), 0.01)
    assert speaking.signal(1, NEUTRAL, True) is None
    assert speaking.signal(2, UNKNOWN, True) is None
    assert speaking.signal(3, None, True) is None
    assert speaking.signal(4, BAD, False) is None
    assert speaking.signal(5, BAD, True) is not None


def test_autonomy_untrusted_no_signal() -> None:
    heard = agreement(trusted=False)
    speaking = Autonomy(RATES, heard, 0.01)
    assert speaking.signal(1, BAD, True) is None
    heard.on_event(Appraised("good", 1, 0, origin()))
    assert speaking.signal(2, BAD, True) is not None
    heard.replay([appraisal(1, "bad"), RlaRewarded(9, -1, 0, origin(), said=1)])
    assert speaking.signal(300, BAD, True) is None


def test_autonomy_short_opinion_no_signal() -> None:
    speaking = Autonomy(RATES.model_copy(update={"patience_s": 0.05}), agreement(), 0.01)
    thought = [BAD, BAD, BAD, BAD, GOOD, BAD, BAD, BAD, BAD, BAD, BAD, BAD]
    assert [tick for tick, opinion in enumerate(thought) if speaking.signal(tick, opinion, True)] == [10]


def test_autonomy_wait_or_gap_restarts_patience() -> None:
    speaking = Autonomy(RATES.model_copy(update={"patience_s": 0.05}), agreement(), 0.01)
    assert [tick for tick in range(20) if speaking.signal(tick, BAD, tick != 4)] == [10]
    assert [tick for tick in range(200, 210) if speaking.signal(tick, BAD, True)] == [205]


def test_autonomy_good_driving_no_signal() -> None:
    need = ActivationSettings(bad_share=0.05, mean_s=1.0, first_s=0.0)
    listening = Autonomy(RATES.model_copy(update={"need": need}), agreement(), 0.01)
    said = [tick for tick in range(2000) if listening.signal(tick, BAD if tick % 50 == 49 else GOOD, True)]
    assert (said, listening.activation.needed) == ([], False)
    assert next(tick for tick in range(2000, 2100) if listening.signal(tick, BAD, True)) < 2010
    assert listening.signal(2300, GOOD, True) is not None  # from then on it acts


def test_autonomy_listening_still_updates_activation() -> None:
    need = ActivationSettings(bad_share=0.5, mean_s=1.0, first_s=0.0)
    listening = Autonomy(RATES.model_copy(update={"need": need}), agreement(), 0.01)
    assert not any(listening.signal(tick, BAD, True, listening=True) for tick in range(100))
    assert listening.signal(100, GOOD, True) is not None

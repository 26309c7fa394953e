"""Signals of the critic in phase 5."""

from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.autonomy import Autonomy
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.critic.settings import ActivationSettings, AgreementSettings, SignalEverySettings
from kurt2rt.core.rla.events import Appraised, RlaRewarded
from tests.core.critic.helpers import SETTINGS, appraisal, origin

BAD = Opinion(-1, "bad", 0.7, None, 0.1, 1.0, True)
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


def test_autonomy_untrusted_no_signal() -> None:
    heard = agreement(trusted=False)
    speaking = Autonomy(RATES, heard, 0.01)
    assert not speaking.speaks(1, BAD, True)
    heard.on_event(Appraised("good", 1, 0, origin()))
    assert speaking.speaks(2, BAD, True)
    heard.replay([appraisal(1, "bad"), RlaRewarded(9, -1, 0, origin(), said=1)])
    assert not speaking.speaks(300, BAD, True)

"""Controls of the phases study: wrong actions, another critic, and a count of what critic and judge say."""

import random
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from behaviors.judges.judge import Judge
from config.settings import Settings
from kurt2rt.core.critic.settings import CriticSettings
from kurt2rt.core.rla.events import ActionReplaced, Appraised, RlaCreated, RlaDeleted, TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, Origin, Phase, Rla
from kurt2rt.core.tick_record import TickRecord

_NAME = "corruption"


def corrupt(
    rlas: Sequence[Rla], actions: Sequence[str], share: float, seed: int, purpose: str
) -> Iterator[ActionReplaced]:
    """Yield the events that give this share of the RLAs, 0 to 1, at least one, another action of `actions`.

    Each purpose has wrong actions of its own: a critic is not examined on those that it was taught on.
    """
    chance = random.Random(f"corruption for {purpose}, seed {seed}")
    chosen = chance.sample(rlas, max(1, round(share * len(rlas)))) if rlas else []
    for number, rla in enumerate(chosen, start=1):
        action = chance.choice([each for each in actions if each != rla.action])
        origin = Origin(f"corruption-{purpose}-{seed}-{number}", _NAME, Phase.CORRECTIONS, rla.origin.tick)
        yield ActionReplaced(rla.rla_id, action, rla.action, origin)


def critic_lessons(events: Iterable[TeachingEvent]) -> Iterator[TeachingEvent]:
    """Yield those of the events that are lessons of the critic, or appraisals of its agreement."""
    ids: set[int] = set()
    for event in events:
        match event:
            case RlaCreated(rla) if rla.level == CRITIC:
                ids.add(rla.rla_id)
                yield event
            case Appraised():
                yield event
            case ActionReplaced(rla_id) | RlaDeleted(rla_id) if rla_id in ids:
                yield event


def shuffled(
    appraisals: Sequence[Rla], settings: CriticSettings, seed: int, period_s: float
) -> Iterator[TeachingEvent]:
    """Yield the appraisal RLAs with shuffled opinions, and appraisals that make the robot trust them.

    `seed`: of the shuffle. `period_s`: duration of a tick in s.
    """
    opinions = [rla.action for rla in appraisals]
    random.Random(f"shuffled critic, seed {seed}").shuffle(opinions)
    for rla, opinion in zip(appraisals, opinions, strict=True):
        origin = Origin(f"shuffled-{seed}-{rla.rla_id}", _NAME, Phase.CRITIC, rla.origin.tick)
        yield RlaCreated(
            Rla(rla.rla_id, rla.condition, opinion, rla.radius, origin, behaviour=rla.behaviour, level=rla.level)
        )
    apart_ticks = round(settings.agreement.apart_s / period_s)
    tick = max((rla.origin.tick for rla in appraisals), default=0)
    for appraisal in settings.appraisals:
        for number in range(settings.agreement.window):
            tick += apart_ticks
            origin = Origin(f"trusted-{seed}-{appraisal.name}-{number}", _NAME, Phase.CRITIC, tick)
            yield Appraised(appraisal.name, appraisal.value, tick, origin)


class Judgement(Settings):
    """Opinions of judge and critic, with the number of their ticks."""

    judged: int
    """Opinion of the judge: -1, 0 or +1."""
    said: int | None
    """Opinion of the critic; None: unknown."""
    ticks: int


class Scoring:
    """Counter of the pairs of opinions of critic and judge, while the robot drives."""

    def __init__(self, judge: Judge) -> None:
        self._judge = judge
        self._ticks: Counter[tuple[int, int | None]] = Counter()

    def on_tick(self, record: TickRecord) -> None:
        """Count the pair of opinions of critic and judge in one tick; call it on every tick."""
        if record.appraisal_features is None or not record.decision.driving:
            return
        said = None if record.opinion is None else record.opinion.said
        self._ticks[self._judge.judge(record.appraisal_features), said] += 1

    @property
    def judgements(self) -> Iterator[Judgement]:
        """Pairs of opinions of judge and critic, each with its number of ticks."""
        for judged, said in sorted(self._ticks, key=str):
            yield Judgement(judged=judged, said=said, ticks=self._ticks[judged, said])

"""Changes of the knowledge before a branch begins: wrong actions, and another critic."""

import random
from collections.abc import Iterable, Iterator, Sequence

from kurt2rt.core.critic.settings import CriticSettings
from kurt2rt.core.rla.events import ActionReplaced, Appraised, RlaCreated, RlaDeleted, TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, Origin, Phase, Rla

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

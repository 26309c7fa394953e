"""Teaching the critic what a situation was worth (paper, phase 4)."""

import numpy as np
from numpy.typing import NDArray

from kurt2rt.critic.critic import Critic, Opinion
from kurt2rt.rla.rla import CRITIC, ActionReplaced, Appraised, Origin, Rla, RlaCreated, TeachingEvent
from kurt2rt.rla.rla_system import RlaSystem
from kurt2rt.teaching.commands import Appraise
from kurt2rt.teaching.recent import RecentDecisions
from kurt2rt.teaching.refused import RefusedError


class Appraising:
    """Turns what a teacher says of a situation into the event that teaches it to the critic."""

    def __init__(self, critic: Critic, system: RlaSystem, recent: RecentDecisions, period_s: float) -> None:
        """`period_s` of a tick."""
        self._critic = critic
        self._system = system
        self._recent = recent
        self._apart_ticks = round(critic.settings.agreement.apart_s / period_s)
        self._settled: dict[int, int] = {}
        """RLA id -> tick of this run in which it was taught, or was counted as agreeing, last."""

    @property
    def appraisals(self) -> tuple[str, ...]:
        """Names that a situation can be given."""
        return self._critic.appraisals

    def event_of(self, command: Appraise, meant: int, origin: Origin) -> tuple[str, TeachingEvent | None]:
        """What is done, and the event that does it; `meant`: a tick that is remembered. Raises RefusedError.

        Another opinion than the critic's is learnt, the same one only counts for how far they agree. What the critic
        has come to think since that tick counts for nothing, nor does what it was taught, or counted with, just before:
        it may have learnt it from what was said just then.
        """
        if command.appraisal not in self.appraisals:
            known = ", ".join(self.appraisals)
            raise RefusedError(f"there is no appraisal {command.appraisal!r}; the critic knows: {known}")
        circumstances = self._recent.circumstances(meant)
        if circumstances is None:
            raise RefusedError("the infra-red sensors were silent then, so there is no situation to appraise")
        vector = self._critic.vector_of(circumstances)
        now, then = self._critic.opinion(vector), self._recent.opinion(meant)
        if now is not None and now.known and now.appraisal == command.appraisal:
            if then is not None and then.appraisal == command.appraisal and self._counts(then, meant):
                value = self._critic.settings.values[command.appraisal]
                return f"the critic thought {command.appraisal}, too", Appraised(
                    command.appraisal, value, meant, origin
                )
            return f"the critic says {command.appraisal} already", None
        return self._lesson(command.appraisal, vector, now, origin)

    def hear(self, event: TeachingEvent) -> None:
        """Follow an event that was applied to the system just now."""
        match event:
            case RlaCreated(rla) if rla.level == CRITIC:
                self._settled[rla.rla_id] = event.origin.tick
            case ActionReplaced(rla_id):
                rla_meant = self._system.get(rla_id)
                if rla_meant is not None and rla_meant.level == CRITIC:
                    self._settled[rla_id] = event.origin.tick
            case Appraised(_, _, decided_at_tick):
                opinion = self._recent.opinion(decided_at_tick)
                if opinion is not None and opinion.rla is not None:
                    self._settled[opinion.rla.rla_id] = decided_at_tick

    def _counts(self, opinion: Opinion, meant: int) -> bool:
        """Whether that it agrees says something of an opinion that it had in a tick."""
        if opinion.rla is None or not opinion.known:
            return False
        settled = self._settled.get(opinion.rla.rla_id)
        return settled is None or meant - settled >= self._apart_ticks

    def _lesson(
        self, appraisal: str, vector: NDArray[np.float64], now: Opinion | None, origin: Origin
    ) -> tuple[str, TeachingEvent]:
        if now is not None and now.rla is not None and now.distance <= self._critic.insert_beyond:
            rla = now.rla
            event = ActionReplaced(rla.rla_id, appraisal, rla.action, origin)
            return f"{rla.title} corrected: {appraisal} instead of {rla.action}", event
        rla = Rla(
            rla_id=self._system.next_id,
            condition=tuple(vector.tolist()),
            action=appraisal,
            radius=None,
            origin=origin,
            level=CRITIC,
        )
        return f"{rla.title} taught: {rla.action}", RlaCreated(rla)

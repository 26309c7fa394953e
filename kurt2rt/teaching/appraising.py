"""Teaching the critic what a situation was worth (paper, phase 4)."""

from kurt2rt.critic.critic import Critic
from kurt2rt.rla.rla import CRITIC, ActionReplaced, Appraised, Origin, Rla, RlaCreated, TeachingEvent
from kurt2rt.rla.rla_system import RlaSystem
from kurt2rt.teaching.commands import Appraise
from kurt2rt.teaching.recent import RecentDecisions
from kurt2rt.teaching.refused import RefusedError


class Appraising:
    """Turns what a teacher says of a situation into the event that teaches it to the critic."""

    def __init__(self, critic: Critic, system: RlaSystem, recent: RecentDecisions) -> None:
        self._critic = critic
        self._system = system
        self._recent = recent

    @property
    def appraisals(self) -> tuple[str, ...]:
        """Names that a situation can be given."""
        return self._critic.appraisals

    def event_of(self, command: Appraise, meant: int, origin: Origin) -> tuple[str, TeachingEvent | None]:
        """What is done, and the event that does it; `meant`: a tick that is remembered. Raises RefusedError.

        Another opinion than the critic's is learnt, the same one only counts for how far they agree. What the critic
        has come to think since that tick counts for nothing: it may have learnt it from what was said just before.
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
            if then is not None and then.known and then.appraisal == command.appraisal:
                value = self._critic.settings.values[command.appraisal]
                return f"the critic thought {command.appraisal}, too", Appraised(
                    command.appraisal, value, meant, origin
                )
            return f"the critic says {command.appraisal} already", None
        if now is not None and now.rla is not None and now.distance <= self._critic.insert_beyond:
            rla = now.rla
            event = ActionReplaced(rla.rla_id, command.appraisal, rla.action, origin)
            return f"{rla.title} corrected: {command.appraisal} instead of {rla.action}", event
        rla = Rla(
            rla_id=self._system.next_id,
            condition=tuple(vector.tolist()),
            action=command.appraisal,
            radius=None,
            origin=origin,
            level=CRITIC,
        )
        return f"{rla.title} taught: {rla.action}", RlaCreated(rla)

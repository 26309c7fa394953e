"""A robot on a line: its situation is one number, and all that learns goes on behind it, one tick in a call."""

from behaviors.judges.judge import AppraisalFeatures
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.critic import Critic
from kurt2rt.core.critic.settings import (
    ActivationSettings,
    AgreementSettings,
    CriticSettings,
    RollbackSettings,
    SignalEverySettings,
)
from kurt2rt.core.decision.decision import ActiveBehaviour, Decision, DecisionCause
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.reinforcement.self_teaching import SelfTeaching
from kurt2rt.core.reinforcement.settings import AutonomousValues, ReinforcementSettings, TaughtValues
from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.events import Appraised, RlaDeleted, RlaRewarded, TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, Phase
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.teaching.authority import ControlAuthority
from kurt2rt.core.teaching.command_handler import CommandHandler
from kurt2rt.core.teaching.commands import Command, CommandResult, Reward, Stream
from kurt2rt.core.teaching.knowledge_updater import HandlerParts
from tests.core.critic.helpers import FREE, SETTINGS, appraisal, origin
from tests.core.helpers import MINIMUM_TICKS, RADIUS, Counted, sensed, situation

PERIOD_S = 0.01
SIGNALS_ONLY = ReinforcementSettings(
    step_s=100.0,
    with_teacher=TaughtValues(
        first_value=0.5, highest_value=None, sunk_below=-0.2, well_above=-0.2, blamed_share=0.001
    ),
    alone=AutonomousValues(first_value=0.5, sunk_below=-0.2, well_above=-0.2, blamed_share=0.001),
)
"""Values change by signals alone, so that they can be told in one's head; three blames sink an RLA."""

SHARE = 0.5
"""Corrections, and answers to what was withdrawn, replace within this share of RADIUS."""

CALM = FREE
CRASHED = FREE._replace(front_m=0.05, bumped=1.0)

QUICK = SETTINGS.model_copy(
    update={
        "think_every_ticks": 1,
        "patience_s": 0.0,
        "agreement": AgreementSettings(bound=0.8, window=5, least=2, apart_s=0.0),
        "signal_every_s": SignalEverySettings(bad=0.1, good=0.2),
        "need": ActivationSettings(bad_share=0.0, mean_s=1.0, first_s=0.0),
        "best": RollbackSettings(window_s=1.0, margin=0.1),
    }
)
"""A critic that is trusted after two signals of each value, and speaks ten times a second."""


def knows_good_from_bad(first_id: int = 100) -> list[TeachingEvent]:
    """Return lessons of a trusted critic: CALM is good, CRASHED is bad."""
    return [
        appraisal(first_id, "good", CALM),
        appraisal(first_id + 1, "bad", CRASHED),
        *(Appraised(name, value, 1, origin()) for name, value in (("good", 1), ("bad", -1)) for _ in range(5)),
    ]


class Track:
    """A level with the actions a, b and c, its school, and everything that learns."""

    def __init__(
        self,
        *events: TeachingEvent,
        reinforcement: ReinforcementSettings | None = None,
        critic: CriticSettings = QUICK,
        phase: Phase = Phase.REINFORCEMENT,
        saved: Statistics | None = None,
    ) -> None:
        space = Space(len(critic.names), critic.learning.radius, critic.weight_vector)
        self.system = RlaSystem(1, RADIUS, others={CRITIC: space})
        self.recent = DecisionHistory(1)
        self.reinforcement = Reinforcement(self.system, self.recent, reinforcement or SIGNALS_ONLY, PERIOD_S)
        self.reinforcement.restore(events, saved)
        actions = {name: Counted() for name in "abc"}
        choice = self.reinforcement.choice
        self.level = BasicLevel(self.system, actions, MINIMUM_TICKS, ActiveBehaviour(), choice)
        self.critic = Critic(self.system, critic)
        self.agreement = Agreement(critic.agreement, critic.values, PERIOD_S)
        self.agreement.replay(events)
        self.self_teaching = SelfTeaching(self.reinforcement, self.system, critic, self.agreement, PERIOD_S)
        self.self_teaching.restore(events, saved)
        self.school = CommandHandler(
            self.level,
            ControlAuthority(actions, attended=False),
            insert_radius_fraction=SHARE,
            handled_command_ids=(event.origin.command_id for event in events),
            parts=HandlerParts(
                reinforcement=self.reinforcement,
                critic=self.critic,
                agreement=self.agreement,
                self_teaching=self.self_teaching,
            ),
        )
        self.school.phase = phase
        self.events = list(events)
        self.learnt: list[TeachingEvent] = []
        """Of the last call of `go`."""
        self.tick = 0
        self._commands = 0

    def go(
        self, place: float, ticks: int = 1, seen: AppraisalFeatures = CALM, because: DecisionCause | None = None
    ) -> Decision:
        """So many ticks in one place; returns the last decision."""
        self.learnt = []
        for _ in range(ticks):
            self.tick += 1
            opinion = self.critic.appraise(self.tick, seen)
            decision = self.level.decide(situation(place), sensed(), because)
            self.recent.add(self.tick, situation(place), decision, circumstances=seen, opinion=opinion)
            self.learnt += self.school.updater.learn_from_tick(self.school.phase, self.tick, decision, opinion)
        self.events += self.learnt
        return decision

    def say(self, command: Command, place: float = 0.0) -> CommandResult:
        """Run one tick with a command."""
        assert not isinstance(command, Stream)
        result, events = self.school.handle(command, situation(place), self.tick + 1)
        self.events.extend(events)
        return result

    def signal(self, value: int, about: int | None = None) -> RlaRewarded:
        """Give a reward of +1 or -1 and return its event."""
        self._commands += 1
        result = self.say(Reward(f"signal-{self._commands}", "Ann", value, about))
        assert result.accepted, result.outcome
        event = self.events[-1]
        assert isinstance(event, RlaRewarded)
        return event

    def value(self, rla_id: int) -> float:
        return self.reinforcement.value(rla_id)

    @property
    def actions(self) -> dict[int, str]:
        """Return the actions of the active basic-level RLAs."""
        return {rla.rla_id: rla.action for rla in self.system.rlas}

    @property
    def hash(self) -> str:
        return self.system.knowledge_hash()


def deleted_ids(events: list[TeachingEvent]) -> list[int]:
    return [event.rla_id for event in events if isinstance(event, RlaDeleted)]

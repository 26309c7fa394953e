"""ScriptedDispatcher: answers, corrections and commands at junctions."""

from behaviors.metrics.task_metric import WayAhead
from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import Decision, DecisionCause, JunctionEvent, MidDecision
from kurt2rt.core.rla.rla import BASIC, MID, Phase
from kurt2rt.core.task_settings import TeacherSettings
from kurt2rt.core.teaching.commands import Command, Correct, Pursue, Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.teacher.scripted.dispatcher import ScriptedDispatcher
from kurt2rt.teacher.scripted.press_times import FixedTimes
from tests.teacher.scripted.test_teacher import record_of

NAME = "scripted teacher"
BEHAVIOURS = ("straight_on", "turn_left", "turn_right")
REACTION_TICKS, PATIENCE_TICKS, NOTICES_WITHIN_TICKS = 100, 50, 300
PASSED = JunctionEvent(0, left_open=True, right_open=False, turn_rad=0.0, way_m=1.0)
BEFORE_THE_FIRST = WayAhead(0, False, "turn_left", "straight_on")
IN_THE_FIRST = BEFORE_THE_FIRST._replace(inside=True)
BEHIND_THE_FIRST = WayAhead(1, False, "straight_on", "turn_right")


def dispatcher(phase: Phase = Phase.CORRECTIONS, *, error_rate: float = 0.0) -> ScriptedDispatcher:
    settings = TeacherSettings(reaction_s=1.0, patience_s=0.5, error_rate=error_rate)
    person = ScriptedDispatcher(BEHAVIOURS, FixedTimes(settings, 0.01), period_s=0.01, seed=1, session="s")
    person.phase = phase
    return person


def record(mid: MidDecision, *, drives: bool = True) -> TickRecord:
    cause = DecisionCause.RLA if drives else DecisionCause.UNKNOWN
    asks_at = MID if mid.asks else BASIC
    decision = Decision(STANDSTILL, cause, "forward" if drives else None, None, None, asks_at=asks_at, mid=mid)
    return record_of(decision)


def wants(behaviour: str, *, event: JunctionEvent | None = None, overridden: bool = False) -> TickRecord:
    return record(MidDecision(behaviour, 1, None, asks=False, overridden=overridden, event=event))


ASKS = record(MidDecision("straight_on", None, None, asks=True, overridden=False, event=None), drives=False)


def said(person: ScriptedDispatcher, seen: TickRecord, ahead: WayAhead, ticks: int) -> list[tuple[int, Command]]:
    """Return (tick, command) for each command given in `ticks` equal ticks."""
    heard = [(tick, person.on_tick(seen, ahead)) for tick in range(1, ticks + 1)]
    return [(tick, command) for tick, command in heard if command is not None]


def test_on_tick_wrong_behaviour_is_corrected_after_the_patience() -> None:
    corrections = said(dispatcher(), wants("turn_right"), BEFORE_THE_FIRST, PATIENCE_TICKS)
    assert corrections == [(PATIENCE_TICKS, Correct("s-mid-1", NAME, "turn_left", level=MID))]


def test_on_tick_corrects_after_the_junction_is_noticed() -> None:
    person = dispatcher()
    assert said(person, wants("turn_left"), IN_THE_FIRST, 200) == []
    assert (
        said(person, wants("turn_left"), BEHIND_THE_FIRST, 2 * PATIENCE_TICKS) == []
    )  # the situation is still that of the first junction
    assert person.on_tick(wants("turn_right", event=PASSED), BEHIND_THE_FIRST) is None
    corrections = said(person, wants("turn_right"), BEHIND_THE_FIRST, PATIENCE_TICKS)
    assert [command for _, command in corrections] == [Correct("s-mid-1", NAME, "straight_on", level=MID)]


def test_on_tick_junction_noticed_early_counts() -> None:
    person = dispatcher()
    assert said(person, wants("turn_left"), IN_THE_FIRST, 200) == []
    assert person.on_tick(wants("straight_on", event=PASSED), IN_THE_FIRST) is None
    assert said(person, wants("straight_on"), IN_THE_FIRST, 2 * PATIENCE_TICKS) == []
    assert said(person, wants("straight_on"), BEHIND_THE_FIRST, 2 * NOTICES_WITHIN_TICKS) == []


def test_on_tick_missed_junction_is_commanded_not_taught() -> None:
    person = dispatcher()
    said(person, wants("turn_left"), IN_THE_FIRST, 10)
    commands = said(person, wants("turn_left"), BEHIND_THE_FIRST, NOTICES_WITHIN_TICKS + 10)
    assert [command for _, command in commands][:1] == [Pursue("s-mid-1", NAME, "straight_on")]
    assert commands[0][0] == NOTICES_WITHIN_TICKS
    assert person.missed == 1


def test_answers_with_errors_name_another_behaviour() -> None:
    answers = said(dispatcher(error_rate=1.0), ASKS, BEFORE_THE_FIRST, 50 * REACTION_TICKS)
    named = {command.action for _, command in answers if isinstance(command, Teach)}
    assert named == {"straight_on", "turn_right"}

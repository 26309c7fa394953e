"""Phase 5: signals of the critic, and rollback of its changes."""

from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.autonomy import Autonomy, RollbackMonitor
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.critic.settings import ActivationSettings, AgreementSettings, RollbackSettings, SignalEverySettings
from kurt2rt.core.rla.events import (
    ActionReplaced,
    Appraised,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    SessionBegun,
    TeachingEvent,
)
from kurt2rt.core.rla.rla import CRITIC, Phase, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.critic.helpers import SETTINGS, appraisal, origin
from tests.examples import examples

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


def best(margin: float = 0.2) -> RollbackMonitor:
    """Return a monitor with windows of ten ticks."""
    return RollbackMonitor(RollbackSettings(window_s=0.1, margin=margin), 0.01)


def window(kept: RollbackMonitor, good: int, tick: int = 0) -> tuple[LessonUndone, ...]:
    """Ten ticks of driving, so many of them good and the others neutral."""
    undone: tuple[LessonUndone, ...] = ()
    for place in range(10):
        assert not undone
        undone = kept.update(tick + place, 1 if place < good else None, True)
    return undone


def created(rla_id: int, command_id: str, teacher: str = CRITIC) -> RlaCreated:
    by = origin(command_id, teacher, Phase.AUTONOMOUS)
    return RlaCreated(Rla(rla_id, (float(rla_id),), "forward", None, by))


def replaced(rla_id: int, command_id: str, teacher: str = CRITIC) -> ActionReplaced:
    return ActionReplaced(rla_id, "back", "forward", origin(command_id, teacher, Phase.AUTONOMOUS))


def test_rollback_worse_window_undoes_newest_first() -> None:
    kept = best()
    assert window(kept, good=8) == ()
    for event in (created(1, "first"), replaced(1, "second"), created(2, "third")):
        kept.on_event(event)
    undone = window(kept, good=5, tick=990)
    assert [each.lesson for each in undone] == ["third", "second", "first"]
    assert {each.origin.teacher for each in undone} == {CRITIC}
    assert {each.origin.phase for each in undone} == {Phase.AUTONOMOUS}
    assert {each.origin.tick for each in undone} == {999}
    assert len({each.origin.command_id for each in undone}) == 3


def test_rollback_standstill_does_not_count() -> None:
    kept = best()
    for tick in range(1000):
        assert kept.update(tick, -1, False) == ()
    assert kept.score is None
    window(kept, good=3)
    assert kept.score == 0.3


def test_rollback_skips_lessons_undone_by_hand() -> None:
    kept = best()
    window(kept, good=9)
    kept.on_event(created(1, "first"))
    kept.on_event(created(2, "second"))
    kept.on_event(LessonUndone("second", origin()))
    kept.on_event(LessonRedone("second", origin()))  # by hand, too: a person wants it
    kept.on_event(SessionBegun("monday", origin()))
    assert [each.lesson for each in window(kept, good=0)] == ["first"]


def test_rollback_keeps_lessons_below_a_teachers() -> None:
    kept = best()
    window(kept, good=9)
    kept.on_event(created(1, "first"))
    kept.on_event(created(2, "second"))
    kept.on_event(replaced(1, "by ada", teacher="ada"))
    assert [each.lesson for each in window(kept, good=0)] == ["second"]


def test_rollback_restore_continues_from_best_window() -> None:
    kept = best()
    events: list[TeachingEvent] = [
        created(1, "proven"),
        created(2, "late"),
        created(3, "undone"),
        LessonUndone("undone", origin()),
    ]
    kept.on_event(events[0])
    window(kept, good=8)
    for event in events[1:]:
        kept.on_event(event)
    assert (kept.best, kept.includes) == (0.8, 1)
    again = best()
    again.restore(events, kept.best, kept.includes)
    assert again.is_measuring
    assert [each.lesson for each in window(again, good=2)] == ["late"]


Act = tuple[str, int]


@given(
    windows=st.lists(
        st.tuples(
            st.lists(
                st.tuples(st.sampled_from(("create", "replace", "delete", "teach", "undo")), st.integers(0, 5)),
                max_size=6,
            ),
            st.integers(0, 10),
        ),
        max_size=12,
    )
)
@examples(150)
def test_rollback_random_events_undos_fit(windows: list[tuple[list[Act], int]]) -> None:
    kept, knowledge = best(margin=0.1), RlaSystem(1, 1.0)
    commands = 0

    def happens(event: TeachingEvent) -> None:
        knowledge.apply(event)
        kept.on_event(event)

    for acts, good in windows:
        for act, which in acts:
            commands += 1
            name, living = f"command-{commands}", knowledge.rlas
            by = origin(name, "ada" if act == "teach" else CRITIC, Phase.AUTONOMOUS)
            if act == "create" or not living:
                happens(RlaCreated(Rla(knowledge.next_id, (float(commands),), "forward", None, by)))
                continue
            rla = living[which % len(living)]
            if act == "delete":
                happens(RlaDeleted(rla.rla_id, by))
            elif act == "undo":
                last = knowledge.history.last_standing
                if last is not None:
                    happens(LessonUndone(last, by))
            else:
                happens(ActionReplaced(rla.rla_id, name, rla.action, by))
        for undone in window(kept, good):
            happens(undone)  # raises where it does not fit

"""The mind of two screens (docs/examples/mini.py) decides in each tick of ten lessons as the real one does."""

import re
import runpy
from collections.abc import Iterator
from contextlib import closing, nullcontext
from pathlib import Path

import anyio
import numpy as np
import pytest
from numpy.typing import NDArray

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.rla.events import ActionReplaced, RlaCreated
from kurt2rt.core.task_settings import taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.core.teaching.commands import Correct, Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.lesson import TrainingRun
from kurt2rt.experiments.lockstep.lesson_plan import plan_of
from kurt2rt.experiments.lockstep.runtimes import TrainingStore, build_training_runtime
from tests.experiments.helpers import ROBOT, STAGE, short_task

MINI = runpy.run_path(str(Path(__file__).parents[1] / "docs" / "examples" / "mini.py"))
# The quickest scripted teacher, whose presses mean the present, with a robot that asks as soon as for a person.
TASK = taught_by(short_task(6.0, 6.0), load_teacher("superhuman").model_copy(update={"ask_radius_fraction": None}))


class Comparison(TrainingRun):
    """A lesson whose readings and presses the small mind gets as well."""

    def begin(self) -> None:
        self.mind, self.senses = MINI["Mind"](), MINI["Senses"]()
        self.situations: dict[int, NDArray[np.float64]] = {}
        self.waits, self.known_ticks, self.taught = True, 0, 0

    def on_tick(self, record: TickRecord) -> None:
        if record.decision.cause is not DecisionCause.BLIND:
            self._compare(record)
        super().on_tick(record)

    def _compare(self, record: TickRecord) -> None:
        situation = self.senses.situation(record.readings.infrared_counts, waits=self.waits)
        assert (situation == record.situation.vector).all(), record.tick
        self.situations[record.tick] = situation
        lessons = [each for each in record.events if isinstance(each, RlaCreated | ActionReplaced)]
        presses = [each for each in record.commands if isinstance(each, Teach | Correct)]
        for press, event in zip(presses, lessons, strict=False):
            self._teach(press, event, record.tick)
        decided, real = self.mind.decide(situation), record.decision
        assert (decided.rule, decided.action) == (real.rla_id, real.action or "stand"), record.tick
        if real.match is not None:
            assert decided.distance == real.match.distance
        self.waits = decided.rule is None
        self.known_ticks += not self.waits

    def _teach(self, press: Teach | Correct, event: RlaCreated | ActionReplaced, tick: int) -> None:
        meant = self.situations[tick if press.decision_tick is None else press.decision_tick]
        rule = self.mind.teach(meant, press.action, corrects=isinstance(press, Correct))
        number = event.rla.rla_id if isinstance(event, RlaCreated) else event.rla_id
        assert (rule.number, rule.action) == (number, press.action)
        self.taught += 1


@pytest.mark.parametrize("seed", range(1, 11))
def test_mini_decides_as_the_real_mind_in_a_lesson(seed: int) -> None:
    store = InMemoryEventStore()
    with closing(STAGE.open("a", seed, "lesson")) as simulation:
        runtime = build_training_runtime(simulation, ROBOT, TASK, TrainingStore(store))
        lesson = Comparison(simulation, runtime, plan_of(TASK), seed=seed, session="mini", on_progress=lambda _: None)
        lesson.begin()
        anyio.run(lesson.drive)
    assert lesson.taught == len(store.events) > 2
    assert lesson.known_ticks > 500


def test_mini_is_taught_at_the_keyboard(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def keys() -> Iterator[str]:
        yield "w"  # at the first question
        yield from [""] * 50
        yield "d"  # corrects it on the way
        raise KeyboardInterrupt

    pressed = keys()
    names = MINI["main"].__globals__
    monkeypatch.setitem(names, "keyboard", nullcontext)
    monkeypatch.setitem(names, "key", lambda **_wait: next(pressed))
    monkeypatch.setattr("time.sleep", lambda _s: None)
    with pytest.raises(KeyboardInterrupt):
        MINI["main"]()
    assert re.findall(r"rule .*|I do not know this|front \d+ cm", capsys.readouterr().out) == [
        "front 60 cm",
        "I do not know this",
        "rule 1: forward",
        "rule 2: curve_right",
    ]

"""Wrong actions, and critics from another set."""

from collections import Counter

from behaviors.repertoire import primitive_speeds
from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.settings import NAMES, load_critic
from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.events import ActionReplaced, Appraised, RlaCreated, TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, Origin, Phase, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.phases.steps import Step, corrupt, critic_lessons, shuffled, steps_of

PERIOD_S = 0.01

SETTINGS = load_critic()


def origin(name: str) -> Origin:
    return Origin(name, "Ann", Phase.CORRECTIONS, 1)


def taught(rla_id: int, action: str, level: str = "basic") -> RlaCreated:
    condition = (float(rla_id),) * (1 if level == "basic" else len(NAMES))
    return RlaCreated(Rla(rla_id, condition, action, None, origin(f"t{rla_id}"), level=level))


def system(*events: TeachingEvent) -> RlaSystem:
    made = RlaSystem(1, 900.0, others={CRITIC: Space(len(NAMES), 1.0, None)})
    made.apply_all(events)
    return made


SET = [taught(number, "forward") for number in range(1, 51)]
CRITICS = [
    *(taught(number, "bad", CRITIC) for number in range(60, 70)),
    *(taught(number, "good", CRITIC) for number in range(70, 100)),
]


def test_corrupt_differs_by_purpose() -> None:
    rlas, steps = system(*SET).rlas, {step.name: step for step in steps_of(load_task("wall_following"))}

    def wrong_at(name: Step, seed: int) -> set[tuple[int, str]]:
        step = steps[name]
        wrong = corrupt(rlas, tuple(primitive_speeds("basic")), step.corrupted, seed, step.mistakes)
        return {(each.rla_id, each.action) for each in wrong}

    for seed in range(20):
        shown, examined = wrong_at(Step.PHASE_4, seed), wrong_at(Step.CRITIC_ALONE, seed)
        assert len(shown) == len(examined) == 9
        assert len(shown & examined) <= 1  # what little is alike is so by chance
        assert examined == wrong_at(Step.SHUFFLED, seed) == wrong_at(Step.REWARDS, seed)


def test_critic_lessons_carry_its_agreement() -> None:
    corrected = ActionReplaced(60, "good", "bad", origin("c"))
    agreed = Appraised("good", 1, 5, origin("a"))
    history: list[TeachingEvent] = [
        *SET,
        *CRITICS,
        corrected,
        ActionReplaced(1, "back", "forward", origin("r")),
        agreed,
    ]
    lessons = list(critic_lessons(history))
    assert lessons == [*CRITICS, corrected, agreed]
    there = system(*SET, *lessons)
    assert [rla.action for rla in there.rlas_at(CRITIC)] == ["good", *["bad"] * 9, *["good"] * 30]
    assert {rla.action for rla in there.rlas} == {"forward"}


def test_shuffled_critic_keeps_opinions_and_trust() -> None:
    appraisals = system(*SET, *CRITICS).rlas_at(CRITIC)
    lessons = list(shuffled(appraisals, SETTINGS, seed=3, period_s=PERIOD_S))
    dealt = system(*SET, *lessons).rlas_at(CRITIC)
    assert [rla.condition for rla in dealt] == [rla.condition for rla in appraisals]
    assert Counter(rla.action for rla in dealt) == Counter(rla.action for rla in appraisals)
    assert [rla.action for rla in dealt] != [rla.action for rla in appraisals]
    agreement = Agreement(SETTINGS.agreement, SETTINGS.values, PERIOD_S)
    agreement.replay(lessons)
    assert agreement.trusted

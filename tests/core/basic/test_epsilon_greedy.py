"""Which competitor answers."""

from collections import Counter

from kurt2rt.core.basic.epsilon_greedy import EpsilonGreedy
from kurt2rt.core.rla.rla import ASK, Rla
from tests.core.rla.helpers import created, origin

HOLD = 100


def competitors(*actions: str) -> tuple[Rla, ...]:
    made = (created(rla_id, (0.0,), action).rla for rla_id, action in enumerate(actions, 1) if action != ASK)
    asking = (Rla(rla_id, (0.0,), ASK, None, origin()) for rla_id, action in enumerate(actions, 1) if action == ASK)
    return tuple(sorted((*made, *asking), key=lambda rla: rla.rla_id))


class Worths(dict[int, float]):
    """Worths by id, 0 for the others."""

    def __missing__(self, rla_id: int) -> float:
        return 0.0


def choice(worths: Worths, epsilon: float = 0.0, seed: int = 0, *, explores: bool = True) -> EpsilonGreedy:
    made = EpsilonGreedy(worths.__getitem__, epsilon=epsilon, hold_ticks=HOLD, seed=seed)
    made.explores = explores
    return made


def test_best_value_answers_and_of_equals_the_newest() -> None:
    group = competitors("a", "b", "c")
    assert choice(Worths({2: 0.4, 3: 0.1})).choose(group, 1).rla_id == 2
    assert choice(Worths()).choose(group, 1).rla_id == 3


def test_choice_holds_until_its_group_was_not_nearest() -> None:
    worths = Worths({1: 0.5})
    group = competitors("a", "b")
    chosen = choice(worths)
    assert chosen.choose(group, 1).rla_id == 1
    worths[2] = 0.9
    for tick in range(2, 1002):
        assert chosen.choose(group, tick).rla_id == 1
    assert chosen.choose(group, 1001 + HOLD).rla_id == 1
    assert chosen.choose(group, 1001 + HOLD + HOLD + 1).rla_id == 2


def test_blame_makes_all_groups_choose_anew() -> None:
    worths = Worths({1: 0.5})
    group = competitors("a", "b")
    chosen = choice(worths)
    chosen.choose(group, 1)
    worths[1] = -0.5
    chosen.reset()
    assert chosen.choose(group, 2).rla_id == 2


def test_one_that_was_deleted_is_not_held() -> None:
    worths = Worths({2: 0.5})
    chosen = choice(worths)
    assert chosen.choose(competitors("a", "b", "c"), 1).rla_id == 2
    left = (competitors("a", "b", "c")[0], competitors("a", "b", "c")[2])
    assert chosen.choose(left, 2).rla_id == 3


def test_one_whose_action_was_withdrawn_does_not_compete() -> None:
    assert choice(Worths({2: 0.9})).choose(competitors("a", ASK, "c"), 1).rla_id == 3


def picks(seed: int, epsilon: float, *, explores: bool = True) -> list[int]:
    chosen = choice(Worths({1: 0.5}), epsilon, seed, explores=explores)
    group = competitors("a", "b", "c")
    return [chosen.choose(group, tick * 2 * HOLD).rla_id for tick in range(2000)]


def test_now_and_then_chance_chooses_and_the_same_seed_the_same() -> None:
    drawn = picks(1, 0.3)
    counted = Counter(drawn)
    assert 300 < counted[2] + counted[3] < 500  # two thirds of 30 %
    assert drawn == picks(1, 0.3)
    assert drawn != picks(2, 0.3)


def test_while_nothing_is_learnt_chance_has_no_part() -> None:
    assert set(picks(1, 0.3, explores=False)) == {1}

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

"""Knowledge of a batch as arrays, and the refusal of what the batch does not know."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from behaviors.policies.circle import Circle
from behaviors.policies.eight import Eight
from behaviors.policies.fleeing import Fleeing
from behaviors.policies.streets import Streets
from behaviors.policies.wall_following import WallFollowing
from hal.kurt2_settings import Kurt2Settings, SpeedMode
from hal.robot import HIGHEST_COUNTS
from simbridge.batch.decisions import ASKED, CIRCLE, COMMANDED, EIGHT, FLEEING, KNOWLEDGE, STREETS, WALL_FOLLOWING
from simbridge.batch.laws import Averages, Conditions, Features, Floats, Integers, Knowledge
from simbridge.batch.matching import LANES
from simbridge.batch.record import MOST_VALUES
from simbridge.contracts.batch import (
    BatchRefusedError,
    CallbackMind,
    CommandedMind,
    DriveSettings,
    FeatureTable,
    Mind,
    PolicyMind,
    TaughtMind,
)
from simbridge.simulated_robot import SimulatedKurt2

_POLICIES = {WallFollowing: WALL_FOLLOWING, Fleeing: FLEEING, Circle: CIRCLE, Eight: EIGHT, Streets: STREETS}
_MOST_NEIGHBOURS = 128
"""Neighbours of a condition that are kept, so that thousands of RLAs need no square of their number."""
_PARTS, _MOST_COUNTS = 64, 2**14
"""Numbers of this part of a count, up to so many counts: 2 * (14 + 1 + 6) bits for a square, and 7 for the sum."""
_NO_FEATURES = FeatureTable((), (), (), 1)


def kind_of(mind: Mind) -> int:
    """Return the number by which the compiled loop knows a kind of mind (simbridge.batch.decisions)."""
    match mind:
        case TaughtMind():
            return KNOWLEDGE
        case CommandedMind():
            return COMMANDED
        case CallbackMind():
            return ASKED
    return _POLICIES[type(mind.policy)]


def require_known(
    robot: Kurt2Settings, simulated: Sequence[SimulatedKurt2], minds: Sequence[Mind], settings: DriveSettings
) -> None:
    """Check that the batch knows all that decides a drive. Raises BatchRefusedError."""
    if len(simulated) != len(minds) or not minds:
        raise BatchRefusedError(f"{len(simulated)} robots and {len(minds)} minds", do="give one mind for each robot")
    if robot.can.speed_mode is not SpeedMode.SPEED_CM:
        raise BatchRefusedError(f"speed mode {robot.can.speed_mode}: the batch knows SPEED_CM", do=ON_THE_BUS)
    if any(each.time_s for each in simulated):
        raise BatchRefusedError("a robot has driven already", do="open a fresh simulation")
    policies = {mind.policy for mind in minds if isinstance(mind, PolicyMind)}
    for policy in policies:
        if type(policy) not in _POLICIES:
            raise BatchRefusedError(f"policy {type(policy).__name__}: the batch does not know it", do=ON_THE_BUS)
    if len({(type(policy), getattr(policy, "thresholds", None)) for policy in policies}) > 1:
        raise BatchRefusedError("two policies in one batch", do="give each task a batch of its own")
    tables = {mind.features for mind in minds if isinstance(mind, TaughtMind | CallbackMind)}
    if len(tables) > 1:
        raise BatchRefusedError("two situations in one batch", do="give each task a batch of its own")
    for table in tables:
        require_features(table)
    _require_actions(minds, settings)


ON_THE_BUS = "drive it on the CAN bus"


def require_features(table: FeatureTable) -> None:
    """Check that the batch adds the squares of a situation in the order of numpy. Raises BatchRefusedError."""
    values = 2 * len(table.kinds)
    if values > MOST_VALUES:
        raise BatchRefusedError(f"a situation has at most {MOST_VALUES // 2} features in a batch", do=ON_THE_BUS)
    if table.average_weights and values % LANES:
        raise BatchRefusedError(
            f"averages of {len(table.kinds)} features count in a distance (a batch knows multiples of {LANES // 2})",
            do=ON_THE_BUS,
        )


def _require_actions(minds: Sequence[Mind], settings: DriveSettings) -> None:
    for mind in minds:
        unknown = sorted(set(_actions_of(mind)) - set(settings.actions))
        if unknown:
            raise BatchRefusedError(f"action {', '.join(unknown)}: the batch does not know it", do=ON_THE_BUS)


def _actions_of(mind: Mind) -> Sequence[str]:
    """Return the actions that a mind may choose; none for a commanded one, whose commands are indexes."""
    match mind:
        case TaughtMind():
            return mind.actions
        case PolicyMind():
            return mind.policy.actions
    return ()


def build_knowledge(minds: Sequence[Mind], actions: Sequence[str], python_mind: int) -> tuple[Knowledge, list[int]]:
    """Return the RLAs of all taught minds, and the first table of each robot; -1 for a robot without RLAs.

    Each behaviour has a table. Robots that share a mind share its tables. `python_mind`: address of the PythonMind.
    """
    taught: dict[int, tuple[int, TaughtMind]] = {}
    of, tables = [], 0
    for mind in minds:
        if isinstance(mind, TaughtMind):
            table, _ = taught.setdefault(id(mind), (tables, mind))
            tables = max(tables, table + len(mind.sizes))
            of.append(table)
        else:
            of.append(-1)
    known = [mind for _, mind in taught.values()]
    perceiving = [mind.features for mind in minds if isinstance(mind, TaughtMind | CallbackMind)]
    features = perceiving[0] if perceiving else _NO_FEATURES
    values = len(features.kinds) + len(features.average_weights)
    sizes = [size for mind in known for size in mind.sizes]
    first = np.concatenate(([0], np.cumsum(sizes))).astype(np.int64)
    rows = int(first[-1])
    conditions = np.zeros((rows, padded_width(features)))
    answer = np.zeros(rows, dtype=np.int64)
    for table, mind in taught.values():
        start = int(first[table])
        end = start + len(mind.rla_ids)
        conditions[start:end, :values] = np.array(mind.conditions).reshape(end - start, values)
        answer[start:end] = np.array(mind.answers, dtype=np.int64) + start
    place = {name: index for index, name in enumerate(actions)}
    steps = (*features.weights, *(weight / features.average_steps for weight in features.average_weights))
    knowledge = Knowledge(
        first=first,
        conditions=build_conditions(conditions, first, steps),
        radius=np.array([radius for mind in known for radius in mind.radii], dtype=np.float64),
        answer=answer,
        action=np.array([place[name] for mind in known for name in mind.actions], dtype=np.int64),
        features=build_features(features),
        mind=python_mind,
    )
    return knowledge, of


def build_conditions(values: Floats, first: Integers, steps: Sequence[float]) -> Conditions:
    """Return conditions with their neighbours.

    Args:
        values: weighted conditions in counts, (rows, values).
        first: first row of each table, and the end of the last one, (tables + 1,).
        steps: in counts by which each value may change; those of averages are no whole parts.
    """
    most = min(_MOST_NEIGHBOURS, int(np.diff(first).max(initial=0)))
    neighbours = np.zeros((len(values), most), dtype=np.int64)
    apart = np.full((len(values), most), np.inf)
    for begin, end in pairwise(first.tolist()):
        for row in range(begin, end):
            away = np.sqrt(np.square(values[begin:end] - values[row]).sum(axis=1))
            away[row - begin] = -1.0  # before its equals
            order = np.argsort(away, kind="stable")[:most]
            neighbours[row, : len(order)] = order + begin
            apart[row, : len(order)] = away[order]
    changes = np.array(steps)
    return Conditions(values, neighbours, apart, all(map(_is_whole, (values, changes, changes * HIGHEST_COUNTS))))


def _is_whole(numbers: Floats) -> bool:
    """Return whether no sum of 128 squares of differences of such numbers, in counts, needs more than 53 bits."""
    return bool((numbers * _PARTS == np.rint(numbers * _PARTS)).all() and (abs(numbers) <= _MOST_COUNTS).all())


def build_features(table: FeatureTable) -> Features:
    """Return the recent features of a situation as arrays."""
    most = max((len(each) for each in table.sensors), default=1)
    sensors = np.zeros((len(table.kinds), most), dtype=np.int64)
    for row, places in enumerate(table.sensors):
        sensors[row, : len(places)] = places
    return Features(
        kind=np.array(table.kinds, dtype=np.int64),
        sensors=sensors,
        sensor_count=np.array([len(each) for each in table.sensors], dtype=np.int64),
        weights=np.array(table.weights, dtype=np.float64),
        average_steps=table.average_steps,
        average_weights=np.array(table.average_weights, dtype=np.float64),
    )


def padded_width(table: FeatureTable) -> int:
    """Return the number of values of a weighted condition in the arrays, which is a multiple of eight.

    Zeros fill it up, so that the compiler can add eight squares at once.
    """
    return -(-(len(table.kinds) + len(table.average_weights)) // LANES) * LANES


def empty_averages(robots: int, features: Features) -> Averages:
    """Return the averages of robots that have not driven yet; without room for any where they count for nothing."""
    width = len(features.average_weights)
    count, steps = (robots, features.average_steps) if width else (0, 0)
    return Averages(
        ring=np.zeros((count, steps, width), dtype=np.int16),
        sums=np.zeros((count, width), dtype=np.int64),
        newest=np.zeros(count, dtype=np.int64),
    )

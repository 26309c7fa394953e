"""The shortest story that breaks as a long one did: fewer faults, shorter ones, a plainer robot."""

import re
from collections.abc import Awaitable, Callable, Iterator

from tests.stories.story import CALM_S, Event, Story
from tests.stories.table import TABLE

Breaks = Callable[[Story], Awaitable[str]]
"""Drives a story and returns its first problem; empty without one."""

_SEEDS = 3
"""Seeds of each smaller story: what is left out changes all that chance decides after it."""
_MOST_TRIED = 80
_BEGINS_S, _GAP_S = 3.0, 1.0
"""Time before the first fault, and between two, of a story without long waits."""
_SHORTEST_S = 0.05
_TRAITS = ("task", "world", "taught", "records", "points", "teaching")
"""Fields that make a story plainer when they have their default, in the order in which that is tried."""
_OF_ONE_STORY = re.compile(r"/\S+|[\d.]+")


def kind_of(problem: str) -> str:
    """Return a problem without its numbers and paths, which differ from story to story."""
    return _OF_ONE_STORY.sub("#", problem)


async def shrunk(story: Story, breaks: Breaks) -> Story:
    """Return the smallest story found whose problem is of the same kind; its seed may differ.

    Delta debugging over the faults (Zeller and Hildebrandt, 2002), then one change after another while one helps.
    """
    problem, first = kind_of(await breaks(story)), story.seed
    tried = {story}

    async def broken(smaller: Story) -> Story | None:
        """Return the smaller story, perhaps with another seed, if it breaks."""
        smaller = _with(smaller, seed=first)
        if smaller in tried or len(tried) >= _MOST_TRIED:
            return None
        tried.add(smaller)
        for seed in range(first, first + _SEEDS):
            each = _with(smaller, seed=seed)
            if kind_of(await breaks(each)) == problem:
                return each
        return None

    async def first_broken(smaller: Iterator[Story]) -> Story | None:
        """Return the first of these stories that breaks."""
        for each in smaller:
            if (found := await broken(each)) is not None:
                return found
        return None

    parts = 2
    while parts <= 2 * len(story.faults):
        found = await first_broken(_with_parts_left_out(story, parts))
        story, parts = (story, parts * 2) if found is None else (found, 2)
    while (found := await first_broken(_smaller(story))) is not None:
        story = found
    return story


def _with(story: Story, **changes: object) -> Story:
    return story.model_copy(update=changes)


def _with_parts_left_out(story: Story, parts: int) -> Iterator[Story]:
    """Yield the story without waits, and without each of so many parts of its faults."""
    yield _without_waits(story)
    size = max(1, len(story.faults) // parts)
    for begin in range(0, len(story.faults), size):
        yield _without_waits(_with(story, faults=story.faults[:begin] + story.faults[begin + size :]))


def _without_waits(story: Story) -> Story:
    """Return a story whose faults come soon after each other, and that ends soon after them."""
    faults: list[Event] = []
    over_s, earlier_s = _BEGINS_S - _GAP_S, 0.0
    for each in story.faults:
        earlier_s = max(earlier_s, each.at_s - over_s - _GAP_S)
        faults.append(each.model_copy(update={"at_s": round(each.at_s - earlier_s, 3)}))
        over_s = max(over_s, faults[-1].at_s + each.lasts_s)
    return _with(story, faults=tuple(faults), lasts_s=min(story.lasts_s, round(over_s + CALM_S, 3)))


def _smaller(story: Story) -> Iterator[Story]:
    """Yield stories with one thing less."""
    yield _without_waits(story)
    plain = Story(seed=story.seed, lasts_s=story.lasts_s)
    if story.robot != plain.robot:
        faults = tuple(each for each in story.faults if TABLE.has(plain.robot, each.target))
        yield _with(story, robot=plain.robot, faults=faults)
    for name in _TRAITS:
        if getattr(story, name) != getattr(plain, name):
            yield _with(story, **{name: getattr(plain, name)})
    for point in story.points:
        yield _with(story, points=tuple(each for each in story.points if each != point))
    for number, event in enumerate(story.faults):
        for lasts_s in (_SHORTEST_S, round(event.lasts_s / 2, 3)):
            if _SHORTEST_S <= lasts_s < event.lasts_s:
                shorter = event.model_copy(update={"lasts_s": lasts_s})
                yield _with(story, faults=(*story.faults[:number], shorter, *story.faults[number + 1 :]))
    for number in range(len(story.faults)):
        yield _with(story, faults=story.faults[:number] + story.faults[number + 1 :])

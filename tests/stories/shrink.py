"""The shortest story that breaks as a long one did: fewer faults, shorter ones, a plainer robot."""

import re
from collections.abc import Awaitable, Callable, Iterator

from tests.stories.story import CALM_S, Event, Story

Breaks = Callable[[Story], Awaitable[str]]
"""Drives a story and returns its first problem; empty without one."""

_SHORTEST_S = 0.02
_TRAITS = ("task", "world", "taught", "records", "points", "teaching")
"""Fields that make a story plainer when they have their default, in the order in which that is tried."""
_NUMBER = re.compile(r"[\d.]+")


def kind_of(problem: str) -> str:
    """Return a problem without its numbers, which differ from story to story."""
    return _NUMBER.sub("#", problem)


async def shrunk(story: Story, breaks: Breaks) -> Story:
    """Return the smallest story found whose problem is of the same kind.

    Delta debugging over the faults (Zeller and Hildebrandt, 2002), then one change after another while one helps.
    """
    problem = kind_of(await breaks(story))

    tried: set[Story] = set()

    async def still(smaller: Story) -> bool:
        if smaller in tried:
            return False
        tried.add(smaller)
        return kind_of(await breaks(smaller)) == problem

    parts = 2
    while len(story.faults) > 1:
        size = max(1, len(story.faults) // parts)
        for begin in range(0, len(story.faults), size):
            rest = story.faults[:begin] + story.faults[begin + size :]
            smaller = story.model_copy(update={"faults": rest})
            if await still(smaller):
                story, parts = smaller, 2
                break
        else:
            if size == 1:
                break
            parts *= 2
    helped = True
    while helped:
        helped = False
        for smaller in _smaller(story):
            if await still(smaller):
                story, helped = smaller, True
                break
    return story


def _smaller(story: Story) -> Iterator[Story]:
    """Yield stories with one thing less."""
    shorter_s = round(story.over_s + CALM_S, 3)
    if story.faults and shorter_s < story.lasts_s:
        yield story.model_copy(update={"lasts_s": shorter_s})
    plain = Story(seed=story.seed, lasts_s=story.lasts_s)
    for name in _TRAITS:
        if getattr(story, name) != getattr(plain, name):
            yield story.model_copy(update={name: getattr(plain, name)})
    for point in story.points:
        yield story.model_copy(update={"points": tuple(each for each in story.points if each != point)})
    if story.faults:
        yield story.model_copy(update={"faults": ()})
    for number, event in enumerate(story.faults):
        if event.lasts_s > 2 * _SHORTEST_S:
            half = Event(**(event.model_dump() | {"lasts_s": round(event.lasts_s / 2, 3)}))
            yield story.model_copy(update={"faults": (*story.faults[:number], half, *story.faults[number + 1 :])})

"""Strategies of the values of a type, from the types of its fields."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from enum import Enum
from inspect import signature
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from hypothesis import strategies as st

from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.events import Appraised, RlaCreated, RlaRewarded, TeachingEvent

Known = Callable[[Any], st.SearchStrategy[Any] | None]


def values_of(hint: Any, known: Known) -> st.SearchStrategy[Any]:
    """Return a strategy of all values of a type. `known` is asked first, of each type in it, and may answer None."""
    if (strategy := known(hint)) is not None:
        return strategy
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        return st.one_of([values_of(each, known) for each in inner])
    if origin is Sequence or (origin is tuple and inner[-1] is ...):
        return st.lists(values_of(inner[0], known), max_size=4).map(tuple)
    if origin is tuple:
        return st.tuples(*(values_of(each, known) for each in inner))
    if hint is NoneType:
        return st.none()
    if issubclass(hint, Enum):
        return st.sampled_from(hint)
    hints = get_type_hints(hint, include_extras=True)
    return st.builds(hint, **{name: values_of(hints[name], known) for name in signature(hint).parameters})


FINITE = st.floats(allow_nan=False, allow_infinity=False)
_OF_EVENTS: dict[Any, st.SearchStrategy[Any]] = {
    int: st.integers(1, 2**62),
    float: FINITE,
    str: st.text(st.characters(codec="utf-8"), max_size=20),
    Condition: st.lists(FINITE, max_size=80).map(tuple),
}


def _fitting(event: Any) -> Any:
    """Return the event with numbers that a journal takes."""
    match event:
        case RlaCreated():
            return replace(event, rla=replace(event.rla, image=""))
        case RlaRewarded():
            said = None if event.said is None else event.said % 3 - 1
            return replace(event, value=2 * (event.value % 2) - 1, said=said)
        case Appraised():
            return replace(event, value=event.value % 3 - 1)
    return event


EVENTS = values_of(TeachingEvent, _OF_EVENTS.get).map(_fitting)
"""All teaching events that a journal may hold."""

"""Strategies of the values of a type, from the types of its fields."""

from collections.abc import Callable, Sequence
from enum import Enum
from inspect import signature
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from hypothesis import strategies as st

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

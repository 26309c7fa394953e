"""Learners by name, by `module:Name`, or by the entry points of installed packages."""

from config.errors import UserError
from config.plugin_source import source_hash_of
from config.plugins import PluginError, PluginKind, import_target
from kurt2rt.core.learner.learner import LearnerFactory

_ROOM = "kurt2rt.core.learner"
_BUILTIN = {
    "rla-door": f"{_ROOM}.rla_learner:RlaLearner",
    "1-nn": f"{_ROOM}.neighbours:NearestNeighbour",
    "k-nn": f"{_ROOM}.neighbours:KNearest",
    "weighted-vote": f"{_ROOM}.neighbours:WeightedVote",
    "svm": f"{_ROOM}.scikit:SupportVectors",
    "tree": f"{_ROOM}.scikit:DecisionTree",
}
"""Modules of the learners by their names; a module is imported with its learner only, because it may need an extra."""
_METHODS = ("decide", "lesson", "snapshot", "restore")


def _makes_learners(found: object) -> bool:
    return callable(found) and (not isinstance(found, type) or all(hasattr(found, each) for each in _METHODS))


LEARNERS = PluginKind(
    "learners",
    "learner",
    f"a class with the methods {', '.join(_METHODS)} (kurt2rt.core.learner.learner), or a function that makes one",
    _makes_learners,
    lambda: _BUILTIN,
)


class NoLearnerError(UserError):
    """Name or `module:Name` that leads to no learner, or to one whose package is missing."""


def learner_names() -> tuple[str, ...]:
    """Return the names of all learners of the project and of installed packages."""
    return (*_BUILTIN, *(each.name for each in LEARNERS.installed()))


def find_learner(name: str) -> LearnerFactory:
    """Return the learner of a name, or of `module:Name` in an installed module or one in the current folder.

    Raises NoLearnerError if there is none, or if a package that it needs is not installed.
    """
    try:
        if name in _BUILTIN:
            made = import_target(_BUILTIN[name], f"learner {name}", "pip install '.[studies]' in kurt2rt's folder")
        else:
            made = LEARNERS.find(name)
    except PluginError as error:
        raise NoLearnerError(error.what, where=error.where, do=error.do) from error
    assert callable(made)
    factory: LearnerFactory = made
    return factory


def source_of_learner(name: str) -> str:
    """Return a text that changes with the source of a learner from outside of the program; empty for another one.

    The source of the program is part of every result's provenance anyway. Raises NoLearnerError.
    """
    return source_hash_of(find_learner(name))

"""Learners by name, by `module:Name`, or by the entry points of installed packages."""

import hashlib
import importlib
import inspect
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import entry_points
from pathlib import Path

from hal.errors import UserError
from kurt2rt.core.learner.learner import LearnerFactory
from kurt2rt.experiments.rivals.holds.rows import TARGETS as HOLD_TARGETS
from kurt2rt.experiments.rivals.signals.rows import TARGETS as SIGNAL_TARGETS
from kurt2rt.experiments.study.import_graph import PACKAGES

ENTRY_POINTS = "kurt2rt.learners"
"""Group of entry points by which a package offers learners."""
_ROOM = "kurt2rt.experiments.rivals.learners"
_BUILTIN = {
    "rla-door": "kurt2rt.core.learner.rla_learner:RlaLearner",
    "1-nn": f"{_ROOM}.nearest_neighbour:NearestNeighbour",
    "k-nn": f"{_ROOM}.k_nearest:KNearest",
    "weighted-vote": f"{_ROOM}.weighted_vote:WeightedVote",
    "gp": f"{_ROOM}.gaussian_process:GaussianProcess",
    "svm": f"{_ROOM}.support_vectors:SupportVectors",
    "tree": f"{_ROOM}.decision_tree:DecisionTree",
    "forest": f"{_ROOM}.random_forest:RandomForest",
    "hoeffding": f"{_ROOM}.online_trees:HoeffdingTree",
    "arf": f"{_ROOM}.online_trees:AdaptiveForest",
    "mlp-ensemble": f"{_ROOM}.network_ensemble:NetworkEnsemble",
    **HOLD_TARGETS,
    **SIGNAL_TARGETS,
}
"""Modules of the learners by their names; a module is imported with its learner only, because it may need an extra."""


class NoLearnerError(UserError):
    """Name that leads to no learner."""


def learner_names() -> tuple[str, ...]:
    """Return the names of all learners of the project and of installed packages."""
    return (*_BUILTIN, *sorted(point.name for point in entry_points(group=ENTRY_POINTS)))


def find_learner(name: str) -> LearnerFactory:
    """Return the learner of a name, or of `module:Name` in an installed module or one in the current folder.

    Raises NoLearnerError if there is none, or if a package that it needs is not installed.
    """
    where = f"learner {name}"
    target = _BUILTIN.get(name) or next(
        (point.value for point in entry_points(group=ENTRY_POINTS) if point.name == name), name
    )
    module_name, colon, attribute = target.partition(":")
    if not colon or not attribute:
        raise NoLearnerError(
            "there is no such learner",
            where=where,
            do=f"give module:Name, or one of {', '.join(learner_names())}",
        )
    try:
        with _current_folder_searched():
            made = getattr(importlib.import_module(module_name), attribute, None)
    except ImportError as error:
        do = "pip install 'kurt2rt[rivals]'" if name in _BUILTIN else "give a module that Python finds from this folder"
        raise NoLearnerError(f"cannot be imported: {error}", where=where, do=do) from error
    if not callable(made):
        raise NoLearnerError(
            f"{module_name} has no class {attribute!r}",
            where=where,
            do="name a class that is a Learner",
        )
    factory: LearnerFactory = made
    return factory


def source_of_learner(name: str) -> str:
    """Return a text that changes with the source of a learner from outside of the program; empty for another one.

    The source of the program is part of every result's provenance anyway. Raises NoLearnerError.
    """
    module = inspect.getmodule(find_learner(name))
    if module is None or module.__file__ is None or module.__name__.split(".")[0] in PACKAGES:
        return ""
    return hashlib.sha256(Path(module.__file__).read_bytes()).hexdigest()


@contextmanager
def _current_folder_searched() -> Iterator[None]:
    """Let Python find modules in the current folder, as a script there would."""
    here = str(Path.cwd())
    sys.path.insert(0, here)
    try:
        yield
    finally:
        sys.path.remove(here)

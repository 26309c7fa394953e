"""Listings of the texts of `kurt2rt knowledge merge`, and of the errors of knowledge."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from string import Formatter

from kurt2rt.cli.knowledge.merge import format_left_out, format_reason, format_state
from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import ASK
from kurt2rt.knowledge.journal.binding import require_compatible
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.versions.merge import Conflict, ConflictCode, NameState, RlaState
from kurt2rt.knowledge.versions.merge_writer import LeftOutCode, LeftOutReward
from tests.knowledge.lessons import BINDING, created, rewarded

RLA = created(4, action="left").rla


def conflicts() -> Iterator[tuple[str, str]]:
    """Yield the reason of each conflict, the states, and the rewards that are left out."""
    state = RlaState(4, RLA)
    for code in ConflictCode:
        yield code, format_reason(Conflict(state, state, code, 2.0, 0.2))
    states: dict[str, RlaState | NameState] = {
        "lives": state,
        "withdrawn": RlaState(4, replace(RLA, action=ASK)),
        "gone": RlaState(4, None),
        "left out": RlaState(None, None),
        "name given": NameState("door", given=True),
        "name not given": NameState("door", given=False),
    }
    for label, each in states.items():
        yield f"state {label}", format_state(each)
    record = LessonRecord(rewarded(7))
    for left_out in LeftOutCode:
        yield left_out, format_left_out(LeftOutReward(left_out, record, "right", RLA))


def knowledge_errors() -> Iterator[tuple[str, str]]:
    """Yield the error of each code, with names of its fields for their values."""
    for code in KnowledgeCode:
        names = {name for text in (code.what, code.do) for _, name, _, _ in Formatter().parse(text) if name}
        fields = {name: name.upper() for name in names}
        yield code, str(KnowledgeError(code, where="mine.knowledge", **fields))


def differences() -> Iterator[tuple[str, str]]:
    """Yield the differences of a file's features from those of a robot."""
    names = BINDING.feature_names
    for label, others in {
        "one of each": (*names[:-1], "a"),
        "only the file's": names[:-1],
        "only the robot's": (*names, *"abcdef"),
        "other order": names[::-1],
        "other definition": names,
    }.items():
        wanted = replace(BINDING, feature_hash="another", feature_names=others)
        try:
            require_compatible(BINDING, wanted, Path("mine.knowledge"), lambda _: True)
        except KnowledgeError as error:
            yield label, str(error.fields["difference"])

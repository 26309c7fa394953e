"""Applies the teacher's commands to the knowledge, in the tick that takes them."""

from collections.abc import Iterable

from kurt2rt.layers.basic_level import BasicLevel
from kurt2rt.perception.perception import Situation
from kurt2rt.rla.rla import ActionReplaced, Origin, Phase, Rla, RlaCreated, RlaDeleted, TeachingEvent
from kurt2rt.teaching.commands import (
    Command,
    CommandResult,
    Correct,
    DeleteRla,
    ReplaceAction,
    Resume,
    SetPhase,
    Stop,
    Teach,
)


class School:
    """Phases 1 and 2: new RLAs, corrected ones, deleted ones (paper, IV.A and IV.B)."""

    def __init__(self, level: BasicLevel, *, insert_beyond_share: float, taken_command_ids: Iterable[str]) -> None:
        self._level = level
        self._insert_beyond_share = insert_beyond_share
        self._taken = set(taken_command_ids)
        self.phase = Phase.SUPERVISED
        self.stopped = False
        self.corrections = 0

    def has_taken(self, command_id: str) -> bool:
        """Whether a command of this id was carried out already."""
        return command_id in self._taken

    def attend(self, command: Command, situation: Situation, tick: int) -> tuple[CommandResult, TeachingEvent | None]:
        """Carry out one command. An event in the answer already acts and has to reach the journal."""
        # A stop that comes twice stops twice: it may be the second one that is meant.
        if self.has_taken(command.command_id) and not isinstance(command, Stop):
            return CommandResult(command.command_id, True, "had been taken already; counted once"), None
        result, event = self._carry_out(command, situation, tick)
        if result.accepted:
            self._taken.add(command.command_id)
        if event is not None:
            self._level.apply(event)
        return result, event

    def _carry_out(
        self, command: Command, situation: Situation, tick: int
    ) -> tuple[CommandResult, TeachingEvent | None]:
        match command:
            case Stop():
                self.stopped = True
                return _done(command, "the robot stands until it is told to resume"), None
            case Resume():
                self.stopped = False
                return _done(command, "the robot may drive"), None
            case SetPhase():
                self.phase = command.phase
                return _done(command, f"phase {command.phase.value}, {command.phase.name.lower()}"), None
            case DeleteRla():
                return self._delete(command, tick)
            case _:
                if command.action not in self._level.repertoire:
                    known = ", ".join(self._level.repertoire)
                    return _refused(
                        command, f"there is no action {command.action!r}; the repertoire has: {known}"
                    ), None
                return self._lesson(command, situation, tick)

    def _lesson(
        self, command: Teach | Correct | ReplaceAction, situation: Situation, tick: int
    ) -> tuple[CommandResult, TeachingEvent | None]:
        match command:
            case ReplaceAction():
                return self._replace(command, command.rla_id, tick)
            case Teach():
                # On the very condition of an RLA a second one would never win: the older one does.
                replace_within_share = 0.0
            case Correct():
                self.corrections += 1
                replace_within_share = self._insert_beyond_share
        nearest = self._level.system.match(situation.vector)
        if nearest is None or nearest.distance > replace_within_share * nearest.radius:
            return self._create(command, situation, tick)
        if nearest.rla.action == command.action:
            return _done(command, f"RLA {nearest.rla.rla_id} says {command.action} already"), None
        return self._replace(command, nearest.rla.rla_id, tick)

    def _create(
        self, command: Teach | Correct, situation: Situation, tick: int
    ) -> tuple[CommandResult, TeachingEvent | None]:
        rla = Rla(
            rla_id=self._level.system.next_id,
            condition=tuple(situation.vector.tolist()),
            action=command.action,
            radius=None,
            origin=self._origin(command, tick),
        )
        return _done(command, f"RLA {rla.rla_id} taught: {rla.action}"), RlaCreated(rla)

    def _replace(
        self, command: Teach | Correct | ReplaceAction, rla_id: int, tick: int
    ) -> tuple[CommandResult, TeachingEvent | None]:
        rla = self._level.system.get(rla_id)
        if rla is None:
            return _refused(command, f"there is no RLA {rla_id}; it may have been deleted"), None
        event = ActionReplaced(rla_id, command.action, rla.action, self._origin(command, tick))
        return _done(command, f"RLA {rla_id} corrected: {command.action} instead of {rla.action}"), event

    def _delete(self, command: DeleteRla, tick: int) -> tuple[CommandResult, TeachingEvent | None]:
        if self._level.system.get(command.rla_id) is None:
            return _refused(command, f"there is no RLA {command.rla_id}; it may have been deleted already"), None
        return _done(command, f"RLA {command.rla_id} deleted"), RlaDeleted(command.rla_id, self._origin(command, tick))

    def _origin(self, command: Command, tick: int) -> Origin:
        return Origin(command.command_id, command.teacher, self.phase, tick)


def _done(command: Command, text: str) -> CommandResult:
    return CommandResult(command.command_id, True, text)


def _refused(command: Command, text: str) -> CommandResult:
    return CommandResult(command.command_id, False, text)

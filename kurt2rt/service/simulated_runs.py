"""Runs of the simulated robot, one after the other in one program: each with a world, a task and a knowledge file."""

import secrets
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import anyio.to_thread

from config.settings_files import shipped_names
from hal.robot_settings import RobotSettings
from kurt2rt.channel.protocol.simulation import SimulationView, TaskName
from kurt2rt.channel.server.dependencies import TeacherNow
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.decision.decision import ActiveBehaviour, UnknownActionError, UnknownBehaviourError
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.core.teaching.commands import BeginSession, Command, SetPhase, Take
from kurt2rt.knowledge.exchange.package import import_knowledge
from kurt2rt.knowledge.files.archive_existing import archive_existing
from kurt2rt.knowledge.journal import journal_file
from kurt2rt.knowledge.journal.loading import open_for_teaching, read_lessons
from kurt2rt.knowledge.journal.writer import utc_now
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.runtime import empty_system
from simbridge.contracts.simulation import GENERATED_KINDS, GENERATED_WORLD

_ZIP = b"PK"


@dataclass(frozen=True, slots=True)
class SimulatedRun:
    """World, task, knowledge file and teacher of one run of the simulated robot; teachers choose the next."""

    world: str
    task: TaskSettings
    task_name: str
    """Name as chosen, or a path that the command line gave."""
    knowledge: Path
    fresh: bool = False
    """True if the file at `knowledge` is archived first."""
    loaded: Path | None = None
    """Knowledge file that is moved to `knowledge` then; None: a new file."""
    teacher: TeacherNow | None = None
    """Teacher of the run before, who teaches on; None in the first run."""

    @property
    def first_commands(self) -> tuple[Command, ...]:
        """Commands of the first tick, so that the teacher need not take the robot again."""
        if self.teacher is None:
            return ()
        device, phase, session = self.teacher

        def identity() -> str:
            return f"{device}-next-{secrets.token_hex(8)}"

        commands: tuple[Command, ...] = (Take(identity(), device), SetPhase(identity(), device, Phase(phase), -1))
        return commands if session is None else (*commands, BeginSession(identity(), device, session))


class SimulatedRuns:
    """Present run of the simulated robot, and the next one that a teacher chooses.

    It is the channel's kurt2rt.channel.server.dependencies.RunControl.
    """

    def __init__(
        self,
        robot: RobotSettings,
        first: SimulatedRun,
        require_world: Callable[[str], None],
        *,
        taught_by_script: bool,
    ) -> None:
        """Begin with the first run.

        Args:
            robot: settings of the robot in all runs.
            first: world, task and knowledge of the first run.
            require_world: raises SettingsError unless the simulator can load the world of that name.
            taught_by_script: the scripted teacher teaches the first run's task in its world, so no other run follows.
        """
        self._robot = robot
        self._require_world = require_world
        self._taught_by_script = taught_by_script
        self._files = {first.task_name: first.knowledge}
        self._view: SimulationView | None = None
        self.present = first
        self.next: SimulatedRun | None = None

    async def view(self) -> SimulationView:
        """Return the simulated world and task, and those to choose from."""
        if self._view is None:
            self._view = await anyio.to_thread.run_sync(self._list_choices)
        return self._view

    async def prepare(self, world: str | None, task: str | None, fresh: bool, teacher: TeacherNow) -> Outcome:
        """Check and keep the next run; return an outcome with its world and task.

        `world`, `task`: names; None: the present one. `fresh`: begin with an empty knowledge file.

        Raises:
            CommandRefusedError: a script teaches, or there is no such world or task.
            KnowledgeError, SettingsError: knowledge or settings of the run cannot be loaded.
        """
        if self._taught_by_script:
            raise CommandRefusedError(RefusalCode.TAUGHT_BY_SCRIPT)
        view = await self.view()
        # A teacher chooses among names: a path would read any file of the robot's machine.
        if world is not None and world not in (*view.worlds, view.world) and not GENERATED_WORLD.fullmatch(world):
            raise CommandRefusedError(RefusalCode.NO_WORLD, world=world, known=view.worlds)
        if task is not None and task not in (view.task, *(each.name for each in view.tasks)):
            raise CommandRefusedError(RefusalCode.NO_TASK, task=task, known=tuple(each.name for each in view.tasks))
        self.next = await anyio.to_thread.run_sync(self._prepare, world, task, fresh, teacher)
        return Outcome.of(ResultCode.NEXT_RUN, world=self.next.world, task=self.next.task_name)

    def advance(self) -> str:
        """Make the next run the present one, before it begins; return what to log of its knowledge file, or "".

        Raises KnowledgeError if the present knowledge cannot be archived; then the next run goes on with it.
        """
        assert self.next is not None
        self.present, self.next, self._view = self.next, None, None
        self._files[self.present.task_name] = self.present.knowledge
        if not self.present.fresh:
            return ""
        loaded, knowledge = self.present.loaded, self.present.knowledge
        self.present = replace(self.present, fresh=False, loaded=None)
        kept = archive_existing(knowledge)
        if loaded is not None:
            loaded.rename(knowledge)
        return "" if kept is None else f"the knowledge up to now is kept as {kept}"

    async def load(self, content: bytes, teacher: TeacherNow) -> Outcome:
        """Check and keep the knowledge that the next run begins with; return an outcome with its lessons' number.

        `content`: bytes of an export or a knowledge file.

        Raises:
            CommandRefusedError: a script teaches.
            KnowledgeError: the knowledge is damaged or does not fit, or cannot be stored.
            SettingsError: its task or the robot cannot be loaded.
        """
        if self._taught_by_script:
            raise CommandRefusedError(RefusalCode.TAUGHT_BY_SCRIPT)
        try:
            self.next, lessons = await anyio.to_thread.run_sync(self._load, content, teacher)
        except OSError as error:
            folder = self.present.knowledge.parent
            raise KnowledgeError(KnowledgeCode.FOLDER_NOT_WRITABLE, where=folder, error=error.strerror) from error
        return Outcome.of(ResultCode.KNOWLEDGE_LOADED, lessons=lessons)

    def _load(self, content: bytes, teacher: TeacherNow) -> tuple[SimulatedRun, int]:
        present = self.present
        folder = present.knowledge.parent
        kept = folder / f".{present.knowledge.name}.loaded"
        with TemporaryDirectory(dir=folder, prefix=".loading-") as room:
            brought, loaded = Path(room, "upload"), Path(room, "loaded.knowledge")
            brought.write_bytes(content)
            try:
                if content.startswith(_ZIP):
                    import_knowledge(brought, loaded, self._robot, present.task, stamp=utc_now())
                else:
                    brought.rename(loaded)
                # Opened as the next run opens it: damage, another task's lessons.
                lessons = self._check_knowledge(loaded, present.task)
            except (KnowledgeError, UnknownActionError, UnknownBehaviourError) as error:
                text = str(error)
                for path in (brought.resolve(), loaded.resolve(), brought, loaded):
                    text = text.replace(str(path), "the uploaded file")
                raise KnowledgeError(KnowledgeCode.UPLOAD_REFUSED, reason=text) from error
            loaded.rename(kept)
        return replace(present, fresh=True, loaded=kept, teacher=teacher), lessons

    def _prepare(self, world: str | None, task: str | None, fresh: bool, teacher: TeacherNow) -> SimulatedRun:
        present = self.present
        name = task or present.task_name
        settings = present.task if name == present.task_name else load_task(name)
        where = world or (present.world if name == present.task_name else settings.teaching.world)
        self._require_world(where)
        knowledge = self._files.get(name, present.knowledge.with_name(f"{settings.name}.knowledge"))
        if knowledge != present.knowledge and knowledge.exists():
            # Opened as the next run opens it, so that another program that writes it is found now.
            if fresh:
                journal_file.lock_for_writing(knowledge).close()
            else:
                self._check_knowledge(knowledge, settings)
        if knowledge == present.knowledge and name != present.task_name and not fresh:
            # This program writes it, for the present task.
            _require_able(read_lessons(knowledge, self._robot, settings, in_writer_process=True), self._robot, settings)
        return SimulatedRun(where, settings, name, knowledge, fresh, teacher=teacher)

    def _check_knowledge(self, path: Path, task: TaskSettings) -> int:
        """Open a knowledge file as the next run does; return its number of lessons.

        Raises KnowledgeError; UnknownActionError or UnknownBehaviourError for knowledge that cannot act here.
        """
        opened = open_for_teaching(path, self._robot, task)
        opened.journal.close()
        _require_able(opened.events, self._robot, task)
        return len(opened.entries)

    def _list_choices(self) -> SimulationView:
        tasks = tuple(TaskName(name, load_task(name).sentence) for name in shipped_names("tasks"))
        worlds = (*shipped_names("worlds"), *(f"{kind}-N" for kind in GENERATED_KINDS))
        return SimulationView(self.present.world, self.present.task_name, worlds, tasks)


def _require_able(events: Iterable[TeachingEvent], robot: RobotSettings, task: TaskSettings) -> None:
    """Require knowledge that the next run can act with. Raises UnknownActionError, UnknownBehaviourError."""
    mid = None if task.mid is None else load_mid_level(task.mid)
    definition = load_situation(task.situation, robot.infrared.names)
    system = empty_system(robot, task, definition, load_critic(task.critic), mid)
    system.apply_all(events)
    wanted = ActiveBehaviour(task.behaviours)
    BasicLevel(system, load_task_repertoire(task, robot), 1, wanted)
    if mid is not None:
        MidLevel(system, mid.build(robot), mid, wanted)

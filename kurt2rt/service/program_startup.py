"""Startup of one run of the robot program: robot, knowledge, keys and port, as soon as they are there."""

import asyncio
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import anyio

from hal.guard_reason import GuardReason
from hal.tap import Tap
from kurt2rt.channel.security.pairing import OF_THIS_MACHINE, local_pairing, pairing_names
from kurt2rt.channel.server.channel import EVERYWHERE, LOOPBACK
from kurt2rt.channel.server.endpoint import require_port
from kurt2rt.knowledge.journal.loading import OpenedKnowledge, open_for_teaching
from kurt2rt.service.assembly import RunSettings
from kurt2rt.service.health.status_socket import serve_waiting, status_socket_path
from kurt2rt.service.open_robot import OpenedRobot
from kurt2rt.service.run_options import ProgramEnvironment, RunOptions
from kurt2rt.service.shutdown import ProcessContext
from kurt2rt.service.startup import Dependency, DependencyName, StartupGate, missing_text, require_folder


class ProgramStartup:
    """Opener of what a run needs; a service waits for it, and brakes the robot meanwhile."""

    def __init__(
        self,
        options: RunOptions,
        settings: RunSettings,
        environment: ProgramEnvironment,
        context: ProcessContext,
        run_stack: ExitStack,
        open_tap: Callable[[], Tap | None],
    ) -> None:
        """Open nothing yet.

        Args:
            options: options of the command line.
            settings: settings of the run.
            environment: opener of the robot and times.
            context: signals, service manager and log of the process.
            run_stack: closes the robot at the end of the run.
            open_tap: returns the tap of the bus; called in a thread, before each attempt to open the robot.
        """
        self._options = options
        self._settings = settings
        self._service = settings.service
        self._environment = environment
        self._context = context
        self._run_stack = run_stack
        self._open_tap = open_tap
        self.opened: OpenedRobot | None = None
        """Robot; None until it is open."""
        self.knowledge: OpenedKnowledge | None = None
        """Knowledge that a service opened; None until it is open, and always if no service manager runs the program."""

    async def open(self) -> OpenedRobot | None:
        """Open the robot, the knowledge and the keys, and return the robot; a service waits for what is missing.

        Returns None if the program has to end while it waits.

        Raises:
            BusError, SettingsError: the robot cannot be opened.
            CredentialsError: the programs of this machine cannot be paired.
            KnowledgeError: the knowledge of a service is damaged, or does not fit robot or task.
            StartError: a folder of a service cannot be made.
        """
        if self._options.as_service:
            with anyio.CancelScope() as waiting:
                await self._wait_for_all(waiting)
            if waiting.cancelled_caught:
                return None
        else:
            self._claim_robot()
            if self._options.attended:
                self._pair()
        return self.opened

    async def _wait_for_all(self, waiting: anyio.CancelScope) -> None:
        """Wait for all dependencies; cancel `waiting` if the program has to end meanwhile."""
        loop = asyncio.get_running_loop()
        context = self._context
        dependencies = (
            Dependency(DependencyName.BUS, self._claim_robot),
            Dependency(DependencyName.KNOWLEDGE, self._claim_knowledge),
            Dependency(DependencyName.KEYS, self._pair),
            Dependency(DependencyName.NETWORK, self._check_port),
            *((Dependency(DependencyName.RECORDINGS, self._check_recordings),) if self._options.record else ()),
        )
        gate = StartupGate(dependencies, context.notifier, context.log, self._hold, self._environment.retry_s)
        with context.shutdown.on_shutdown(self._brake, lambda: loop.call_soon_threadsafe(waiting.cancel)):
            try:
                async with anyio.create_task_group() as tasks:
                    tasks.start_soon(self._serve_waiting, gate)
                    await gate.wait_for_all()
                    tasks.cancel_scope.cancel()
            except BaseException:
                if self.knowledge is not None:
                    self.knowledge.journal.close()
                raise
        if self.opened is not None:
            self.opened.robot.release()

    async def _serve_waiting(self, gate: StartupGate) -> None:
        """Serve the list of missing dependencies; not before the knowledge is ours, for its status may be another's."""
        await gate.wait_for(DependencyName.KNOWLEDGE)
        path = status_socket_path(Path(self._service.knowledge))
        await serve_waiting(path, lambda: missing_text(gate.missing))

    def _hold(self) -> None:
        """Brake a robot that is open before the rest, and check that its bus is still up."""
        if self.opened is not None:
            self.opened.robot.sense(time.monotonic())
        self._brake()

    def _brake(self) -> None:
        if self.opened is not None:
            self.opened.robot.emergency_stop(GuardReason.PROGRAM_WAITS)

    def _claim_robot(self) -> None:
        options = self._options
        opening = self._environment.open_robot(
            self._settings.robot, options.bus, self._service.world, options.seed, self._open_tap()
        )
        self.opened = self._run_stack.enter_context(opening)

    def _claim_knowledge(self) -> None:
        path = Path(self._service.knowledge)
        require_folder(path.parent)
        self.knowledge = open_for_teaching(path, self._settings.robot, self._settings.task)

    def _pair(self) -> None:
        """Pair the programs of this machine."""
        service = self._service
        if self._options.as_service:
            for folder in service.pairings:
                require_folder(folder)
        for name in sorted(OF_THIS_MACHINE):
            local_pairing(*service.pairings, name, port=service.port)

    def _check_recordings(self) -> None:
        require_folder(Path(self._service.recordings))

    def _check_port(self) -> None:
        nobody_paired = OF_THIS_MACHINE.issuperset(pairing_names(self._service.pairings.teachers))
        require_port(LOOPBACK if nobody_paired else EVERYWHERE, self._service.port)

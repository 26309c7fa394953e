"""A simulated robot that runs, a link to it that can be cut, and the page's server behind that link."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import anyio
import anyio.from_thread

from kurt2rt.channel.protocol.state import State
from kurt2rt.channel.security.pairing import Device, read_device
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.server import listen, run_page
from tests.channel.lossy_link import LossyLink
from tests.cli.helpers import Running, running


@dataclass
class Classroom:
    """The page's server lives in a thread with an event loop of its own, so a test may wait for its browser."""

    portal: anyio.from_thread.BlockingPortal
    robot: Running
    link: LossyLink
    client: TeacherClient
    address: str
    """Opens the page."""

    def state(self) -> State:
        """Return the newest state that came over the link."""
        state = self.portal.call(lambda: self.client.state)
        assert state is not None
        return state

    def put_robot_in_the_open(self) -> None:
        """Place the robot where no wall makes the guard stop it."""
        answer = self.portal.call(self.client.place, 2.2, 2.0, 0.0)
        assert answer.accepted, answer.text

    def cut(self) -> None:
        """Nothing comes through to the robot any more, nor back."""
        self.portal.call(self.link.cut)

    def mend(self) -> None:
        """Restore the link."""
        self.portal.call(self.link.mend)


@contextmanager
def classroom(folder: Path, *options: str) -> Iterator[Classroom]:
    """Open everything, in this order, and close it again; `options` of `kurt2rt run`."""
    with running("run", "--port", "0", *options, folder=folder) as robot:
        port = int(robot.wait_for("UDP port").split()[-1])
        device = read_device(folder / "var" / "devices" / "local")
        with (
            anyio.from_thread.start_blocking_portal() as portal,
            portal.wrap_async_context_manager(LossyLink(port)) as link,
            portal.wrap_async_context_manager(TeacherClient(device.folder, "127.0.0.1", link.port)) as client,
            _served(portal, client, device) as address,
        ):
            yield Classroom(portal, robot, link, client, address)


@contextmanager
def _served(portal: anyio.from_thread.BlockingPortal, client: TeacherClient, device: Device) -> Iterator[str]:
    listener = listen(0, everywhere=False)
    access = Access(device.name, device.token, [])
    ended = portal.call(anyio.Event)
    with listener:
        serving = portal.start_task_soon(run_page, client, access, "127.0.0.1", listener, ended.wait)
        try:
            yield f"http://127.0.0.1:{listener.getsockname()[1]}/pair?token={device.token}"
        finally:
            portal.call(ended.set)
            serving.result()

"""`kurt2rt ros`."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Annotated

import anyio
import anyio.to_thread
import typer
from rich.console import Console

from config.errors import UserError
from kurt2rt.channel.security.pairing import Device, read_device
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.options import RobotAddress, RobotPort, SettingsName, refuse_if
from kurt2rt.cli.teach_shutdown import until_teaching_ends
from kurt2rt.platform.text_table import print_lines
from kurt2rt.ros.settings import Naming, RosSettings, is_ros_name
from kurt2rt.service.settings import load_service
from kurt2rt.teacher.client.client import TeacherClient

if TYPE_CHECKING:
    from kurt2rt.ros.session import ZenohSession

_DEVICE, _ROUTER = "ros", "tcp/127.0.0.1:7447"
_RETRY_S = 1.0

Say = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class _Options:
    connect: Annotated[
        list[str] | None,
        typer.Option(
            metavar="LOCATOR",
            help=f"Connect to this zenoh router or bridge. Default: {_ROUTER}, unless it listens.",
        ),
    ] = None
    listen: Annotated[
        list[str] | None, typer.Option(metavar="LOCATOR", help="Listen for zenoh programs here, without a router.")
    ] = None
    naming: Annotated[
        Naming, typer.Option(help="Names of topics on zenoh: those of zenoh-bridge-ros2dds, or of rmw_zenoh.")
    ] = Naming.BRIDGE
    domain: Annotated[int, typer.Option(metavar="N", min=0, max=232, help="ROS_DOMAIN_ID, for rmw_zenoh.")] = 0
    namespace: Annotated[str, typer.Option(help="Namespace of topics and services, such as robot1.")] = ""
    stamped: Annotated[bool, typer.Option("--stamped", help="cmd_vel carries TwistStamped instead of Twist.")] = False
    device: Annotated[str, typer.Option(help="Paired device that this is to the robot.")] = _DEVICE
    robot: RobotAddress = None
    port: RobotPort = None
    settings: SettingsName = "default"


@takes_options(_Options)
def ros(options: _Options) -> None:
    """Join a running robot to ROS 2, over zenoh, without ROS.

    It is a paired device like a phone, in a process of its own: the robot drives
    on without it, and obeys it only as it obeys any teacher.

        kurt2rt pair ros
        kurt2rt ros
        kurt2rt ros --connect tcp/192.168.0.5:7447 --naming rmw_zenoh

    Publishes scan, odom, /tf, question and /diagnostics. Takes cmd_vel while this
    device teaches the robot (service take); the robot stands when twists cease.
    Services of type std_srvs/srv/Trigger: take, release, stop, resume, undo, and
    for each action teach/ACTION and correct/ACTION. While a node publishes watch
    ten times a second, a robot that needs its teacher there drives on.

    Every node of this ROS network can drive and teach the robot, so keep it
    closed. Waits for a robot and a router that are not there yet; ends on Ctrl-C.
    docs/other-robots.md has the rest.
    """
    is_none = bool(options.namespace) and not is_ros_name(options.namespace)
    refuse_if(is_none, "not a name of ROS; use letters, digits and _, joined by /", "--namespace")
    import kurt2rt.ros.session  # noqa: F401  # names the extra `ros` before anything else is wrong

    service = load_service(options.settings)
    device = read_device(service.pairings.devices / options.device)
    names = RosSettings(naming=options.naming, domain=options.domain, namespace=options.namespace)
    anyio.run(_run, options, device, names)


async def _run(options: _Options, device: Device, names: RosSettings) -> None:
    """Serve until a signal. Raises UserError if the pairing ends or a connection cannot be had."""
    # Late imports: zenoh and rosbags are in the extra `ros`.
    from kurt2rt.ros.port import RosConnectionError
    from kurt2rt.teacher.ros.device import RosDevice

    say = partial(print_lines, Console())
    reason = ""

    async def serve() -> None:
        session = await _open_session(options, names, say)
        try:
            async with TeacherClient(device.folder, options.robot, options.port) as client:
                await RosDevice(client, session, say, stamped=options.stamped).run()
        except RosConnectionError as error:
            raise UserError(str(error), do="start kurt2rt ros again") from error
        finally:
            session.close()

    async with anyio.create_task_group() as tasks:
        tasks.start_soon(serve)
        reason = await until_teaching_ends(device, command="ros")
        tasks.cancel_scope.cancel()
    if reason:
        raise UserError(reason)


async def _open_session(options: _Options, names: RosSettings, say: Say) -> "ZenohSession":
    """Return a session as soon as there is a router. Raises UserError if it cannot listen."""
    from kurt2rt.ros.port import RosConnectionError
    from kurt2rt.ros.session import ZenohSession

    listen = options.listen or ()
    connect = options.connect or (() if listen else (_ROUTER,))
    told = ""
    while True:
        try:
            session = await anyio.to_thread.run_sync(lambda: ZenohSession(names, connect=connect, listen=listen))
        except RosConnectionError as error:
            if listen:
                raise UserError(str(error), do="give another locator, such as tcp/127.0.0.1:7448") from error
            if str(error) != told:
                told = str(error)
                say(f"{told}; waiting for a zenoh router or bridge there")
            await anyio.sleep(_RETRY_S)
        else:
            say(f"{'listens' if listen else 'connected'} at {', '.join((*connect, *listen))} ({names.naming})")
            return session

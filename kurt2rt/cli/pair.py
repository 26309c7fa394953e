"""`kurt2rt pair`."""

import io
from pathlib import Path
from typing import Annotated

import segno
import typer
from rich.console import Console
from rich.text import Text

from kurt2rt.channel.security import pairing
from kurt2rt.channel.security.pairing import OF_THIS_MACHINE, Pairing, paired
from kurt2rt.cli.json_output import plain, print_json
from kurt2rt.cli.tables import console_of
from kurt2rt.platform.text_table import TextTable, print_whole
from kurt2rt.service.settings import load_service
from kurt2rt.teacher.page.host_names import own_address

_TIME = "%Y-%m-%d %H:%M"


def pair(
    name: Annotated[
        str | None,
        typer.Argument(
            help="Name of the device and so of its teacher: up to 24 of a-z, 0-9 and -.", show_default=False
        ),
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="List who is paired; change nothing.")] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="With --list, print the list as one JSON document, and nothing else.")
    ] = False,
    renew: Annotated[
        bool, typer.Option("--renew", help="Give NAME new keys and a new page address; the old ones are refused.")
    ] = False,
    revoke: Annotated[
        bool, typer.Option("--revoke", help="Delete NAME's keys; a running robot refuses it within a second.")
    ] = False,
    host: Annotated[
        str | None,
        typer.Option(
            help="Address of the machine that will run kurt2rt teach. Default: this one's.", show_default=False
        ),
    ] = None,
    settings: Annotated[
        str, typer.Option(help="Runtime settings by name (config/runtime) or a path to a YAML file.")
    ] = "default",
) -> None:
    """Pair a teacher's device with this robot, and show the code that opens its page.

    Makes two folders with a common secret: the robot's side, which stays here,
    and the device's side, which kurt2rt teach uses. What to do next:

        kurt2rt run --phone            robot and page; one that runs takes the device in within a second
        then scan the code that it shows, or open the address

    To run kurt2rt teach on another machine than the robot, move the device's
    folder there (do not copy it: its message numbers count once), and start there
    kurt2rt teach --as NAME --robot ADDRESS. The robot itself listens beyond its
    own machine only if a device is paired when it is started.

    Nobody needs to be paired to teach at the robot's own machine.

    For example:

        kurt2rt pair anna-phone
        kurt2rt pair --list
        kurt2rt pair anna-phone --revoke
    """
    service = load_service(settings)
    teachers, devices = Path(service.teachers), Path(service.devices)
    console = Console()
    if list_ + renew + revoke > 1:
        raise typer.BadParameter("one of these at a time", param_hint="--list, --renew, --revoke")
    if as_json and not list_:
        raise typer.BadParameter("only a list is told as JSON; give --list, too", param_hint="--json")
    if list_:
        if as_json:
            print_json({"paired": [{**plain(row), "device": _where(row.name, devices)} for row in paired(teachers)]})
        else:
            print_whole(console_of(), _table(teachers, devices))
        return
    if name is None:
        raise typer.BadParameter("whose device? Give it a name, such as anna-phone", param_hint="NAME")
    if revoke:
        pairing.revoke(teachers, devices, name)
        _say(console, f"{name} is paired no longer")
        return
    change = pairing.renew if renew else pairing.pair
    paired_now = change(teachers, devices, name, port=service.port)
    address = page_address(paired_now, host or own_address(), service.page_port)
    _say(
        console,
        f"{name} is paired",
        f"robot's side   {paired_now.teacher}",
        f"device's side  {paired_now.device.folder}",
        "next           kurt2rt run --phone, unless it runs already; then scan the code that it shows",
        f"its page       {address}",
    )
    # White on black whatever the terminal's colours are: cameras dislike negatives.
    console.print(Text(_code(address), style="bright_white on black"), soft_wrap=True)


def page_address(pairing: Pairing, host: str, port: int) -> str:
    """What a device opens to be let in to its page."""
    shown = f"[{host}]" if ":" in host else host
    return f"http://{shown}:{port}/pair?token={pairing.device.token}"


def _code(address: str) -> str:
    drawn = io.StringIO()
    segno.make(address, micro=False).terminal(drawn, compact=True)
    return drawn.getvalue().rstrip("\n")


def _table(teachers: Path, devices: Path) -> TextTable | Text:
    rows = paired(teachers)
    if not rows:
        return Text("Nobody is paired. Pair a device: kurt2rt pair NAME")
    table = TextTable("name", "made (UTC)", "last used (UTC)", "device's side")
    for row in rows:
        used = "never" if row.used_at is None else row.used_at.strftime(_TIME)
        table.add_row(row.name, row.made_at.strftime(_TIME), used, _where(row.name, devices))
    return table


def _where(name: str, devices: Path) -> str:
    if name in OF_THIS_MACHINE:
        return "this machine's own"
    return "here" if (devices / name).is_dir() else "moved away"


def _say(console: Console, *lines: str) -> None:
    console.print(*lines, sep="\n", markup=False, highlight=False, soft_wrap=True)

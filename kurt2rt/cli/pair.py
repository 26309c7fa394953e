"""`kurt2rt pair`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.text import Text

from kurt2rt.channel.security import pairing
from kurt2rt.channel.security.pairing import OF_THIS_MACHINE, Pairing, PairingFolders, list_pairings
from kurt2rt.cli.json_output import plain, print_json
from kurt2rt.cli.options import PageAddressName, SettingsName, refuse_if
from kurt2rt.cli.qr_code import print_code
from kurt2rt.cli.tables import console_of
from kurt2rt.platform.text_table import TextTable, print_lines, print_whole
from kurt2rt.service.settings import load_service
from kurt2rt.teacher.page.own_addresses import NO_ADDRESS
from kurt2rt.teacher.page.served_pages import PageAddress, page_addresses

_TIME = "%Y-%m-%d %H:%M"


_Name = Annotated[
    str | None,
    typer.Argument(help="Name of the device and so of its teacher: up to 24 of a-z, 0-9 and -.", show_default=False),
]
_List = Annotated[bool, typer.Option("--list", help="List the paired devices; change nothing.")]
_AsJson = Annotated[
    bool, typer.Option("--json", help="With --list, print the list as one JSON document, and nothing else.")
]
_Renew = Annotated[
    bool, typer.Option("--renew", help="Give NAME new keys and a new page address; the old ones are refused.")
]
_Revoke = Annotated[
    bool, typer.Option("--revoke", help="Delete NAME's keys; a running robot refuses it within a second.")
]


def pair(
    name: _Name = None,
    list_: _List = False,
    as_json: _AsJson = False,
    renew: _Renew = False,
    revoke: _Revoke = False,
    page_address: PageAddressName = None,
    settings: SettingsName = "default",
) -> None:
    """Pair a teacher's device, and show the code of its page.

    Makes two folders with a common secret: the robot's side, which stays here,
    and the device's side, which kurt2rt teach uses. Next:

        kurt2rt run --phone            robot and page; a running one accepts the device within a second
        then scan the code that it shows, or open the address

    To run kurt2rt teach on another machine than the robot, move the device's
    folder there (do not copy it: its message numbers count once), and start there
    kurt2rt teach --device NAME --robot ADDRESS. The robot itself listens beyond its
    own machine only if a device is paired when it is started.

    Teaching at the robot's own machine needs no pairing. For example:

        kurt2rt pair anna-phone
        kurt2rt pair --list
        kurt2rt pair anna-phone --revoke
    """
    service = load_service(settings)
    pairings = service.pairings
    refuse_if(list_ + renew + revoke > 1, "one of these at a time", "--list, --renew, --revoke")
    refuse_if(as_json and not list_, "only a list is printed as JSON; give --list, too", "--json")
    if list_:
        _list(pairings, as_json=as_json)
    elif name is None:
        raise typer.BadParameter("whose device? Give it a name, such as anna-phone", param_hint="NAME")
    elif revoke:
        pairing.revoke(*pairings, name)
        print_lines(Console(), f"{name} is paired no longer")
    else:
        change = pairing.renew if renew else pairing.pair
        changed = change(*pairings, name, port=service.port)
        addresses = page_addresses(changed.device, page_address or service.page_address, service.page_port)
        _show(name, changed, addresses)


def _list(pairings: PairingFolders, *, as_json: bool) -> None:
    if as_json:
        rows = list_pairings(pairings.teachers)
        print_json({"paired": [{**plain(row), "device": _where(row.name, pairings.devices)} for row in rows]})
    else:
        print_whole(console_of(), _table(*pairings))


def _show(name: str, changed: Pairing, addresses: Sequence[PageAddress]) -> None:
    console = Console()
    print_lines(
        console,
        f"{name} is paired",
        f"robot's side   {changed.teacher}",
        f"device's side  {changed.device.folder}",
        "next           kurt2rt run --phone, unless it runs already; then scan the code that it shows",
        *(f"its page       {each.link}" for each in addresses),
        whole=True,
    )
    if addresses:
        print_code(console, addresses[0].link)
    else:
        print_lines(console, f"! {NO_ADDRESS}")


def _table(teachers: Path, devices: Path) -> TextTable | Text:
    rows = list_pairings(teachers)
    if not rows:
        return Text("No device is paired. Pair one: kurt2rt pair NAME")
    table = TextTable("name", "made (UTC)", "last used (UTC)", "device's side")
    for row in rows:
        used = "never" if row.used_at is None else row.used_at.strftime(_TIME)
        table.add_row(row.name, row.made_at.strftime(_TIME), used, _where(row.name, devices))
    return table


def _where(name: str, devices: Path) -> str:
    if name in OF_THIS_MACHINE:
        return "this machine's own"
    return "here" if (devices / name).is_dir() else "moved away"

"""Typed words of a command in reports and records."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.cli.options import Jobs
from kurt2rt.cli.typed_command import typed_command
from kurt2rt.experiments.lockstep.drive_loop import DriveLoop


@dataclass(frozen=True)
class Options:
    taught: Annotated[Path, typer.Argument()]
    seconds_s: Annotated[float, typer.Option("--seconds")] = 12.0
    set_down: Annotated[float, typer.Option()] = 1.0
    sound: Annotated[bool, typer.Option("--sound/--mute")] = True
    loop: Annotated[DriveLoop, typer.Option()] = DriveLoop.BUS
    world: Annotated[list[str] | None, typer.Option()] = None
    jobs: Jobs = 1


def test_typed_command_leaves_out_defaults_and_paths() -> None:
    assert typed_command("try", Options(Path("/home/ann/made"))) == "kurt2rt try made"
    options = Options(
        Path("made"), seconds_s=3.0, set_down=0.5, sound=False, loop=DriveLoop.BATCH, world=["a", "/x/b.yaml"], jobs=7
    )
    assert typed_command("try", options, {"taught": "other"}) == (
        "kurt2rt try other --seconds 3 --set-down 0.5 --mute --loop batch --world a --world b.yaml"
    )

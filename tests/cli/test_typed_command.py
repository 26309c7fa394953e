"""A command in a report and in a record: typed again, it makes the same numbers."""

from dataclasses import dataclass
from typing import Annotated

import pytest
import typer

from kurt2rt.cli.typed_command import typed_command


@dataclass(frozen=True, slots=True, kw_only=True)
class _Options:
    task: Annotated[str, typer.Option(help="Task.")]


@pytest.mark.parametrize(
    ("task", "typed"),
    [("circle", "circle"), ("school/fleeing", "school/fleeing"), ("/home/me/my circle.yaml", "'my circle.yaml'")],
)
def test_only_a_file_loses_its_folder(task: str, typed: str) -> None:
    assert typed_command("study phases", _Options(task=task)) == f"kurt2rt study phases --task {typed}"

"""Listing of the errors of settings files."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Literal

from pydantic import Field

from config.settings import Settings, SettingsError, load_settings
from config.settings_files import find_config


class _Motor(Settings):
    kind: Literal["motor"]
    speed_m_s: Annotated[float, Field(gt=0, le=1)]


class _Turn(Settings):
    kind: Literal["turn"]
    angle_deg: float


class _Sample(Settings):
    name: str
    count: Annotated[int, Field(ge=0)] = 0
    mode: Literal["slow", "fast"] = "slow"
    actions: tuple[Annotated[_Motor | _Turn, Field(discriminator="kind")], ...] = ()


_FILES = {
    "misspelt key": "name: a\ncuont: 1",
    "misspelt key of an item": "name: a\nactions: [{kind: motor, spede_m_s: 1}]",
    "missing key": "count: 1",
    "no kind": "name: a\nactions: [{speed_m_s: 1}]",
    "unknown kind": "name: a\nactions: [{kind: motr}]",
    "no number": "name: a\ncount: many",
    "no whole number": "name: a\ncount: 1.5",
    "number too small": "name: a\ncount: -1",
    "not finite": "name: a\nactions: [{kind: turn, angle_deg: .nan}]",
    "unknown word": "name: a\nmode: quick",
    "two errors": "name: 1\ncount: many",
    "empty file": "",
    "list": "- 1",
    "key twice": "name: a\nname: b",
    "key no text": "1: a",
    "aliases": "a: &a [x,x,x,x,x,x,x,x,x]\n"
    + "\n".join(
        f"{key}: &{key} [{','.join([f'*{below}'] * 9)}]" for below, key in zip("abcdefg", "bcdefgh", strict=True)
    ),
}


def errors() -> Iterator[tuple[str, str]]:
    """Yield the error of each unusable file, change and name, without the file's path."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "mine.yaml"
        for label, content in _FILES.items():
            path.write_text(content, encoding="utf-8")
            yield label, _error(path)
        path.write_text("name: a\nactions: [{kind: turn, angle_deg: 1}]", encoding="utf-8")
        for label, changes in {
            "set, unknown key": {"names": "x"},
            "set, nothing within": {"name.first": "x"},
            "set, wrong value": {"count": "near"},
            "set, beyond the list": {"actions.1.angle_deg": "2"},
            "set, no position": {"actions.first.angle_deg": "2"},
        }.items():
            yield label, _error(path, changes)
        path.write_bytes(bytes(1_000_001))
        yield "too large", _error(path)
    for name in ("kurt3", "nowhere"):
        try:
            find_config("robots", name)
        except SettingsError as error:
            yield f"no such file, {name}", str(error)


def _error(path: Path, changes: Mapping[str, str] | None = None) -> str:
    try:
        load_settings(path, _Sample, changes)
    except SettingsError as error:
        return str(error).removeprefix(f"{path}: ")
    raise ValueError(f"{path.read_text(encoding='utf-8')!r} is no error of settings")

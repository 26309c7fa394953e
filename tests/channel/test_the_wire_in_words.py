"""docs/the-wire.md says what the codec does: all keys, all paths, and how many places each body has."""

import re
from collections.abc import Iterator
from pathlib import Path

import cbor2
import pytest

from kurt2rt.channel.requests import VERSION, checks_of
from kurt2rt.channel.wire import PATHS, encode_state
from kurt2rt.health.plain import plain_of
from kurt2rt.standing import Standing
from tests.channel.states import COMMANDS, SURPRISED, state
from tests.health.reports import ILL

TEXT = (Path(__file__).parents[2] / "docs" / "the-wire.md").read_text(encoding="utf-8")
PICTURE = TEXT[TEXT.index("### The picture") : TEXT.index("### What a teacher says")]
HEALTH = TEXT[TEXT.index("### Health") : TEXT.index("### Versions")]
SAID = TEXT[TEXT.index("### What a teacher says") : TEXT.index("### Versions")]


def bodies() -> dict[str, list[str]]:
    """By path, the words of its body; nested lists are one place."""
    found: dict[str, list[str]] = {}
    for row in re.findall(r"^\| \w+ \| (`/.*?) \| (`\[.*?) \|", SAID, re.MULTILINE):
        paths, written = (re.findall(r"`([^`]*)`", column) for column in row)
        for path, body in zip(paths, written if len(written) == len(paths) else written * len(paths), strict=True):
            found[path] = [each for each in body.strip("[]").split(", ") if each]
    return found


def test_every_key_of_the_picture_is_explained() -> None:
    keys = set(cbor2.loads(encode_state(state())))
    explained = set(re.findall(r"`(\w+)`", "".join(re.findall(r"^\|.*\|$", PICTURE, re.MULTILINE))))
    assert keys <= explained, keys - explained


@pytest.mark.parametrize("key", ["mid", "su", "sd"])
def test_the_rows_of_the_picture_have_the_places_that_are_written(key: str) -> None:
    row = cbor2.loads(encode_state(state(mid=COMMANDS, surprise=SURPRISED, standing=Standing())))[key]
    written = re.search(rf"`{key}` is `\[(.*?)\]`", PICTURE)
    assert written is not None
    assert len(written[1].split(", ")) == len(row)


def test_every_path_is_explained_with_as_many_places_as_it_takes() -> None:
    assert {path: len(body) for path, body in bodies().items()} == {
        path: len(checks_of(kind)) for path, kind in PATHS.items()
    }


def keys_in(plain: object) -> Iterator[str]:
    """All keys of maps in maps and lists."""
    if isinstance(plain, dict):
        for key, value in plain.items():
            yield key
            yield from keys_in(value)
    elif isinstance(plain, list):
        for each in plain:
            yield from keys_in(each)


def test_every_key_of_the_health_report_is_explained() -> None:
    keys = set(keys_in(plain_of(ILL)))
    explained = set(re.findall(r"`(\w+)`", HEALTH))
    assert keys <= explained, keys - explained


def test_the_version_is_the_one_that_the_robot_speaks() -> None:
    assert f"is the version of this contract: {VERSION}." in TEXT

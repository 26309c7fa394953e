"""docs/the-wire.md says what the codec does: all keys, all paths, and how many places each body has."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin

import cbor2
import pytest

from kurt2rt.channel.protocol.codec import BODIES, PATHS, encode_state
from kurt2rt.channel.protocol.health import HEALTH
from kurt2rt.channel.protocol.limits import VERSION
from kurt2rt.core.decision.decision import StandReason
from kurt2rt.core.decision.standing import Standing
from kurt2rt.core.message_fields import Bytes, BytesUpTo, Flag, Float, Int, OneOf, Text, UpTo
from kurt2rt.core.teaching.message_fields import GoalField
from tests.channel.channel_fixture import ChannelFixture
from tests.channel.states import COMMANDS, HELD, SHOWN, SURPRISED, state
from tests.service.health.reports import ILL

TEXT = (Path(__file__).parents[3] / "docs" / "the-wire.md").read_text(encoding="utf-8")
STATE = TEXT[TEXT.index("### The state") : TEXT.index("### Requests")]
HEALTH_PART = TEXT[TEXT.index("### Health") : TEXT.index("### Versions")]
SAID = TEXT[TEXT.index("### Requests") : TEXT.index("### Versions")]


def bodies() -> dict[str, list[str]]:
    """Return the words of each body by path; nested lists are one place."""
    found: dict[str, list[str]] = {}
    for row in re.findall(r"^\| (`/.*?) \| (`\[.*?) \|", SAID, re.MULTILINE):
        paths, written = (re.findall(r"`([^`]*)`", column) for column in row)
        for path, body in zip(paths, written if len(written) == len(paths) else written * len(paths), strict=True):
            found[path] = [each for each in body.strip("[]").split(", ") if each]
    return found


def test_every_key_of_the_state_is_explained() -> None:
    keys = set(cbor2.loads(encode_state(state())))
    explained = set(re.findall(r"`(\w+)`", "".join(re.findall(r"^\|.*\|$", STATE, re.MULTILINE))))
    assert keys <= explained, keys - explained


@pytest.mark.parametrize("key", ["mid", "su", "sd", "hd", "dm"])
def test_wire_page_rows_have_the_documented_places(key: str) -> None:
    shown = state(mid=COMMANDS, surprise=SURPRISED, standing=Standing(), hold=HELD, shown=SHOWN)
    row = cbor2.loads(encode_state(shown))[key]
    written = re.search(rf"`{key}` is `\[(.*?)\]`", STATE)
    assert written is not None
    assert len(written[1].split(", ")) == len(row)


def test_every_path_is_explained_with_as_many_places_as_it_takes() -> None:
    assert {path: len(body) for path, body in bodies().items()} == {path: len(BODIES[path]) for path in PATHS}


def test_every_reason_to_stand_is_explained() -> None:
    explained = set(re.findall(r"`([a-z ]+)`", STATE))
    assert {each.value for each in StandReason} <= explained


def ranges() -> dict[str, str]:
    """Return the allowed values by the word of a body."""
    table = SAID[SAID.index("Allowed values; the robot") : SAID.index("Answers are maps;")]
    return {
        word: text
        for words, text in re.findall(r"^\| (`.*?`) \| (.*?) \|$", table, re.MULTILINE)
        for word in re.findall(r"`(.*?)`", words)
    }


def in_words(hint: Any) -> str:
    """Return the allowed values of an annotated type."""
    if get_origin(hint) is not Annotated:
        (inner,) = (each for each in get_args(hint) if each is not type(None))
        return f"{in_words(inner)}, or null"
    kind, check = get_args(hint)
    match check:
        case Bytes(length):
            return f"{length} bytes"
        case BytesUpTo(most):
            return f"1 to {most} bytes"
        case Int(least, most):
            return f"whole number, {least} to {most}"
        case Float(most, unit):
            return f"number, {-most:g} to {most:g} {unit}".strip()
        case Text(most, least):
            return f"text, {least} to {most} printable characters"
        case OneOf(values):
            return " or ".join(filter(None, (", ".join(map(str, values[:-1])), str(values[-1]))))
        case Flag():
            return "true or false"
        case GoalField():
            features = "`[features, tolerance]`: up to 16 `[name, value]`, and a number; numbers -1e+06 to 1e+06"
            return f"`name`; `rla`; or {features}"
        case UpTo(most):
            return f"list of up to {most}: {in_words(get_args(kind)[0])}"
    raise AssertionError(check)


@pytest.mark.parametrize("path", sorted(PATHS))
def test_the_range_of_every_place_is_written(path: str) -> None:
    written = ranges()
    for word, check in zip(bodies()[path], BODIES[path].values(), strict=True):
        name = word.removesuffix(" or null")
        takes = in_words(check.hint)
        if name != word:
            takes = takes.removesuffix(", or null")
        if path == "/file" and name == "name":
            assert "for `/file` up to 128" in written[name]
            assert takes == "text, 1 to 128 printable characters"
            continue
        assert written[name].split("; the guard")[0].split("; for `/file`")[0] == takes, word


def test_every_key_of_hello_is_explained(desk: ChannelFixture) -> None:
    keys = {*desk.handler._hello, "tick"}
    table = SAID[SAID.index("`/hello` answers:") :]
    explained = set(re.findall(r"`(\w+)`", "".join(re.findall(r"^\| `.*?` \|", table, re.MULTILINE))))
    assert keys <= explained, keys - explained


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
    keys = set(keys_in(HEALTH.plain_of(ILL)))
    explained = set(re.findall(r"`(\w+)`", HEALTH_PART))
    assert keys <= explained, keys - explained


def test_the_version_is_the_one_that_the_robot_speaks() -> None:
    assert f"is the version of this contract: {VERSION}." in TEXT

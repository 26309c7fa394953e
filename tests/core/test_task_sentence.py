"""The sentence of a task to its teacher, from its file to the page's introduction."""

from pathlib import Path

import pytest

from hal.settings import SettingsError
from hal.settings_files import find_config
from kurt2rt.channel.protocol.codec import decode_answer, encode_answer
from kurt2rt.channel.protocol.hello import hello_of
from kurt2rt.channel.server.channel import describe_robot
from kurt2rt.core.perception.sensor_words import infrared_law
from kurt2rt.core.task_settings import load_task
from tests.channel.channel_fixture import BOOT, ROBOT, TASK, ChannelFixture

SHIPPED = sorted(path.stem for path in find_config("tasks", "circle").parent.glob("*.yaml"))


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_task_says_what_it_is(name: str) -> None:
    what = load_task(name).what
    assert what is not None
    assert what.split()[0] in ("Teach", "Lead")


def task_file(folder: Path, what: str) -> Path:
    lines = find_config("tasks", "wall_following").read_text().splitlines()
    path = folder / "mine.yaml"
    path.write_text("\n".join(what if line.startswith("what:") else line for line in lines))
    return path


def test_task_without_a_sentence_is_told_by_its_name(tmp_path: Path) -> None:
    assert load_task(str(task_file(tmp_path, ""))).sentence.endswith("wall following")


def test_sentence_of_two_lines_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="what"):
        load_task(str(task_file(tmp_path, 'what: "one\\ntwo"')))


def test_hello_tells_the_sentence_and_the_law_over_the_wire() -> None:
    told = encode_answer({"tick": 0, **describe_robot(ChannelFixture().runtime, BOOT, simulated=True)})
    hello = hello_of(decode_answer(told))
    assert hello.what == TASK.what
    assert hello.law == infrared_law(ROBOT.infrared)
    assert hello.sensor_words.place("s9") == "front left"
    assert hello.sensor_words.reading("s9", 441.0) == "13 cm"

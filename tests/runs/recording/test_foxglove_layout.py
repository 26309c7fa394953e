"""The layout that one imports into Foxglove names topics and fields that every run records."""

import json
from pathlib import Path
from typing import Any

import pytest

from config import CONFIG_DIR
from kurt2rt.core.teaching.commands import Resume, Teach, Watch
from kurt2rt.runs.recording.foxglove_scene import ROBOT
from kurt2rt.runs.recording.run_folder import segments_in
from kurt2rt.runs.recording.segment_reader import LoggedMessage, SegmentReader
from kurt2rt.runs.recording.topics import LOG, TICK
from tests.channel.grounds import Yard
from tests.runs.recording.desk_recording import NAME, RecordedDesk

LAYOUT: dict[str, Any] = json.loads((CONFIG_DIR / "foxglove" / "kurt2.json").read_text())
PANELS: dict[str, dict[str, Any]] = LAYOUT["configById"]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> list[LoggedMessage]:
    """Return the recorded messages of a simulated robot that learned two lessons."""
    folder: Path = tmp_path_factory.mktemp("runs")
    desk = RecordedDesk(folder, world=Yard())
    inbox = desk.desk.runtime.inbox
    desk.second(counts=200)
    inbox.put(Resume("r-1", "Ann"))
    inbox.put(Teach("t-1", "Ann", "forward"))
    desk.run(1, counts=200)
    inbox.put(Watch("Ann", desk.records[-1].tick))
    desk.run(10, counts=200)
    inbox.put(Teach("t-2", "Ann", "spin_left"))
    desk.second(counts=400)
    desk.recorder.on_question("I know nothing yet, teach me")
    desk.recorder.close()
    (segment,) = segments_in(folder / NAME)
    return list(SegmentReader(segment).messages())


def shown(split: Any) -> list[str]:
    """Return the panels of a layout, from the first to the last."""
    return [split] if isinstance(split, str) else [*shown(split["first"]), *shown(split["second"])]


def paths() -> list[str]:
    """Return the message paths of all panels."""
    plotted = [path["value"] for panel in PANELS.values() for path in panel.get("paths", [])]
    return plotted + [panel["topicPath"] for panel in PANELS.values() if "topicPath" in panel]


def has(content: Any, fields: list[str]) -> bool:
    for field in fields:
        if not isinstance(content, dict) or field not in content:
            return False
        content = content[field]
    return True


def test_each_panel_is_set_up_and_shown_once() -> None:
    assert sorted(shown(LAYOUT["layout"])) == sorted(PANELS)


def test_foxglove_layout_scene_topics_are_recorded(recorded: list[LoggedMessage]) -> None:
    schemas = {each.topic: each.schema for each in recorded}
    drawn = {"foxglove.LaserScan", "foxglove.PoseInFrame", "foxglove.SceneUpdate"}
    assert {schemas[topic] for topic in PANELS["3D!kurt2"]["topics"]} == drawn
    assert PANELS["3D!kurt2"]["followTf"] == ROBOT


def test_the_log_is_recorded(recorded: list[LoggedMessage]) -> None:
    assert PANELS["RosOut!kurt2"]["topicToRender"] == LOG
    assert any(each.topic == LOG for each in recorded)


@pytest.mark.parametrize("path", paths())
def test_each_field_that_is_plotted_or_listed_is_recorded(path: str, recorded: list[LoggedMessage]) -> None:
    topic, *fields = path.split(".")
    assert topic == TICK
    assert any(has(json.loads(each.data), fields) for each in recorded if each.topic == topic)

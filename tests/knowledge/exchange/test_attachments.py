"""Attachments of a run: settings as they were in force, and the knowledge at its start."""

import json
from pathlib import Path

import pytest

from config import CONFIG_DIR
from hal.robot_settings import load_robot, robot_of_json
from hal.settings import SettingsError
from hal.settings_files import find_config, kept_name, settings_override
from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.core.rla.rla import Origin, Phase, Rla
from kurt2rt.core.rla.statistics import Expectation, Statistics
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.knowledge.exchange.attachments import (
    KNOWLEDGE,
    ROBOT,
    TASK,
    KnownLesson,
    collect_attachments,
    decode_lessons,
    decode_statistics,
    encode_statistics,
)
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.run_head import RunHead, decode_head, encode_head


@pytest.mark.parametrize("task", ["errands", "fleeing", "wall_following"])
def test_collect_attachments_task_is_read_back(task: str) -> None:
    settings = load_task(task, changes={"learning.radius": "123.25"})
    robot = load_robot()
    attached = collect_attachments(robot, settings)
    assert TaskSettings.model_validate_json(attached[TASK]) == settings
    assert robot_of_json(attached[ROBOT], "test") == robot


def test_collect_attachments_defaults_are_included() -> None:
    """A replay by a kurt2rt with other defaults would use those otherwise."""
    task = load_task("wall_following")
    assert {"reinforcement", "critic", "mid", "behaviours"}.isdisjoint(task.model_fields_set)
    kept = json.loads(collect_attachments(load_robot(), task)[TASK])
    assert kept["reinforcement"] == task.reinforcement.model_dump(mode="json", exclude_none=True)
    assert kept["critic"] == task.critic
    assert kept.keys().isdisjoint({"mid", "behaviours"})  # which must not be there where they mean nothing


def test_settings_override_finds_only_attachments(tmp_path: Path) -> None:
    for name, data in collect_attachments(load_robot(), load_task("errands")).items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    with settings_override(tmp_path / "settings"):
        assert find_config("mid_levels", "places").is_relative_to(tmp_path)
        with pytest.raises(SettingsError, match=r"circle: .*\bworlds\b"):
            find_config("worlds", "circle")
    assert find_config("mid_levels", "places").is_relative_to(CONFIG_DIR)


def test_collect_attachments_path_gets_a_safe_name(tmp_path: Path) -> None:
    mine = tmp_path / "basic.yaml"
    mine.write_bytes(find_config("situations", "basic").read_bytes())
    task = load_task("wall_following").model_copy(update={"situation": str(mine)})
    for name, data in collect_attachments(load_robot(), task).items():
        path = tmp_path / "kept" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    mine.unlink()
    with settings_override(tmp_path / "kept" / "settings"):
        assert find_config("situations", str(mine)).is_file()


@pytest.mark.parametrize(
    "name", ["", ".", "..", "../../secret", "/etc/secret", "~/secret", "a/b", "/etc/secret.yaml", "x/"]
)
def test_kept_name_stays_in_its_folder(name: str) -> None:
    kept = kept_name(name)
    assert "/" not in kept
    assert kept not in (".", "..")
    assert kept_name(name) != kept_name(f"{name}/other")
    assert kept_name("walls") == "walls.yaml"


def test_decode_lessons_have_their_stamps() -> None:
    origin = Origin("ann-1", "Ann", Phase.SUPERVISED, 7)
    lesson = KnownLesson(RlaCreated(Rla(1, (0.1, 1 / 3), "forward", None, origin)), "2026-11-22T03:00:00Z")
    attached = collect_attachments(load_robot(), load_task("wall_following"), [lesson])
    assert decode_lessons(attached[KNOWLEDGE]) == [lesson]
    with pytest.raises(ValueError, match=r"knowledge\.jsonl"):
        decode_lessons(attached[KNOWLEDGE][:-9])


def test_decode_statistics_are_exact_and_in_order() -> None:
    expectation = Expectation("ann-1", 1, 0.1, b"\x00\xff", b"")
    saved = Statistics({7: 1, 2: 3}, {(7, 2): 1}, {2: 1 / 3, 7: -0.1}, {"best score": 0.3}, {2: expectation})
    again = decode_statistics(encode_statistics(saved))
    assert repr(again) == repr(saved)
    with pytest.raises(ValueError, match="statistics"):
        decode_statistics(b"{}")


def test_decode_head_other_version_is_refused() -> None:
    head = RunHead(
        "0.1", "00ff", "2026-11-22T03:00:00Z", "wall_following", "kurt2", "sim", "", True, True, "", "", {"a": "b"}
    )
    metadata = encode_head(head)
    assert all(isinstance(value, str) for value in metadata.values())
    assert decode_head(metadata) == head
    with pytest.raises(RecordingError, match=r"version 2, this kurt2rt reads version 1; .*\(0\.1\)"):
        decode_head({**metadata, "version": "2"})
    with pytest.raises(RecordingError, match="boot"):
        decode_head({key: value for key, value in metadata.items() if key != "boot"})

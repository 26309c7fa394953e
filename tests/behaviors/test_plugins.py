"""Policies, judges, courses and actions of plug-ins, named by settings."""

import pickle
from contextlib import AbstractContextManager
from pathlib import Path

import pytest

from behaviors.contained_behaviour import failures_of
from behaviors.repertoire import load_repertoire
from config.plugins import loaded_plugins, settings_from_elsewhere
from config.settings import SettingsError
from hal.robot import STANDSTILL
from kurt2rt.core.task_settings import TaskSettings, load_task
from tests.behaviors.helpers import ROBOT, counts, sensed
from tests.plugin_packages import install, write_parts, write_repertoire, write_task


def kept(folder: Path, kind: str, settings: Path) -> AbstractContextManager[None]:
    """Return the context of a replay, which finds the settings by the name of their file."""
    (folder / kind).mkdir()
    settings.rename(folder / kind / settings.name)
    return settings_from_elsewhere(folder)


def refused_task(path: Path) -> str:
    with pytest.raises(SettingsError) as refused:
        load_task(str(path))
    return str(refused.value)


def test_task_takes_parts_by_module_name_and_by_entry_point(plugin_folder: Path) -> None:
    write_parts(plugin_folder, "parts_a")
    install(plugin_folder, "parts", {"judges": {"moving": "parts_a:Moving"}})
    policy = {"kind": "parts_a:Turning", "front_m": 0.2}
    task = load_task(
        str(write_task(plugin_folder, policy=policy, judge={"kind": "moving"}, metric={"kind": "parts_a:Reach"}))
    )
    assert task.policy.build(ROBOT.infrared).choose(counts(s11=0.25), "") == "forward"
    assert [(each.group, each.name) for each in loaded_plugins()] == [
        ("judges", "moving"),
        ("policies", "parts_a:Turning"),
        ("metrics", "parts_a:Reach"),
    ]
    written = task.model_dump_json(serialize_as_any=True, exclude_none=True, exclude={"behaviours"})
    assert TaskSettings.model_validate_json(written) == task
    assert pickle.loads(pickle.dumps(task)) == task  # to a process of a study


@pytest.mark.parametrize(
    ("policy", "told"),
    [
        ({"kind": "parts_b:Turning", "front_m": 2.0}, "policy.front_m: should be less than"),
        ({"kind": "parts_b:Turning", "fornt_m": 0.2}, "policy.fornt_m: no such key; allowed here: kind, front_m"),
        (
            {"kind": "parts_b:Moving"},
            "policy.kind: parts_b:Moving is the class Moving, allowed is a subclass of PolicySettings",
        ),
        (
            {"kind": "turnin"},
            "no kind 'turnin'; give module:Name, or one of: circle, .*, turning; did you mean turning",
        ),
        ({"kind": "no_parts:Turning"}, "policy.kind: there is no module 'no_parts' on Python's path or in "),
    ],
)
def test_task_with_an_unusable_policy_names_key_and_reason(
    policy: dict[str, object], told: str, plugin_folder: Path
) -> None:
    write_parts(plugin_folder, "parts_b")
    install(plugin_folder, "parts", {"policies": {"turning": "parts_b:Turning"}})
    path = write_task(plugin_folder, policy=policy)
    said = refused_task(path)
    assert said.startswith(f"{path}: policy.")
    with pytest.raises(SettingsError, match=told):
        load_task(str(path))


def test_task_of_a_recording_does_without_its_plugins(plugin_folder: Path) -> None:
    policy = {"kind": "parts_c:Turning", "front_m": 0.2}
    write_parts(plugin_folder, "parts_c")
    with kept(plugin_folder, "tasks", write_task(plugin_folder, policy=policy)):
        task = load_task("mine")
        assert task.policy.model_dump() == policy
    assert loaded_plugins() == ()
    with pytest.raises(SettingsError, match="parts_c:Turning: belongs to a recording or package"):
        task.policy.build(ROBOT.infrared)


def test_action_of_a_plugin_drives_and_is_lost_after_an_error(plugin_folder: Path) -> None:
    write_parts(plugin_folder, "parts_d")
    wiggle = {"kind": "parts_d:Wiggling", "name": "wiggle", "speed_m_s": 0.2, "fails_at_tick": 3}
    repertoire = load_repertoire(str(write_repertoire(plugin_folder, wiggle)), ROBOT)
    action = repertoire["wiggle"]
    action.start()
    assert [action.step(sensed()), action.step(sensed())] == [(-0.2, 0.2)] * 2
    assert not action.lost
    assert failures_of(repertoire.values()) == ""
    assert action.step(sensed()) == STANDSTILL
    action.start()
    assert (action.step(sensed()), action.lost, action.finished) == (STANDSTILL, True, False)
    assert failures_of(repertoire.values()) == (
        "action wiggle of the plug-in parts_d:Wiggling: RuntimeError: it is dizzy"
    )


@pytest.mark.parametrize(
    ("action", "told"),
    [
        ({"name": "wiggle", "speed_m_s": 0.0}, r"\(wiggle\): parts_e:Wiggling cannot build it: .*is 0"),
        ({"name": "wiggle", "speed": 0.1}, r"plugin\.speed: no such key; allowed here: kind, name, speed_m_s, "),
        ({"name": "forward"}, "two actions share the name forward"),
    ],
)
def test_unusable_action_of_a_plugin_names_its_entry(action: dict[str, object], told: str, plugin_folder: Path) -> None:
    write_parts(plugin_folder, "parts_e")
    path = write_repertoire(plugin_folder, {"kind": "parts_e:Wiggling", **action})
    with pytest.raises(SettingsError, match=told):
        load_repertoire(str(path), ROBOT)


def test_recording_imports_no_action_of_a_plugin(plugin_folder: Path) -> None:
    write_parts(plugin_folder, "parts_f")
    path = write_repertoire(plugin_folder, {"kind": "parts_f:Wiggling", "name": "wiggle"})
    with kept(plugin_folder, "repertoires", path):
        with pytest.raises(SettingsError, match="may not import it; install it as a package"):
            load_repertoire("actions", ROBOT)
        install(plugin_folder, "parts", {"behaviours": {"wiggling": "parts_f:Wiggling"}})
        assert "wiggle" in load_repertoire("actions", ROBOT)

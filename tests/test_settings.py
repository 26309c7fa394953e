"""Settings files: every shipped one loads, and whatever is wrong with one is told in one line."""

import copy
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import yaml

from behaviors.policies.policy import PolicySettings
from behaviors.repertoire import load_repertoire
from behaviors.repertoire_settings import RESERVED, RepertoireSettings
from config import CONFIG_DIR
from hal.robot_settings import RobotSettings, SpeedMode, load_robot
from hal.settings import Settings, SettingsError, content_of, find_config, load_settings
from hal.settings_by_kind import find_kind
from kurt2rt.checks.faults.table import FaultTable
from kurt2rt.core.critic.settings import CriticSettings
from kurt2rt.core.mid.settings import MidSettings, load_mid_level
from kurt2rt.core.perception.definition import SituationDefinition, load_situation
from kurt2rt.core.rla.rla import ASK
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.core.teacher_settings import TeacherProfile
from simbridge.wire.settings import WireSettings
from simbridge.worlds.world_loading import load_world
from simbridge.worlds.world_settings import WorldSettings

SCHEMAS: dict[str, type[Settings]] = {
    "robots": RobotSettings,
    "tasks": TaskSettings,
    "teachers": TeacherProfile,
    "situations": SituationDefinition,
    "repertoires": RepertoireSettings,
    "worlds": WorldSettings,
    "wires": WireSettings,
    "faults": FaultTable,
    "critics": CriticSettings,
    "mid_levels": MidSettings,
}
ROBOT = (CONFIG_DIR / "robots" / "kurt2.yaml").read_text()
TASK = (CONFIG_DIR / "tasks" / "wall_following.yaml").read_text()
REPERTOIRE = (CONFIG_DIR / "repertoires" / "basic.yaml").read_text()


def refusal(path: Path, schema: type[Settings]) -> str:
    """Return the error line of a file that cannot be used, without the file name at its beginning."""
    with pytest.raises(SettingsError) as caught:
        load_settings(path, schema)
    line = str(caught.value)
    assert len(line.splitlines()) == 1
    assert line.startswith(f"{path}: ")
    return line.removeprefix(f"{path}: ")


# What is shipped


@pytest.mark.parametrize("kind", SCHEMAS)
def test_every_shipped_file_loads(kind: str) -> None:
    paths = sorted((CONFIG_DIR / kind).glob("*.yaml"))
    assert paths
    for path in paths:
        load_settings(path, SCHEMAS[kind])


def test_shipped_files_are_found_by_name_and_fit_together() -> None:
    robot = load_robot("kurt2")
    task = load_task("wall_following")
    assert robot.can.speed_mode is SpeedMode.SPEED_CM
    assert load_situation(task.situation, robot.infrared.names).dimensions == 72
    assert "forward" in load_repertoire(task.repertoire, robot)
    assert {load_world(world, robot).name for world in task.exam.worlds} == {"A", "B", "C"}


def test_unknown_robot_is_refused_with_known_names_a_path_loads(tmp_path: Path) -> None:
    mine = tmp_path / "mine.yaml"
    mine.write_text(ROBOT.replace("kurt2-indoor", "mine", 1))
    assert load_robot(str(mine)).name == "mine"
    for missing in ("kurt3", str(tmp_path / "other.yaml"), str(tmp_path), ""):
        with pytest.raises(
            SettingsError,
            match=r"no such file in robots; give a path to a \.yaml file or one of: kurt2(; did you mean kurt2\?)?$",
        ):
            find_config("robots", missing)


# Every key, one at a time


class Place(NamedTuple):
    """A key somewhere inside a file."""

    kind: str
    path: tuple[str | int, ...]


def shortened(content: Any) -> Any:
    """Return a file's content with one item of each kind in a list of mappings."""
    if isinstance(content, dict):
        return {key: shortened(value) for key, value in content.items()}
    if isinstance(content, list) and all(isinstance(item, dict) for item in content):
        return list({item.get("kind"): shortened(item) for item in reversed(content)}.values())
    return content


def places(content: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Paths of all keys inside."""
    pairs: Any = content.items() if isinstance(content, dict) else enumerate(content)
    for key, value in pairs:
        if isinstance(content, dict):
            yield (*path, key)
        if isinstance(value, (dict, list)):
            yield from places(value, (*path, key))


CONTENTS: dict[str, Any] = {
    "robots": shortened(yaml.safe_load(ROBOT)),
    "tasks": shortened(yaml.safe_load((CONFIG_DIR / "tasks" / "wall_following.yaml").read_text())),
    "situations": shortened(yaml.safe_load((CONFIG_DIR / "situations" / "basic.yaml").read_text())),
    "repertoires": shortened(yaml.safe_load(REPERTOIRE)),
}
PLACES = [Place(kind, path) for kind, content in CONTENTS.items() for path in places(content)]
SOME_AND_ALL = [pytest.param(PLACES[::3], id="some"), pytest.param(PLACES, id="all", marks=pytest.mark.deep)]


def changed(place: Place, folder: Path, *, key: str | None = None, **value: object) -> Path:
    """Write a file with one key renamed, or with another value for it; return its path."""
    content = copy.deepcopy(CONTENTS[place.kind])
    inside, last = content, place.path[-1]
    for part in place.path[:-1]:
        inside = inside[part]
    if key is not None:
        inside[key] = inside.pop(last)
    else:
        inside[last] = value["value"]
    path = folder / "changed.yaml"
    path.write_text(json.dumps(content))  # JSON is YAML
    return path


def named(line: str) -> list[str]:
    """Parts of the key that a refusal begins with."""
    return line.split(": ", 1)[0].split(".")


def test_the_files_to_be_spoilt_are_right_before(tmp_path: Path) -> None:
    for kind, content in CONTENTS.items():
        path = tmp_path / f"{kind}.yaml"
        path.write_text(json.dumps(content))
        load_settings(path, SCHEMAS[kind])
    assert len(PLACES) > 100


@pytest.mark.parametrize("some", SOME_AND_ALL)
def test_misspelt_key_is_refused_with_the_allowed_keys(some: list[Place], tmp_path: Path) -> None:
    for place in some:
        right = str(place.path[-1])
        line = refusal(changed(place, tmp_path, key=f"{right}x"), SCHEMAS[place.kind])
        if right == "kind":  # it says which schema the item has
            assert line.startswith(f"{'.'.join(map(str, place.path[:-1]))}: the key 'kind' is missing"), place
            continue
        assert named(line)[-1] == f"{right}x", place
        assert set(map(str, place.path[:-1])) <= set(named(line)), place
        allowed = line.split("no such key; allowed here: ")[1].split(" (and ")[0].split(", ")
        assert right in allowed, place
        inside = CONTENTS[place.kind]
        for part in place.path[:-1]:
            inside = inside[part]
        assert set(inside) <= set(allowed), place


@pytest.mark.parametrize("some", SOME_AND_ALL)
def test_a_key_without_a_value_is_named(some: list[Place], tmp_path: Path) -> None:
    for place in some:
        line = refusal(changed(place, tmp_path, value=None), SCHEMAS[place.kind])
        assert place.path[-1] == "kind" or named(line)[-1] == place.path[-1], place


# Values


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("cycle_s: 0.01 ", "cycle_s: .nan ", "can.cycle_s: Input should be a finite number (found nan)"),
        ("cycle_s: 0.01 ", "cycle_s: .inf ", "can.cycle_s: Input should be a finite number (found inf)"),
        ("cycle_s: 0.01 ", "cycle_s: 10 ms ", "can.cycle_s: Input should be a valid number (found '10 ms')"),
        ("cycle_s: 0.01 ", "cycle_s: '0.01' ", "can.cycle_s: Input should be a valid number (found '0.01')"),
        ("cycle_s: 0.01 ", "cycle_s: true ", "can.cycle_s: Input should be a valid number (found True)"),
        ("cycle_s: 0.01 ", "cycle_s: 10.1 ", "can.cycle_s: Input should be less than or equal to 10 (found 10.1)"),
        ("cycle_s: 0.01 ", "cycle_s: 0 ", "can.cycle_s: Input should be greater than 0 (found 0)"),
        (
            "floor_counts: 70",
            "floor_counts: 70.5",
            "infrared.floor_counts: Input should be a valid integer (found 70.5)",
        ),
        (
            "floor_counts: 70",
            "floor_counts: .nan",
            "infrared.floor_counts: Input should be a valid integer (found nan)",
        ),
        ("floor_counts: 70", "floor_counts: 1024", "infrared.floor_counts: Input should be less than or equal to 1023"),
        ("mode: SPEED_CM", "mode: FAST", "can.speed_mode: Input should be 'RAW', 'SPEED' or 'SPEED_CM' (found 'FAST')"),
        (
            "channel: ADC07",
            "channel: ADC15",
            "infrared.sensors.0.channel: Value error, channel must be ADC00 to ADC11, ADC14 or BDC00 to BDC15",
        ),
        *(
            (
                "channel: ADC07",
                f"channel: {current}",
                f"infrared.sensors.0.channel: Value error, channel {current} carries a motor current; use another one",
            )
            for current in ("ADC12", "ADC13")
        ),
        ("channel: ADC07", "channel: ADC08", "infrared: Value error, two sensors share the channel ADC08"),
        ("name: s1,", "name: s2,", "infrared: Value error, two sensors share the name s2"),
        ("far_m: 0.60", "far_m: 0.05", "must hold: fold_back_to_m < fold_back_from_m <= near_m < far_m"),
        ("raw_drive: [0, 400", "raw_drive: [400, 0", "motors: Value error, raw_drive must rise"),
        (
            "raw_drive: [0, 400",
            "raw_drive: [400",
            "motors: Value error, raw_drive and raw_speed_m_s must be of the same",
        ),
        ("  maximum_speed_m_s: 0.6", "  maximum_speed_m_s: 1.0", "allowed is at most motors.maximum_speed_m_s (0.9)"),
        (
            "  - {name: front left, end: front}",
            "  - front left",
            "bumpers.0: Input should be an object (found 'front left'",
        ),
        ("end: front}", "end: side}", "bumpers.0.end: Input should be 'front' or 'rear' (found 'side')"),
        ("  cycle_s: 0.01 ", "  #", "can.cycle_s: this key is missing"),
    ],
)
def test_a_wrong_value_is_named_with_its_key_and_what_is_allowed(old: str, new: str, told: str, tmp_path: Path) -> None:
    assert old in ROBOT
    path = tmp_path / "robot.yaml"
    path.write_text(ROBOT.replace(old, new, 1))
    assert told in refusal(path, RobotSettings)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            "gain_per_m",
            "gian_per_m",
            "no such key; allowed here: kind, name, front_sensor, back_sensor, distance_m, speed_m_s",
        ),
        ("angle_deg", "angle", "no such key; allowed here: kind, name, angle_deg, speed_m_s"),
        (
            "kind: motor",
            "kind: motr",
            "actions.0: Input tag 'motr' found using 'kind' does not match any of the expected",
        ),
        ("kind: motor", "knd: motor", "actions.0: the key 'kind' is missing"),
        ("name: back,", "name: forward,", "two actions share the name forward"),
        ("name: back,", "name: ask,", "actions.7.motor.name: Value error, ask stands for an action that was withdrawn"),
        ("name: back,", "name: go back,", "actions.7.motor.name: String should match pattern"),
    ],
)
def test_a_wrong_action_is_explained_by_its_own_kind(old: str, new: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "repertoire.yaml"
    path.write_text(REPERTOIRE.replace(old, new, 1))
    assert told in refusal(path, RepertoireSettings)


def test_reserved_action_name_is_the_name_of_a_withdrawn_action() -> None:
    assert RESERVED == ASK


@pytest.mark.parametrize(
    ("behaviours", "told"),
    [
        ("[]", "behaviours: "),
        ("['']", "behaviours.0: "),
        ("[turn_left, Turn left]", "behaviours.1: "),
        ("[turn_left, turn_left]", "each name may stand here once"),
        ("turn_left", "behaviours: "),
    ],
)
def test_task_with_bad_behaviour_names_is_refused(behaviours: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "task.yaml"
    path.write_text(TASK.replace("repertoire: basic", f"repertoire: basic\nbehaviours: {behaviours}", 1))
    assert told in refusal(path, TaskSettings)


@pytest.mark.parametrize(
    ("behaviours", "told"),
    [
        (
            ["straight_on", "about_turn"],
            "policy: Value error, streets knows the behaviours straight_on, turn_left, ",
        ),
        (None, "turn_right, and not ''"),
        ([f"turn_{number}" for number in range(65)], "behaviours: Tuple should have at most 64 items"),
    ],
)
def test_a_policy_is_asked_only_for_what_it_knows(behaviours: list[str] | None, told: str, tmp_path: Path) -> None:
    task = yaml.safe_load((CONFIG_DIR / "tasks" / "streets.yaml").read_text())
    task["behaviours"] = behaviours
    if behaviours is None:
        del task["behaviours"]
    path = tmp_path / "task.yaml"
    path.write_text(yaml.safe_dump(task))
    assert told in refusal(path, TaskSettings)


@pytest.mark.parametrize("name", ["wall_following", "streets"])
def test_task_as_json_keeps_every_key_of_policy_and_course(name: str) -> None:
    written = json.loads(load_task(name).model_dump_json())
    file = yaml.safe_load((CONFIG_DIR / "tasks" / f"{name}.yaml").read_text())
    assert (written["policy"], written["course"]) == (file["policy"], file["course"])


def test_task_without_behaviours_has_one_without_a_name(tmp_path: Path) -> None:
    assert load_task("wall_following").behaviours == ("",)
    path = tmp_path / "task.yaml"
    path.write_text(TASK.replace("repertoire: basic", "repertoire: basic\nbehaviours: [turn_left, turn_right]", 1))
    assert load_task(str(path)).behaviours == ("turn_left", "turn_right")


@pytest.mark.parametrize(
    ("mid", "told"),
    [
        ("turns", ""),
        ("Turns", "mid.name: "),
        ("", "mid: Value error, give a name or settings, or leave the key out where there is no mid level"),
        ("{name: mine}", "mid.settings.junctions: this key is missing"),
    ],
)
def test_a_task_may_have_a_mid_level_by_name_or_by_its_settings(mid: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "task.yaml"
    task = (CONFIG_DIR / "tasks" / "streets.yaml").read_text()
    path.write_text(f"{task}mid: {mid}\n")
    if told:
        assert told in refusal(path, TaskSettings)
    else:
        assert load_task(str(path)).mid == mid
        written_out = load_task(str(path)).model_copy(update={"mid": load_mid_level(mid)})
        path.write_text(written_out.model_dump_json(exclude_none=True))
        assert load_task(str(path)).mid == load_mid_level(mid)


def test_a_mid_level_commands_behaviours_that_have_names(tmp_path: Path) -> None:
    path = tmp_path / "task.yaml"
    path.write_text(f"{TASK}mid: turns\n")
    assert "mid: Value error, a mid level commands behaviours by their names" in refusal(path, TaskSettings)


def test_tasks_of_one_system_share_behaviours_and_situation() -> None:
    shared: dict[str, set[tuple[str, frozenset[str]]]] = {}
    for path in sorted((CONFIG_DIR / "tasks").glob("*.yaml")):
        task = load_task(path.stem)
        shared.setdefault(task.system_name, set()).add((task.situation, frozenset(task.behaviours)))
    assert all(len(taught) == 1 for taught in shared.values()), shared


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            "kind: wall_following",
            "kind: wall_folowing",
            "policy.kind: there is no kind 'wall_folowing'; give one of: circle, eight, fleeing, streets, wall",
        ),
        ("kind: wall_following", "kind: policy", "policy.kind: there is no kind 'policy'; give one of: circle, eight"),
        ("kind: wall_following", "kind: 7", "policy.kind: Input should be a valid string (found 7)"),
        (
            "kind: laps",
            "kind: lap",
            "course.kind: there is no kind 'lap'; give one of: eights, ",
        ),
        ("front_m: 0.25", "front_m: 2.5", "policy.front_m: Input should be less than or equal to 0.6 (found 2.5)"),
        ("front_m: 0.25", "fornt_m: 0.25", "policy.fornt_m: no such key; allowed here: kind, wanted_m, tolerance_m"),
        ("  wanted_m: 0.365", "  #", "course.wanted_m: this key is missing"),
        ("course:\n", "course: laps\nplaces:\n", "places: no such key; allowed here: name"),
    ],
)
def test_a_policy_or_a_course_is_explained_by_its_own_kind(old: str, new: str, told: str, tmp_path: Path) -> None:
    task = (CONFIG_DIR / "tasks" / "wall_following.yaml").read_text()
    assert old in task
    path = tmp_path / "task.yaml"
    path.write_text(task.replace(old, new, 1))
    assert told in refusal(path, TaskSettings)


def test_plain_reading_replaces_the_learning_settings_only() -> None:
    task, plain = load_task("wall_following"), load_task("wall_following", plain=True)
    assert plain.learning == task.plain
    assert (plain.learning.past_weight, plain.learning.insert_beyond_share, plain.learning.minimum_action_s) == (
        1,
        1,
        0,
    )
    assert plain.model_copy(update={"learning": task.learning}) == task


@pytest.mark.parametrize("key", ["learning.radius", "learning"])
def test_setting_without_effect_on_the_plain_reading_is_refused(key: str) -> None:
    with pytest.raises(SettingsError, match=rf"streets.yaml: {key} changes nothing .*; give plain"):
        load_task("streets", plain=True, changes={key: "300"})
    assert load_task("streets", plain=True, changes={"plain.radius": "300"}).learning.radius == 300.0


def test_a_problem_of_the_file_is_not_blamed_on_what_was_set(tmp_path: Path) -> None:
    path = tmp_path / "task.yaml"
    path.write_text(TASK.replace("past_weight", "passed_weight", 1))
    with pytest.raises(SettingsError) as caught:
        load_task(str(path), changes={"learning.radius": "300"})
    assert "--set" not in str(caught.value)


def test_misspelt_kind_is_refused_though_another_fails_to_import(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "some_policies"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "broken.py").write_text("import no_such_module\n\n\nclass BrokenSettings(PolicySettings):\n    ...\n")
    (package / "helpers.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ValueError, match=r"there is no kind 'brokn'; give one of: broken$"):
        find_kind("some_policies", "brokn", PolicySettings)  # type: ignore[type-abstract]


def test_a_key_can_be_given_another_value_than_the_file_s() -> None:
    task = load_task("streets", changes={"learning.radius": "300", "exam.worlds": "[streets-3]"})
    assert task.learning.radius == 300.0
    assert task.exam.worlds == ("streets-3",)
    assert task.model_copy(update={"learning": load_task("streets").learning}).teaching == load_task("streets").teaching


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("learning.radios", "3", "learning.radios: no such key; allowed here: radius"),
        (
            "learning.radius",
            "near",
            "learning.radius: Input should be a valid number (found 'near'); --set learning.radius says so",
        ),
        ("learning", "{radius: 3}", "learning.past_weight: this key is missing (and 2 more); --set learning says so"),
        ("policy.kind", "walls", "policy.kind: there is no kind 'walls'; give one of: circle, "),
        ("learning.radius", "-1", "learning.radius: Input should be greater than 0 (found -1)"),
        ("names.first", "x", "names: no such key; allowed here: name"),
        ("name.first", "x", "name.first: no such key; nothing stands within name"),
        ("exam.worlds.0", "a", "exam.worlds.0: no such key; nothing stands within exam.worlds"),
        ("learning.radius", "[", "learning.radius: the value '[' of --set is not valid YAML: "),
    ],
)
def test_a_value_from_elsewhere_is_checked_as_the_file_s_own(key: str, value: str, told: str) -> None:
    with pytest.raises(SettingsError) as caught:
        load_task("streets", changes={key: value})
    assert "streets.yaml: " in str(caught.value)
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_several_mistakes_are_counted(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(ROBOT.replace("cycle_s: 0.01 ", "cycle_s: x ").replace("far_m: 0.60", "far_m: x"))
    assert refusal(path, RobotSettings).endswith("(found 'x') (and 1 more)")


# Whole files


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"", "holds NoneType, allowed is a mapping with the keys: name, can, geometry"),
        (b"- 1\n- 2\n", "holds list, allowed is a mapping with the keys: name, can, geometry"),
        (b"hello\n", "holds str, allowed is a mapping"),
        (b"a: 1\nb: 2\na: 3\n", "not valid YAML: key 'a' stands twice"),
        (b"b: {a: 1, c: {d: 1, d: 1}}\n", "key 'd' stands twice"),
        (b"1: x\n", "key 1 is not a text"),
        (b"2020-01-01: x\n", "is not a text"),
        (b"? [a, b]\n: x\n", "key ['a', 'b'] is not a text"),
        (b"? !!binary aGk=\n: x\n", "key b'hi' is not a text"),
        (b'"a\\nb": 1\n', "a b: no such key"),
        (b"name: 2020-99-99\n", 'month must be in 1..12 in "<unicode string>", line 1'),
        (b"name: !!int one\n", "line 1, column 7"),
        (b"name: " + b"1" * 5000, "line 1, column 7"),
        (b"name: 0x" + b"f" * 5000, "not valid YAML: "),
        (b"[" * 600, "not valid YAML: "),
        (b"[\n" * 20_000, "not valid YAML: "),
        pytest.param(b"[" * 20_000, "not valid YAML: ", marks=pytest.mark.deep),
        (b"- " * 20_000, "not valid YAML: "),
        (b"name: &x [*x]\n", "found unconstructable recursive node"),
        (b"name: [1\n", "not valid YAML: while parsing a flow sequence"),
        (b"\tname: x\n", "not valid YAML: while scanning"),
        (b"name: x\n---\nname: y\n", "expected a single document"),
        (b"name: !!python/object:os.system x\n", "could not determine a constructor"),
        (b'name: "\\ud800"\n', "invalid Unicode character escape code"),
        (b"\xff\xfe\x00\x01", "cannot be read ('utf-8' codec can't decode byte 0xff"),
        (b"\x7fELF\x02\x01\x01\x00\x00", "control characters are not allowed"),
        (bytes(range(256)), "cannot be read"),
    ],
)
def test_a_file_that_holds_something_else_is_refused_in_one_line(content: bytes, told: str, tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_bytes(content)
    assert told in refusal(path, RobotSettings)


def test_a_file_that_cannot_be_read_is_refused_in_one_line(tmp_path: Path) -> None:
    assert "Is a directory" in refusal(tmp_path, RobotSettings)
    assert "No such file" in refusal(tmp_path / "gone.yaml", RobotSettings)


def test_settings_are_frozen() -> None:
    robot = load_robot()
    with pytest.raises(ValueError, match="frozen"):
        robot.name = "other"


# Files that would hang or fill the program


def test_a_yaml_alias_bomb_is_refused_before_it_is_expanded(tmp_path: Path) -> None:
    bomb = tmp_path / "bomb.yaml"
    nine = "".join(f"a{n}: &a{n} [{','.join([f'*a{n - 1}'] * 9)}]\n" for n in range(1, 10))
    bomb.write_text(f"a0: &a0 [x,x,x,x,x,x,x,x,x]\n{nine}", encoding="utf-8")
    assert "its aliases repeat values more than 100000 times; write the values out" in refusal(bomb, RobotSettings)


@pytest.mark.parametrize("long", ["x" * 10_000, "{" + "k" * 1000 + ": 1}"], ids=["text", "key"])
def test_text_that_aliases_repeat_is_refused_before_expansion(tmp_path: Path, long: str) -> None:
    bomb = tmp_path / "bomb.yaml"
    bomb.write_text(f"a0: &a0 {long}\na1: &a1 [{'*a0,' * 100}]\na2: [{'*a1,' * 100}]\n", encoding="utf-8")
    assert "its aliases repeat values more than 100000 times" in refusal(bomb, RobotSettings)


def test_a_few_yaml_aliases_are_read(tmp_path: Path) -> None:
    path = tmp_path / "my_repertoire.yaml"
    whole = yaml.safe_dump({"name": "x", "actions": [action := {"kind": "motor"}, action]})
    assert "*id001" in whole
    path.write_text(whole, encoding="utf-8")
    assert content_of(path) == {"name": "x", "actions": [{"kind": "motor"}, {"kind": "motor"}]}


def test_an_asterisk_that_is_no_alias_is_read(tmp_path: Path) -> None:
    path = tmp_path / "my_robot.yaml"
    path.write_text(f"# 2 * 3 *x\n{ROBOT}", encoding="utf-8")
    assert load_settings(path, RobotSettings) == load_robot("kurt2")


def test_a_fifo_given_as_settings_is_refused(tmp_path: Path) -> None:
    fifo = tmp_path / "fifo.yaml"
    os.mkfifo(fifo)
    assert "is a pipe, not a file" in refusal(fifo, RobotSettings)


def test_a_settings_file_too_large_is_refused_unread(tmp_path: Path) -> None:
    large = tmp_path / "large.yaml"
    with large.open("wb") as file:
        file.truncate(10**12)
    assert "has 1000000000000 bytes, allowed are 1000000" in refusal(large, RobotSettings)

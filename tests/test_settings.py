"""Settings files: every shipped one loads, and whatever is wrong with one is told in one line."""

import copy
import errno
import json
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import yaml

from behaviors.policies.policy import PolicySettings
from behaviors.repertoire_settings import RESERVED, RepertoireSettings
from config import CONFIG_DIR
from config.settings import Settings, SettingsError, content_of, load_settings
from config.settings_by_kind import find_kind
from config.settings_files import find_config
from hal.kurt2_settings import Kurt2Settings, load_kurt2
from kurt2rt.core.critic.settings import CriticSettings
from kurt2rt.core.mid.settings import MidSettings, load_mid_level
from kurt2rt.core.perception.definition import SituationDefinition
from kurt2rt.core.rla.rla import ASK
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.core.teacher_settings import TeacherProfile
from kurt2rt.experiments.search.settings import SearchSettings
from simbridge.worlds.world_settings import WorldSettings

SCHEMAS: dict[str, type[Settings]] = {
    "robots": Kurt2Settings,
    "tasks": TaskSettings,
    "teachers": TeacherProfile,
    "situations": SituationDefinition,
    "repertoires": RepertoireSettings,
    "worlds": WorldSettings,
    "critics": CriticSettings,
    "mid_levels": MidSettings,
    "searches": SearchSettings,
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


def test_unknown_robot_is_refused_with_known_names_a_path_loads(tmp_path: Path) -> None:
    mine = tmp_path / "mine.yaml"
    mine.write_text(ROBOT.replace("kurt2-indoor", "mine", 1))
    assert load_kurt2(str(mine)).name == "mine"
    for missing in ("kurt3", str(tmp_path / "other.yaml"), str(tmp_path), ""):
        with pytest.raises(SettingsError, match=r": kurt2(, \w+)*(;.* kurt2\?)?$"):
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
        if right == "kind" and len(place.path) > 1:  # it says which schema the item has
            assert line.startswith(f"{'.'.join(map(str, place.path[:-1]))}: "), place
            assert "'kind'" in line, place
            continue
        assert named(line)[-1] == f"{right}x", place
        assert set(map(str, place.path[:-1])) <= set(named(line)), place
        allowed = re.split(r" \(and |; ", line.split(": ")[2])[0].split(", ")
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
        ("cycle_s: 0.01 ", "cycle_s: .inf ", r"^cycle_s: .*inf\)"),
        ("cycle_s: 0.01 ", "cycle_s: '0.01' ", r"^cycle_s: .*'0.01'\)"),
        ("cycle_s: 0.01 ", "cycle_s: true ", r"^cycle_s: .*True\)"),
        ("cycle_s: 0.01 ", "cycle_s: 10.1 ", r"^cycle_s: .*10\.1\)"),
        ("cycle_s: 0.01 ", "cycle_s: 0 ", r"^cycle_s: .*0\)"),
        ("floor_counts: 70", "floor_counts: 70.5", r"^infrared\.floor_counts: .*70\.5\)"),
        ("floor_counts: 70", "floor_counts: 1024", r"^infrared\.floor_counts: .*1023"),
        ("mode: SPEED_CM", "mode: FAST", r"^can\.speed_mode: .*'FAST'\)"),
        ("channel: ADC07", "channel: ADC15", r"^infrared\.sensors\.0\.channel: .*ADC14"),
        *(
            ("channel: ADC07", f"channel: {current}", rf"^infrared\.sensors\.0\.channel: .*{current}")
            for current in ("ADC12", "ADC13")
        ),
        ("channel: ADC07", "channel: ADC08", "^infrared: .*channel ADC08"),
        ("name: s1,", "name: s2,", "^infrared: .*name s2"),
        ("far_m: 0.60", "far_m: 0.05", "^infrared: .*near_m < far_m"),
        ("raw_drive: [0, 400", "raw_drive: [400, 0", "^motors: .*raw_drive"),
        ("raw_drive: [0, 400", "raw_drive: [400", "^motors: .*raw_drive .*raw_speed_m_s"),
        ("  maximum_speed_m_s: 0.6", "  maximum_speed_m_s: 1.0", r"motors\.maximum_speed_m_s \(0\.9\)"),
        ("  - {name: front left, end: front}", "  - front left", r"^bumpers\.0: .*'front left'"),
        ("end: front}", "end: side}", r"^bumpers\.0\.end: .*'front' .*'rear' .*'side'"),
        ("cycle_s: 0.01 ", "  #", r"^cycle_s: "),
    ],
)
def test_a_wrong_value_is_named_with_its_key_and_what_is_allowed(old: str, new: str, told: str, tmp_path: Path) -> None:
    assert old in ROBOT
    path = tmp_path / "robot.yaml"
    path.write_text(ROBOT.replace(old, new, 1))
    assert re.search(told, refusal(path, Kurt2Settings))


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            "kind: motor",
            "kind: motr",
            r"^actions\.0\.plugin\.kind: .*'motr'; .*: motor, keep_distance, .*did you mean motor\?",
        ),
        ("name: back,", "name: forward,", r"\bforward\b"),
        ("name: back,", "name: ask,", r"^actions\.7\.motor\.name: .*\bask\b"),
        ("name: back,", "name: go back,", r"^actions\.7\.motor\.name: "),
    ],
)
def test_a_wrong_action_is_explained_by_its_own_kind(old: str, new: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "repertoire.yaml"
    path.write_text(REPERTOIRE.replace(old, new, 1))
    assert re.search(told, refusal(path, RepertoireSettings))


def test_reserved_action_name_is_the_name_of_a_withdrawn_action() -> None:
    assert RESERVED == ASK


@pytest.mark.parametrize(
    ("behaviours", "told"),
    [
        ("[]", "behaviours: "),
        ("['']", "behaviours.0: "),
        ("[turn_left, Turn left]", "behaviours.1: "),
        ("[turn_left, turn_left]", "^behaviours: "),
        ("turn_left", "behaviours: "),
    ],
)
def test_task_with_bad_behaviour_names_is_refused(behaviours: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "task.yaml"
    path.write_text(TASK.replace("repertoire: basic", f"repertoire: basic\nbehaviours: {behaviours}", 1))
    assert re.search(told, refusal(path, TaskSettings))


@pytest.mark.parametrize(
    ("behaviours", "told"),
    [
        (["straight_on", "about_turn"], "^policy: .*straight_on, turn_left, "),
        (None, "^policy: .*turn_right, .*''"),
        ([f"turn_{number}" for number in range(65)], "^behaviours: .*64"),
    ],
)
def test_a_policy_is_asked_only_for_what_it_knows(behaviours: list[str] | None, told: str, tmp_path: Path) -> None:
    task = yaml.safe_load((CONFIG_DIR / "tasks" / "streets.yaml").read_text())
    task["behaviours"] = behaviours
    if behaviours is None:
        del task["behaviours"]
    path = tmp_path / "task.yaml"
    path.write_text(yaml.safe_dump(task))
    assert re.search(told, refusal(path, TaskSettings))


@pytest.mark.parametrize(
    ("mid", "told"),
    [("turns", ""), ("Turns", "mid.name: "), ("", "^mid: "), ("{name: mine}", r"^mid\.settings\.junctions: ")],
)
def test_a_task_may_have_a_mid_level_by_name_or_by_its_settings(mid: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "task.yaml"
    task = (CONFIG_DIR / "tasks" / "streets.yaml").read_text()
    path.write_text(f"{task}mid: {mid}\n")
    if told:
        assert re.search(told, refusal(path, TaskSettings))
    else:
        assert load_task(str(path)).mid == mid
        written_out = load_task(str(path)).model_copy(update={"mid": load_mid_level(mid)})
        path.write_text(written_out.model_dump_json(exclude_none=True))
        assert load_task(str(path)).mid == load_mid_level(mid)


def test_a_mid_level_commands_behaviours_that_have_names(tmp_path: Path) -> None:
    path = tmp_path / "task.yaml"
    path.write_text(f"{TASK}mid: turns\n")
    assert refusal(path, TaskSettings).startswith("mid: ")


@pytest.mark.parametrize("key", ["learning.radius", "learning"])
def test_setting_without_effect_on_the_plain_reading_is_refused(key: str) -> None:
    with pytest.raises(SettingsError, match=rf"streets\.yaml: {key} .*; give paper_defaults"):
        load_task("streets", paper_defaults=True, changes={key: "300"})
    assert load_task("streets", paper_defaults=True, changes={"paper_defaults.radius": "300"}).learning.radius == 300.0


def test_misspelt_kind_is_refused_though_another_fails_to_import(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "some_policies"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "broken.py").write_text("import no_such_module\n\n\nclass BrokenSettings(PolicySettings):\n    ...\n")
    (package / "helpers.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ValueError, match=r"'brokn'; .*: broken$"):
        find_kind("some_policies", "brokn", PolicySettings)  # type: ignore[type-abstract]


def test_set_key_leads_to_a_place_of_a_list() -> None:
    task = load_task("fleeing", changes={"learning.weights.2.weight": "0.5"})
    assert [group.weight for group in task.learning.weights] == [0.97, 0.0, 0.5]


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("learning.radius", "near", r"learning\.radius: .*'near'.*--set learning\.radius"),
        ("learning", "{radius: 3}", r"learning\.history_weight: .* 2 .*--set learning"),
        ("policy.kind", "walls", r"policy\.kind: .*'walls'; .*: circle, "),
        ("learning.radius", "-1", r"learning\.radius: .*-1\)"),
        ("learning.radius", "[", r"learning\.radius: .*'\['.*--set.*YAML"),
    ],
)
def test_a_value_from_elsewhere_is_checked_as_the_file_s_own(key: str, value: str, told: str) -> None:
    with pytest.raises(SettingsError) as caught:
        load_task("streets", changes={key: value})
    assert "streets.yaml: " in str(caught.value)
    assert re.search(told, str(caught.value))
    assert "\n" not in str(caught.value)


# Whole files


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"? [a, b]\n: x\n", r"YAML: key \['a', 'b'\]"),
        (b'"a\\nb": 1\n', "^a b: "),
        (b"name: 2020-99-99\n", "YAML: .*month.* line 1"),
        (b"name: !!int one\n", "line 1, column 7"),
        (b"name: " + b"1" * 5000, "line 1, column 7"),
        (b"[" * 600, "YAML: "),
        pytest.param(b"[" * 20_000, "YAML: ", marks=pytest.mark.deep),
        (b"name: &x [*x]\n", "YAML: .*recursive"),
        (b"name: x\n---\nname: y\n", "YAML: .*document"),
        (b"name: !!python/object:os.system x\n", "YAML: .*constructor"),
        (b'name: "\\ud800"\n', "YAML: .*escape"),
        (b"\x7fELF\x02\x01\x01\x00\x00", "YAML: .*control"),
        (bytes(range(256)), "utf-8"),
    ],
)
def test_a_file_that_holds_something_else_is_refused_in_one_line(content: bytes, told: str, tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_bytes(content)
    assert re.search(told, refusal(path, Kurt2Settings))


def test_a_file_that_cannot_be_read_is_refused_in_one_line(tmp_path: Path) -> None:
    assert os.strerror(errno.EISDIR) in refusal(tmp_path, Kurt2Settings)
    assert os.strerror(errno.ENOENT) in refusal(tmp_path / "gone.yaml", Kurt2Settings)


# Files that would hang or fill the program


@pytest.mark.parametrize("long", ["x" * 10_000, "{" + "k" * 1000 + ": 1}"], ids=["text", "key"])
def test_text_that_aliases_repeat_is_refused_before_expansion(tmp_path: Path, long: str) -> None:
    bomb = tmp_path / "bomb.yaml"
    bomb.write_text(f"a0: &a0 {long}\na1: &a1 [{'*a0,' * 100}]\na2: [{'*a1,' * 100}]\n", encoding="utf-8")
    assert "100000" in refusal(bomb, Kurt2Settings)


def test_a_few_yaml_aliases_are_read(tmp_path: Path) -> None:
    path = tmp_path / "my_repertoire.yaml"
    whole = yaml.safe_dump({"name": "x", "actions": [action := {"kind": "motor"}, action]})
    assert "*id001" in whole
    path.write_text(whole, encoding="utf-8")
    assert content_of(path) == {"name": "x", "actions": [{"kind": "motor"}, {"kind": "motor"}]}


def test_a_fifo_given_as_settings_is_refused(tmp_path: Path) -> None:
    fifo = tmp_path / "fifo.yaml"
    os.mkfifo(fifo)
    assert "pipe" in refusal(fifo, Kurt2Settings)


def test_a_settings_file_too_large_is_refused_unread(tmp_path: Path) -> None:
    large = tmp_path / "large.yaml"
    with large.open("wb") as file:
        file.truncate(10**12)
    assert re.findall(r"\d{7,}", refusal(large, Kurt2Settings)) == ["1000000000000", "1000000"]

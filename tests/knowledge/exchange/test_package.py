"""Export and import of knowledge: equal bit for bit, or refused."""

import json
import shutil
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from config import CONFIG_DIR
from hal.robot_settings import load_robot
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.events import RlaCreated, RlaRewarded
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.knowledge.exchange.archive import MANIFEST, pack, unpack
from kurt2rt.knowledge.exchange.package import ImportResult, export_knowledge, import_knowledge, read_package
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.event_codec import encode_event
from kurt2rt.knowledge.journal.fold import check_knowledge
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import open_knowledge
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.knowledge.journal.test_writer import largest_file
from tests.knowledge.lessons import STAMP, created, deleted, origin, replaced, undone
from tests.knowledge.refusals import refused

ROBOT = load_robot()
TASK = load_task("wall_following")
NOW = "2026-11-22T03:10:05.000+00:00"


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("taught") / "mine.knowledge"
    with open_knowledge(path, ROBOT, TASK) as journal:
        first, second = (
            RlaCreated(replace(created(number).rla, condition=tuple(number / 3 + 0.1 * place for place in range(72))))
            for number in (1, 2)
        )
        blame = RlaRewarded(1, -1, 390, origin("blame"), (Credit(1, -0.1 - 0.2),))
        events = (first, second, replaced(1, "left", "forward"), blame, undone("create-2"))
        journal.append([JournalEntry(event, STAMP) for event in events])
        journal.checkpoint(Statistics({1: 5}, {(1, 2): 3}, {1: 0.1 + 0.2, 2: 1e-17}, {"first value": 0.5}))
    return path


def export(path: Path, out: Path) -> Path:
    size = export_knowledge(path, out, ROBOT, TASK, stamp=NOW)
    assert out.stat().st_size == size
    return out


def import_from(path: Path, into: Path, task: TaskSettings = TASK) -> ImportResult:
    return import_knowledge(path, into, ROBOT, task, stamp=NOW)


@pytest.fixture(scope="module")
def exported(taught: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(taught, tmp_path_factory.mktemp("exported") / "mine.zip")


def test_import_knowledge_of_an_export_is_equal_bit_for_bit(taught: Path, exported: Path, tmp_path: Path) -> None:
    imported = import_from(exported, tmp_path / "theirs.knowledge")
    assert imported.differing_settings == ()
    with Journal.read_only(taught) as old, Journal.read_only(tmp_path / "theirs.knowledge") as new:
        assert new.entries() == old.entries()
        assert repr(new.statistics()) == repr(old.statistics())
        assert new.binding == old.binding
        assert check_knowledge(new) == []
        (note,) = new.notes().values()
        assert note.startswith("mine.zip, ")
        assert note.count(NOW) == 2
    export(tmp_path / "theirs.knowledge", tmp_path / "again.zip")
    assert (tmp_path / "again.zip").read_bytes() == exported.read_bytes()


def test_export_knowledge_leaves_out_the_delays_of_teachers(taught: Path, exported: Path, tmp_path: Path) -> None:
    copy = tmp_path / "mine.knowledge"
    copy.write_bytes(taught.read_bytes())
    with open_knowledge(copy, ROBOT, TASK) as journal:
        journal.checkpoint(replace(journal.statistics(), answer_delays={"Ann": (80, 90)}))
    assert export(copy, tmp_path / "mine.zip").read_bytes() == exported.read_bytes()


def test_export_knowledge_is_a_zip_with_manifest(exported: Path) -> None:
    with zipfile.ZipFile(exported) as archive:
        manifest = json.loads(archive.read(MANIFEST))
        assert {"knowledge.jsonl", "statistics.json", "settings/task.json"} <= set(archive.namelist())
    assert (manifest["format"], manifest["system"], manifest["rlas"]) == (1, "wall_following", 1)
    assert manifest["features"]["names"][0] == "s1"


def test_read_package_cut_or_changed_is_refused_or_equal(exported: Path, tmp_path: Path) -> None:
    whole, unchanged = exported.read_bytes(), read_package(exported)
    other = tmp_path / "other.zip"
    for place in range(0, len(whole), 97):
        other.write_bytes(whole[:place])
        with pytest.raises(KnowledgeError):
            read_package(other)
        other.write_bytes(whole[:place] + bytes([whole[place] ^ 0x41]) + whole[place + 1 :])
        try:
            found = read_package(other)
        except KnowledgeError:
            continue
        assert replace(found, path=exported) == unchanged  # a byte that means nothing: a file's date, for instance


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(max_size=300))
def test_read_package_nonsense_is_refused_in_one_line(tmp_path: Path, nonsense: bytes) -> None:
    (tmp_path / "nonsense.zip").write_bytes(nonsense)
    with refused(KnowledgeCode.PACKAGE_DAMAGED, tmp_path / "nonsense.zip"):
        read_package(tmp_path / "nonsense.zip")


def rewritten(exported: Path, out: Path, **changes: bytes | None) -> Path:
    """Write a copy of the archive with other files, whose ZIP checksums are right, and return its path."""
    with zipfile.ZipFile(exported) as archive, zipfile.ZipFile(out, "w") as other:
        content: dict[str, bytes | None] = {name: archive.read(name) for name in archive.namelist()}
        for name, data in (content | {each.replace("__", "/"): data for each, data in changes.items()}).items():
            if data is not None:
                other.writestr(name, data)
    return out


def test_read_package_forged_parts_are_refused_by_code(exported: Path, tmp_path: Path) -> None:
    manifest = unpack(exported).manifest
    cases: tuple[tuple[dict[str, bytes | None], KnowledgeCode], ...] = (
        ({"knowledge.jsonl": b""}, KnowledgeCode.PACKAGE_PART_CHANGED),
        ({"knowledge.jsonl": None}, KnowledgeCode.PACKAGE_PART_MISSING),
        ({MANIFEST: None}, KnowledgeCode.PACKAGE_PART_MISSING),
        ({MANIFEST: b"{}"}, KnowledgeCode.PACKAGE_NOT_OURS),
        ({MANIFEST: b"{"}, KnowledgeCode.MANIFEST_DAMAGED),
        ({MANIFEST: json.dumps({**manifest, "format": 2}).encode()}, KnowledgeCode.PACKAGE_OTHER_FORMAT),
    )
    for number, (changes, code) in enumerate(cases):
        with refused(code):
            read_package(rewritten(exported, tmp_path / f"{number}.zip", **changes))
    (tmp_path / "empty.zip").write_bytes(pack({}, {}))
    with refused(KnowledgeCode.PACKAGE_INVALID):
        read_package(tmp_path / "empty.zip")


@pytest.mark.parametrize(
    ("folder", "slash", "extras"),
    [
        ("walls/", "/", ("__MACOSX/walls/._manifest.json", "__MACOSX/._walls", "walls/.DS_Store", "walls/settings/")),
        ("walls\\", "\\", ("walls\\desktop.ini", "walls\\settings\\Thumbs.db")),
        ("", "/", ("settings/",)),
    ],
    ids=["macOS", "Windows", "zip"],
)
def test_read_package_packed_again_is_taken_by_its_hashes(
    exported: Path, tmp_path: Path, folder: str, slash: str, extras: tuple[str, ...]
) -> None:
    again = tmp_path / "again.zip"
    with zipfile.ZipFile(exported) as archive, zipfile.ZipFile(again, "w", zipfile.ZIP_DEFLATED) as other:
        for name in reversed(archive.namelist()):
            other.writestr(f"{folder}{name.replace('/', slash)}", archive.read(name))
        for name in extras:
            other.writestr(name, b"" if name.endswith("/") else b"!")
    assert replace(read_package(again), path=exported) == read_package(exported)


def made_over(
    exported: Path, out: Path, files: Mapping[str, bytes] | None = None, about: Mapping[str, object] | None = None
) -> Path:
    """Write a copy of the archive with a matching manifest, as a hostile author can, and return its path."""
    whole = unpack(exported)
    manifest = {name: value for name, value in whole.manifest.items() if name not in ("format", "files")}
    out.write_bytes(pack({**manifest, **(about or {})}, {**whole.files, **(files or {})}))
    return out


@pytest.mark.parametrize(
    "name", ["settings/../../escaped", "/escaped", "settings\\..\\escaped", "settings/task.json/x"]
)
def test_import_knowledge_escaping_names_are_refused(exported: Path, tmp_path: Path, name: str) -> None:
    other = {"features": {**unpack(exported).manifest["features"], "hash": "another"}}
    evil = made_over(exported, tmp_path / "evil.zip", {name: b"!"}, other)
    with refused(KnowledgeCode.PACKAGE_UNSAFE, evil):
        import_from(evil, tmp_path / "k")
    assert [each.name for each in tmp_path.iterdir()] == ["evil.zip"]


def test_read_package_bomb_is_not_unpacked(tmp_path: Path) -> None:
    bomb = tmp_path / "bomb.zip"
    quick, megabyte = zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED, compresslevel=1), bytes(10**6)
    with quick as archive, archive.open("manifest.json", "w") as part:
        for _ in range(257):
            part.write(megabyte)
    assert bomb.stat().st_size < 2 * 10**6
    with refused(KnowledgeCode.PACKAGE_UNSAFE):
        read_package(bomb)
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_LZMA) as archive:
        archive.writestr("manifest.json", b"{}")
    with refused(KnowledgeCode.PACKAGE_COMPRESSION):
        read_package(bomb)
    with zipfile.ZipFile(bomb, "w") as archive:
        archive.writestr("walls/manifest.json", b"")
        archive.writestr("floors/manifest.json", b"")
    with refused(KnowledgeCode.PACKAGE_DUPLICATE_NAME):
        read_package(bomb)
    with refused(KnowledgeCode.PACKAGE_NOT_A_FILE):
        read_package(tmp_path)


def test_import_knowledge_misfit_lessons_are_refused(exported: Path, tmp_path: Path) -> None:
    lines = unpack(exported).files["knowledge.jsonl"].decode().splitlines()
    stranger = json.dumps({"stamped_at": STAMP, "event": json.loads(encode_event(deleted(77)))})
    short = json.loads(lines[0])
    short["event"]["condition"] = [1.0]
    cases = (
        ([*lines, stranger], KnowledgeCode.LESSON_MISFIT),
        ([json.dumps(short), *lines[1:]], KnowledgeCode.LESSON_MISFIT),
        ([*lines, lines[0]], KnowledgeCode.DUPLICATE_COMMAND),
    )
    for rows, cause in cases:
        unfit = made_over(exported, tmp_path / "unfit.zip", {"knowledge.jsonl": "\n".join(rows).encode()})
        with refused(KnowledgeCode.NOT_BUILT, unfit, cause=cause):
            import_from(unfit, tmp_path / "k")
    assert [each.name for each in tmp_path.iterdir()] == ["unfit.zip"]


NOTHING: dict[str, object] = {
    "uses": [], "transitions": [], "values": [], "numbers": {}, "expectations": [], "answer_delays": {}
}  # fmt: skip


@pytest.mark.parametrize(
    "counts",
    [
        [1],
        {**NOTHING, "uses": [[1, -2.5]]},
        {**NOTHING, "uses": [[1, 2**70]]},
        {**NOTHING, "uses": [[1, True]]},
        {**NOTHING, "values": [[1, float("nan")]]},
        {**NOTHING, "values": [[1, 10**400]]},
        {**NOTHING, "numbers": {"\ud800": 1.0}},
        {**NOTHING, "expectations": [[1, "create-1", 1, 0.5, "AAAA", ""]]},
        {**NOTHING, "answer_delays": {"Ann": [80, -1]}},
    ],
)
def test_read_package_wrong_types_of_counts_are_refused(exported: Path, tmp_path: Path, counts: object) -> None:
    odd = made_over(exported, tmp_path / "odd.zip", {"statistics.json": json.dumps(counts).encode()})
    with refused(KnowledgeCode.PACKAGE_INVALID, odd, mentions="statistics.json"):
        read_package(odd)


@pytest.mark.parametrize("stamp", [5, None, "", "yesterday", "2026-11-22T03:10:05"])
def test_read_package_lesson_without_time_is_refused(exported: Path, tmp_path: Path, stamp: object) -> None:
    lines = unpack(exported).files["knowledge.jsonl"].decode().splitlines()
    lesson = json.dumps({**json.loads(lines[0]), "stamped_at": stamp})
    with refused(KnowledgeCode.PACKAGE_INVALID, mentions="knowledge.jsonl"):
        read_package(made_over(exported, tmp_path / "odd.zip", {"knowledge.jsonl": lesson.encode()}))


def test_read_package_endless_nesting_is_refused(exported: Path, tmp_path: Path) -> None:
    deep = b"[" * 100_000
    with refused(KnowledgeCode.MANIFEST_DAMAGED):
        read_package(rewritten(exported, tmp_path / "deep.zip", **{MANIFEST: deep}))
    for name in ("knowledge.jsonl", "statistics.json"):
        with refused(KnowledgeCode.PACKAGE_INVALID):
            read_package(made_over(exported, tmp_path / "deep.zip", {name: deep}))


def test_export_knowledge_while_written_is_of_one_moment(
    taught: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = Path(shutil.copy(taught, tmp_path / "mine.knowledge"))
    with Journal.read_only(path) as look:
        before = look.read_all()
    with open_knowledge(path, ROBOT, TASK) as robot:

        def taught_meanwhile(journal: Journal) -> Iterator[JournalEntry]:
            yield from iter_entries(journal)
            praise = RlaRewarded(1, 1, 390, origin("praise"), (Credit(1, 0.1),))
            robot.append([JournalEntry(praise, STAMP)], Statistics({1: 6}))

        iter_entries = Journal.iter_entries
        monkeypatch.setattr(Journal, "iter_entries", taught_meanwhile)
        export(path, tmp_path / "out.zip")
    found = read_package(tmp_path / "out.zip")
    assert ([lesson.event for lesson in found.lessons], found.statistics) == (
        [entry.event for entry in before[0]],
        before[1],
    )


def test_import_knowledge_other_features_are_named(exported: Path, tmp_path: Path) -> None:
    basic = yaml.safe_load((CONFIG_DIR / "situations" / "basic.yaml").read_text(encoding="utf-8"))
    basic["history_steps"] = 500
    basic["features"][18]["sensors"] = ["s9", "s10"]
    other = tmp_path / "basic.yaml"
    other.write_text(yaml.safe_dump(basic), encoding="utf-8")
    difference = "maximum front (made of other sensors), all (10 s average): over 1000 steps there, 500 here"
    with refused(KnowledgeCode.PACKAGE_OTHER_FEATURES, difference=difference):
        import_from(exported, tmp_path / "k", TASK.model_copy(update={"situation": str(other)}))
    del basic["features"][0]
    other.write_text(yaml.safe_dump(basic), encoding="utf-8")
    with refused(KnowledgeCode.PACKAGE_OTHER_FEATURES):
        import_from(exported, tmp_path / "k", TASK.model_copy(update={"situation": str(other)}))
    with refused(KnowledgeCode.OTHER_TASK, taught="wall_following", wanted="eight"):
        import_from(exported, tmp_path / "k", load_task("eight"))
    assert not (tmp_path / "k").exists()


def test_export_and_import_existing_file_is_refused(exported: Path, taught: Path, tmp_path: Path) -> None:
    there = Path(shutil.copy(taught, tmp_path / "there"))
    with refused(KnowledgeCode.ALREADY_THERE):
        import_from(exported, there)
    with refused(KnowledgeCode.ALREADY_THERE):
        export(taught, exported)


def test_export_and_import_full_disk_leave_no_file(taught: Path, exported: Path, tmp_path: Path) -> None:
    for room in range(0, exported.stat().st_size, 1000):
        with largest_file(room), pytest.raises(KnowledgeError):
            export(taught, tmp_path / "out.zip")
        with largest_file(room), pytest.raises(KnowledgeError):
            import_from(exported, tmp_path / "k")
    assert [each.name for each in tmp_path.iterdir() if not each.name.endswith(".lock")] == []

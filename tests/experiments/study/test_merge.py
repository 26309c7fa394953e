"""Merge of folders of results: it checks all, then copies what is missing."""

import json
import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from kurt2rt.experiments.paper.outcome import TaughtOutcome
from kurt2rt.experiments.study import merge
from kurt2rt.experiments.study.merge import merge_results
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.study.results import Results, StudyError
from kurt2rt.experiments.study.study_record import JobRecord, StudyRecord, read_records, write_record
from tests.experiments.paper.outcomes import MADE_OF, robot
from tests.experiments.study.test_results import Job

SEEDS = (1, 2, 3)


def job(seed: int, made_of: Provenance = MADE_OF) -> JobRecord:
    return JobRecord(
        file=f"results/one-{seed}.json",
        knowledge=f"knowledge/one-{seed}.knowledge",
        name=f"one, seed {seed}",
        seed=seed,
        made_of=made_of,
    )


def part(folder: Path, *done: int, made_of: Provenance = MADE_OF, seeds: tuple[int, ...] = SEEDS) -> Path:
    """Make a part of the study with the results of these seeds."""
    write_record(folder, StudyRecord(command="kurt2rt one", jobs=tuple(job(seed, made_of) for seed in seeds)))
    (folder / "knowledge").mkdir()
    for seed in done:
        outcome = robot(seed, 80 + seed).model_copy(update={"made_of": made_of})
        Results(folder).write(Job(job(seed).file), outcome)
        (folder / f"knowledge/one-{seed}.knowledge").write_text(f"taught {seed}")
    return folder


def files(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.name != ".lock"
    }


def test_merge_holds_the_results_of_all_parts(tmp_path: Path) -> None:
    parts = [part(tmp_path / "x", 1, 3), part(tmp_path / "y", 2, 3)]
    merged = merge_results(tmp_path / "out", parts)
    assert [(each.results, each.copied) for each in merged.parts] == [(2, 2), (2, 1)]
    (record,) = merged.records
    assert record.missing(tmp_path / "out") == []
    assert files(tmp_path / "out") == files(part(tmp_path / "whole", 1, 2, 3))
    again = merge_results(tmp_path / "out", parts)
    assert [each.copied for each in again.parts] == [0, 0]


def test_merge_interrupted_anywhere_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    parts = [part(tmp_path / "x", 1, 3), part(tmp_path / "y", 2)]
    whole = files(part(tmp_path / "whole", 1, 2, 3))
    steps = 0
    for name in ("write_record", "write_durably", "fsync_file"):
        stops_at(monkeypatch, name)
    for number in range(100):
        stop.left = number
        out = tmp_path / f"out-{number}"
        try:
            merge_results(out, parts)
        except InterruptedError:
            steps += 1
            stop.left = 1000
            merge_results(out, parts)
            assert files(out) == whole
        else:
            break
    assert steps == 2 + 2 * 3  # two records, and knowledge and result of three jobs


class _Stop:
    left = 1000


stop = _Stop()


def stops_at(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Let a function of the merge fail when no steps are left."""
    does: Callable[..., None] = getattr(merge, name)

    def stopping(*given: object) -> None:
        if not stop.left:
            raise InterruptedError
        stop.left -= 1
        does(*given)

    monkeypatch.setattr(merge, name, stopping)


@pytest.mark.parametrize("what", list(Provenance.model_fields))
def test_part_of_another_make_is_refused_by_name(what: str, tmp_path: Path) -> None:
    other = MADE_OF.model_copy(update={what: "changed"})
    parts = [part(tmp_path / "x", 1), part(tmp_path / "y", 2, made_of=other)]
    with pytest.raises(StudyError, match=rf"/y: results/one-1\.json .* other {what} .*/x \(got changed, "):
        merge_results(tmp_path / "out", parts)
    assert not files(tmp_path / "out")


def test_merge_into_results_of_another_make_is_refused(tmp_path: Path) -> None:
    part(tmp_path / "out", 1)
    other = part(tmp_path / "y", 2, made_of=MADE_OF.model_copy(update={"source": "changed"}))
    with pytest.raises(StudyError, match=r"/y: .* other source"):
        merge_results(tmp_path / "out", [other])


def test_result_that_differs_in_one_bit_is_refused_by_name(tmp_path: Path) -> None:
    parts = [part(tmp_path / "x", 1, 2), part(tmp_path / "y", 2, 3)]
    path = tmp_path / "y" / "results/one-2.json"
    path.write_text(path.read_text().replace('"rlas":82', '"rlas":83'))
    with pytest.raises(StudyError, match=r"/y: one, seed 2 has another result than in .*/x \(results/one-2\.json\)"):
        merge_results(tmp_path / "out", parts)
    assert not files(tmp_path / "out")


def test_merge_keeps_a_knowledge_file_that_is_no_part(tmp_path: Path) -> None:
    out = tmp_path / "out"
    (out / "knowledge").mkdir(parents=True)
    (out / "knowledge/one-1.knowledge").write_text("mine")
    merge_results(out, [part(tmp_path / "x", 1)])
    assert (out / "knowledge/one-1.knowledge").read_text() == "taught 1"
    assert (out / "knowledge/one-1.knowledge.1").read_text() == "mine"


def test_part_that_another_run_writes_to_is_refused(tmp_path: Path) -> None:
    folder = part(tmp_path / "x", 1)
    with Results(folder).held(), pytest.raises(StudyError, match="/x: another run writes here"):
        merge_results(tmp_path / "out", [folder])


def test_part_named_twice_is_refused(tmp_path: Path) -> None:
    folder = part(tmp_path / "x", 1)
    for out, parts in ((tmp_path / "out", [folder, folder / "../x"]), (folder, [folder])):
        with pytest.raises(StudyError, match="named twice"):
            merge_results(out, parts)


def _stray(folder: Path) -> None:
    shutil.copy(folder / "results/one-1.json", folder / "results/other.json")


def _torn(folder: Path) -> None:
    (folder / "results/one-1.json").write_text('{"made_of": ')


def _without_knowledge(folder: Path) -> None:
    (folder / "knowledge/one-1.knowledge").unlink()


def _of_another_make(folder: Path) -> None:
    path = folder / "results/one-1.json"
    path.write_text(path.read_text().replace('"source":"s"', '"source":"changed"'))


def _torn_record(folder: Path) -> None:
    (path,) = (folder / "studies").iterdir()
    path.write_text("{}")


def _escaping_record(folder: Path) -> None:
    (path,) = (folder / "studies").iterdir()
    record = json.loads(path.read_text())
    record["jobs"][0]["knowledge"] = "../../stolen"
    path.write_text(json.dumps(record))


@pytest.mark.parametrize(
    ("damage", "told"),
    [
        (_stray, "results/other.json belongs to no study"),
        (_torn, "results/one-1.json: is no result"),
        (_without_knowledge, "knowledge/one-1.knowledge is gone"),
        (_of_another_make, "other source"),
        (_torn_record, "is no record of a study"),
        (_escaping_record, "is no record of a study"),
    ],
)
def test_damaged_part_is_refused(damage: Callable[[Path], None], told: str, tmp_path: Path) -> None:
    folder = part(tmp_path / "x", 1, 2)
    damage(folder)
    with pytest.raises(StudyError, match=re.escape(told)):
        merge_results(tmp_path / "out", [folder])
    assert not (tmp_path / "out/results").exists()


def test_parts_of_other_jobs_for_one_command_are_refused(tmp_path: Path) -> None:
    parts = [part(tmp_path / "x", 1), part(tmp_path / "y", 2, seeds=(1, 2))]
    with pytest.raises(StudyError, match=r"/y: has other jobs than .*/x for the command kurt2rt one"):
        merge_results(tmp_path / "out", parts)


def test_merged_folder_is_read_as_results(tmp_path: Path) -> None:
    merge_results(tmp_path / "out", [part(tmp_path / "x", 1), part(tmp_path / "y", 2)])
    jobs = [Job(job(seed).file) for seed in SEEDS]
    assert Results(tmp_path / "out").missing(jobs) == [2]
    assert Results(tmp_path / "out").read(jobs[1], TaughtOutcome) == robot(2, 82)
    assert read_records(tmp_path / "out") == read_records(tmp_path / "x")


@pytest.mark.parametrize("place", ["studies/b.json", ".lock", "results/one-2.json", "knowledge/one-1.knowledge"])
@pytest.mark.parametrize("make", [os.mkfifo, lambda path: path.symlink_to("/dev/zero")], ids=["pipe", "link"])
def test_part_with_a_pipe_or_link_is_refused_unread(tmp_path: Path, make: Callable[[Path], None], place: str) -> None:
    strange = part(tmp_path / "x", 1) / place
    strange.unlink(missing_ok=True)
    make(strange)
    with pytest.raises(StudyError, match=f"holds '{strange.name}', which is neither file nor folder"):
        merge_results(tmp_path / "out", [tmp_path / "x"])
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"kurt2rt one"', '"kurt2rt \\u001b]0;one"'),
        ('"one, seed 1"', '"one\\n, seed 1"'),
        ('"results/one-1.json"', '"results/\\u009b1.json"'),
        (f'"{MADE_OF.versions}"', '"\\u202e1"'),
    ],
)
def test_record_with_signs_that_a_terminal_obeys_is_refused(tmp_path: Path, old: str, new: str) -> None:
    folder = part(tmp_path / "x", 1)
    (record,) = (folder / "studies").iterdir()
    assert old in record.read_text()
    record.write_text(record.read_text().replace(old, new))
    with pytest.raises(StudyError, match="is no record of a study"):
        read_records(folder)

"""Each system call on the knowledge file fails once, as the kernel would have it: no lesson is lost or comes twice."""

from collections import Counter
from pathlib import Path

import pytest

from kurt2rt.knowledge.journal.journal import Journal
from tests.crash import teach_a_little
from tests.crash.failing_kernel import FailingCall, calls_made, require_strace, run_failing, run_sound
from tests.knowledge.lessons import BINDING, created

CHILD = "tests.crash.teach_a_little"
ERRORS = ("ENOSPC", "EIO", "EINTR")
EVERY = {"fcntl": 6}
"""Every sixth lock call only: if SQLite cannot unlock it tries for 10 s, and the writer then reconnects."""
SOME = (FailingCall("pwrite64", 9, "ENOSPC"), FailingCall("pwrite64", 11, "EINTR"), FailingCall("fdatasync", 2, "EIO"))


@pytest.fixture(autouse=True)
def _strace() -> None:
    require_strace()


def teach_with(failing: FailingCall, folder: Path) -> str:
    """Teach with a call that fails, and again without; in which words it was refused, if it was."""
    folder.mkdir()
    knowledge = folder / "knowledge"
    first = run_failing(CHILD, knowledge, folder.with_suffix(".log"), failing)
    assert first.err == "", failing
    assert first.exit_code in (0, teach_a_little.REFUSED), (failing, first)
    lines = first.out.splitlines()
    rows = [line for line in lines if line.startswith("row ")]
    refused = [line for line in lines if line.startswith("refused: ")]
    assert rows == [f"row {number} create-{number}" for number in range(1, len(rows) + 1)]
    assert len(refused) == (first.exit_code != 0)
    for line in refused:
        assert f"{folder}" in line, line
    if first.exit_code == 0:
        assert len(rows) == teach_a_little.LESSONS

    second = run_sound(CHILD, knowledge)
    assert (second.exit_code, second.err) == (0, ""), (failing, first, second)
    with Journal.open(knowledge, BINDING) as journal:
        assert journal.check() == []
        assert journal.events() == [created(number) for number in range(1, teach_a_little.LESSONS + 1)]
    told = rows + second.out.splitlines()
    assert len(set(told)) == len(told), "a lesson was acknowledged twice"
    return refused[0] if refused else ""


@pytest.mark.parametrize("failing", SOME, ids=str)
def test_a_system_call_that_fails_costs_no_lesson(tmp_path: Path, failing: FailingCall) -> None:
    teach_with(failing, tmp_path / "taught")


@pytest.mark.deep
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("error", ERRORS)
def test_no_system_call_that_fails_costs_a_lesson(tmp_path: Path, error: str) -> None:
    made = calls_made(CHILD, tmp_path / "knowledge", tmp_path / "calls.log")
    tried: Counter[str] = Counter()
    wrong: list[str] = []
    words: set[str] = set()
    for name, count in made.items():
        for number in range(1, count + 1, EVERY.get(name, 1)):
            tried[name] += 1
            try:
                refused = teach_with(FailingCall(name, number, error), tmp_path / f"{name}-{number}")
            except AssertionError as problem:
                wrong.append(f"{name} {number}: {problem}")
            else:
                words.add(refused.replace(str(tmp_path / f"{name}-{number}"), "FOLDER"))
    print(
        f"{error}: {made.total()} calls failed, each in turn: {dict(made)}; what was said of it:",
        *sorted(words),
        sep="\n",
    )
    assert not wrong, "\n".join(wrong)
    assert tried.total() > 100

"""The benchmark's robot: it was taught something and keeps it in a file."""

from pathlib import Path

from kurt2rt.checks.bench.robot_under_test import BenchFixture, learn, open_writer
from kurt2rt.knowledge.journal.loading import open_knowledge


async def test_it_learns_in_simulated_time_and_tells_how_far_it_is(untaught: BenchFixture) -> None:
    told: list[float] = []
    subject = await learn(untaught, 3.0, told.append)
    assert untaught.events == ()
    assert subject.events
    assert told == sorted(told)
    assert told[-1] == 1.0


async def test_the_same_lesson_teaches_the_same(untaught: BenchFixture, subject: BenchFixture) -> None:
    assert (await learn(untaught, 5.0, lambda _: None)).events == subject.events


def test_its_knowledge_file_holds_what_it_was_taught(subject: BenchFixture, tmp_path: Path) -> None:
    path = tmp_path / "some.knowledge"
    with open_writer(subject, path) as writer:
        assert writer.flush(10.0)
    with open_knowledge(path, subject.settings, subject.task) as journal:
        assert tuple(journal.events()) == subject.events

"""Merges at random, compared with the model of tests.knowledge.merge_story."""

from pathlib import Path

import pytest

from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.knowledge.lessons import BINDING
from tests.knowledge.merge_story import Story


@pytest.fixture
def journal(path: Path) -> Journal:
    with Journal.open(path, BINDING) as journal:
        return journal


def tell(seeds: range, journal: Journal, files: str) -> None:
    for seed in seeds:
        story = Story(seed, journal, files)
        try:
            for _ in range(2 + seed % 9):
                story.go_on()
        except (AssertionError, KnowledgeError) as error:
            raise AssertionError(f"story {seed} of {files}: {error}:\n" + "\n".join(story.told)) from error


@pytest.mark.parametrize(("files", "seeds"), [("ab", range(18)), ("abc", range(9))])
def test_merge_some_stories_agree_with_the_model(journal: Journal, files: str, seeds: range) -> None:
    tell(seeds, journal, files)


@pytest.mark.deep
@pytest.mark.parametrize("part", range(10))
@pytest.mark.parametrize("files", ["ab", "abc"])
def test_merge_many_stories_agree_with_the_model(journal: Journal, files: str, part: int) -> None:
    tell(range(1000 * part, 1000 * part + 1000), journal, files)

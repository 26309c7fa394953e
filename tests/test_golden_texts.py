"""Texts equal those of the golden files."""

import difflib

import pytest

from tests.golden_texts import COMMAND, SURFACES, golden_file, texts


@pytest.mark.parametrize("surface", SURFACES)
def test_texts_of_surface_equal_golden_file(surface: str) -> None:
    path = golden_file(surface)
    golden = path.read_text(encoding="utf-8") if path.exists() else ""
    diff = list(
        difflib.unified_diff(golden.splitlines(), texts(surface).splitlines(), path.name, "tables", lineterm="")
    )
    assert not diff, "\n".join([*diff, f"if the new texts are right, run: {COMMAND}"])

"""The comparison of mutants can fail, and every known one names code that is there."""

from importlib import import_module
from pathlib import Path

import pytest

from tests.hal.mutants import Mutant, equivalents, mutant_of, place_of, verdict

DIFF = """\
# hal.guard.xǁGuardǁ_slewed__mutmut_5: survived
--- hal/guard.py
+++ hal/guard.py
@@ -1,5 +1,5 @@
     def _slewed(self):
-        if from_m_s * to_m_s  < 0.0:
+        if from_m_s / to_m_s < 0.0:
             to_m_s = 0.0
"""
NAME = "hal.guard.xǁGuardǁ_slewed__mutmut_5"
MUTANT = Mutant("hal.guard.Guard._slewed", "if from_m_s * to_m_s < 0.0:", "if from_m_s / to_m_s < 0.0:")


def test_a_mutant_is_known_by_its_place_and_its_change() -> None:
    assert mutant_of(NAME, DIFF) == MUTANT
    assert place_of("hal.guard.x__bumper_bits__mutmut_12") == "hal.guard._bumper_bits"
    with pytest.raises(ValueError, match="no mutant"):
        place_of("hal.guard.Guard")


def test_a_new_survivor_and_a_forgotten_entry_are_told() -> None:
    assert verdict([MUTANT], [MUTANT]) == []
    (new,) = verdict([MUTANT], [])
    assert "hal.guard.Guard._slewed" in new
    (gone,) = verdict([], [MUTANT])
    assert "killed" in gone


def test_known_mutants_have_a_reason_and_existing_code() -> None:
    for mutant in equivalents():
        module, _, _ = mutant.place.partition(".")
        names = mutant.place.split(".")
        source = Path(import_module(".".join(names[:2])).__file__ or "").read_text(encoding="utf-8")
        assert module == "hal"
        assert f"def {names[-1]}(" in source
        for line in mutant.was.split(" / "):
            assert line in " ".join(source.split()), f"{mutant.place}: no such line: {line}"

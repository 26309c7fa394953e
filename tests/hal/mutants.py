"""Changes to the guard's code that no test notices, held against those that are known to change nothing.

`make mutants` runs mutmut over the guard, its frames, the watchdog and what they stand on: one small change at a time,
and the tests of hal have to fail. mutmut 3 because it is kept up, forks a process in which everything is imported
already, and runs only the tests that reach the changed function: five mutants a second on an idle machine. cosmic-ray
starts pytest again for each, which takes seconds. mutmut leaves out what stands behind a decorator, properties for
instance.
"""

import re
import shutil
import subprocess
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import yaml
from rich.console import Console

EQUIVALENT = Path(__file__).with_name("equivalent_mutants.yaml")
_MUTMUT = (sys.executable, "-m", "mutmut")
_LIVES = {"survived", "no tests", "suspicious", "skipped", "not checked"}
_RESULT = re.compile(r"^\s+(\S+): (.+)$", re.MULTILINE)
_PLACE = re.compile(r"(?P<module>.+)\.(?:xǁ(?P<owner>.+)ǁ|x_)(?P<function>.+)__mutmut_\d+")


@dataclass(frozen=True, order=True)
class Mutant:
    """One change: where it is, what stood there, and what it became."""

    place: str
    was: str
    became: str

    def __str__(self) -> str:
        return f"{self.place}\n    - {self.was}\n    + {self.became}"


def place_of(name: str) -> str:
    """Dotted name of the function that a mutant of mutmut changes. Raises ValueError for another name."""
    found = _PLACE.fullmatch(name)
    if found is None:
        raise ValueError(f"{name} is no mutant of mutmut")
    return ".".join(part for part in found.group("module", "owner", "function") if part)


def mutant_of(name: str, diff: str) -> Mutant:
    """Return a mutant from its name and its difference in the unified format."""
    lines = [line for line in diff.splitlines() if not line.startswith(("---", "+++", "@@", "#"))]
    was, became = ([" ".join(line[1:].split()) for line in lines if line.startswith(sign)] for sign in "-+")
    return Mutant(place_of(name), " / ".join(was), " / ".join(became))


def equivalents(path: Path = EQUIVALENT) -> dict[Mutant, str]:
    """Mutants that are known to change nothing, and why. Raises ValueError for one without a reason, or told twice."""
    known: dict[Mutant, str] = {}
    for entry in yaml.safe_load(path.read_text(encoding="utf-8")):
        mutant = Mutant(entry["place"], entry["was"], entry["became"])
        if mutant in known or not entry["why"].strip():
            raise ValueError(f"{path}: twice, or without a reason: {mutant}")
        known[mutant] = entry["why"]
    return known


def verdict(living: Iterable[Mutant], known: Iterable[Mutant]) -> list[str]:
    """Return lines about mutants that live and should not, and known ones that are gone."""
    living, known = set(living), set(known)
    return [
        *(f"no test notices: {mutant}" for mutant in sorted(living - known)),
        *(f"is killed now or gone, so take it out of the list: {mutant}" for mutant in sorted(known - living)),
    ]


def run(arguments: Sequence[str]) -> str:
    """Output of a command of mutmut. Raises subprocess.CalledProcessError."""
    return subprocess.run([*_MUTMUT, *arguments], check=True, capture_output=True, text=True).stdout


def main() -> int:
    """Make the mutants, run the tests on each, compare. mutmut shows how far it is."""
    console = Console()
    # mutmut would go on with what it found before the tests were changed.
    shutil.rmtree("mutants", ignore_errors=True)
    subprocess.run([*_MUTMUT, "run"], check=True)
    ended = dict(_RESULT.findall(run(["results"])))
    living = [mutant_of(name, run(["show", name])) for name, status in ended.items() if status in _LIVES]
    wrong = verdict(living, equivalents())
    for line in wrong:
        console.print(line, markup=False, highlight=False)
    console.print(f"{len(living)} live, {len(equivalents())} are known to change nothing, {len(wrong)} to look at")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

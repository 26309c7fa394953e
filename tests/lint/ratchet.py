"""Findings of the whole tree, and the table of findings still allowed per folder and rule."""

import json
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from tests.lint.last_bits import last_bits_findings
from tests.lint.reader import reader_findings
from tests.lint.rules import RUFF_RULES, Finding, python_findings, text_findings

ROOT = Path(__file__).parents[2]
TABLE = Path(__file__).parent / "allowed.toml"
_SUFFIXES = {".py", ".md", ".yaml", ".js", ".html", ".j2", ".txt"}
_ROOMS = ("config", "hal", "behaviors", "simbridge", "kurt2rt", "tests", "docs")
_HEAD = "# Findings still allowed per folder and rule; `python -m tests.lint --update` rewrites this file.\n"

Counts = Mapping[tuple[str, str], int]


def folder_of(path: str) -> str:
    """Return the key of a path in the table: two levels of kurt2rt and tests, one of the others."""
    folders = path.split("/")[:-1]
    return "/".join(folders[: 2 if folders[:1] in (["kurt2rt"], ["tests"]) else 1]) or path


def findings(root: Path) -> Iterator[Finding]:
    """Yield all findings of a tree. Raises SyntaxError, and CalledProcessError if ruff fails."""
    files = [path for room in _ROOMS for path in (root / room).rglob("*") if path.suffix in _SUFFIXES]
    for path in [*sorted(root.glob("*.md")), *sorted(files)]:
        name, text = str(path.relative_to(root)), path.read_text(encoding="utf-8")
        yield from text_findings(name, text)
        yield from reader_findings(name, text)
        if path.suffix == ".py":
            yield from python_findings(name, text)
            yield from last_bits_findings(name, text)
    yield from ruff_findings(root)


def ruff_findings(root: Path) -> Iterator[Finding]:
    """Yield the findings of ruff's docstring rules. Raises CalledProcessError if ruff cannot run."""
    command = [sys.executable, "-m", "ruff", "check", "--exit-zero", "--output-format", "json", "--select"]
    done = subprocess.run([*command, ",".join(RUFF_RULES), "."], cwd=root, capture_output=True, check=True)
    for found in json.loads(done.stdout):
        path = str(Path(found["filename"]).relative_to(root))
        row = found["location"]["row"]
        line = (root / path).read_text(encoding="utf-8").splitlines()[row - 1].strip()
        # The name of a test says what it is about, also of one that plug-ins inherit.
        named = line.startswith("def test_") or _trivial_property(root / path, row)
        if found["code"] != "D102" or not named:
            yield Finding(path, row, found["code"], line[:60])


def _trivial_property(path: Path, row: int) -> bool:
    """Return whether a property of one statement is defined in this row: its name is its documentation."""
    lines = path.read_text(encoding="utf-8").splitlines()
    before, after = lines[row - 2].strip(), lines[row].strip()
    return before in ("@property", "@cached_property") and after.startswith("return ")


def counted(found: Iterable[Finding]) -> Counts:
    """Return the number of findings by folder and rule."""
    return Counter((folder_of(finding.path), finding.rule) for finding in found)


def load_allowed(path: Path = TABLE) -> Counts:
    """Return the table; empty if the file does not exist."""
    content = tomllib.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    return {(folder, rule): number for folder, rules in content.items() for rule, number in rules.items()}


def write_allowed(numbers: Counts, path: Path = TABLE) -> None:
    """Replace the table."""
    lines, section = [_HEAD], ""
    for (folder, rule), number in sorted(numbers.items()):
        if folder != section:
            lines.append(f'\n["{folder}"]\n')
            section = folder
        lines.append(f"{rule} = {number}\n")
    path.write_text("".join(lines), encoding="utf-8")


def differences(numbers: Counts, allowed: Counts) -> Iterator[str]:
    """Yield one line for each number that is not the allowed one."""
    for folder, rule in sorted({*numbers, *allowed}):
        now, limit = numbers.get((folder, rule), 0), allowed.get((folder, rule), 0)
        if now > limit:
            yield f"{folder}: {rule}: too many findings (got {now}, allowed {limit}); python -m tests.lint {folder}"
        elif now < limit:
            yield f"{folder}: {rule}: lower the number to {now} (allowed {limit}); python -m tests.lint --update"

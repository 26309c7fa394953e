"""Findings of the texts that a user reads: Markdown, help, the teacher's page, golden texts, captions of reports."""

import ast
import re
from collections.abc import Iterator
from typing import Any

import typer

from kurt2rt.cli.command_line import command_line
from tests.lint.rules import LONGEST_SENTENCE, WORDS, Finding

_PHRASE = re.compile(rf"\b(?:{'|'.join(WORDS['reader'])})\b", re.IGNORECASE)
_LITERALS = {".js": re.compile(r'//.*|"((?:[^"\\\n]|\\.)*)"|`([^`]*)`'), ".html": re.compile(r'>([^<>]+)<|="([^"]*)"')}
"""Texts of the page in a file by its suffix; a comment is matched so that it hides its quotation marks."""


def reader_findings(path: str, text: str) -> Iterator[Finding]:
    """Yield the banned phrases and long sentences of a file that a user reads; other files have none."""
    if path.endswith(".md"):
        yield from _findings(path, 1, text)
    elif path.startswith("tests/golden/"):
        for number, line in enumerate(text.splitlines(), 1):
            yield from _findings(path, number, line.partition(": ")[2].replace(" | ", ". "))
    elif path.startswith("kurt2rt/teacher/page/static/"):
        for literal in _LITERALS[path[path.rindex(".") :]].finditer(text):
            yield from _findings(path, text.count("\n", 0, literal.start()) + 1, literal[1] or literal[2] or "")
    elif path.startswith("kurt2rt/experiments/") and path.endswith(".py"):
        for node in ast.walk(ast.parse(text)):
            for caption in _captions_in(node):
                words = (each.value for each in ast.walk(caption) if isinstance(each, ast.Constant))
                yield from _findings(path, caption.lineno, " ".join(each for each in words if isinstance(each, str)))


def _captions_in(node: ast.AST) -> list[ast.expr]:
    """Return the notes of a table and the captions of a figure that a call makes; none of any other node."""
    if not isinstance(node, ast.Call):
        return []
    notes = [each.value for each in node.keywords if each.arg == "note"]
    return [*notes, *node.args[2:]] if ast.unparse(node.func) == "SavedFigure" else notes


def help_findings() -> Iterator[Finding]:
    """Yield the findings of the help of each command and each option; a command's words are its path."""
    found = dict.fromkeys(_help_of("kurt2rt/cli", typer.main.get_command(command_line())))
    seen = set()
    for path, text in found:
        if text not in seen:
            seen.add(text)
            yield from _findings(path, 1, text)


def _help_of(path: str, command: Any) -> Iterator[tuple[str, str]]:
    yield path, command.help or ""
    for parameter in command.params:
        yield f"{path} {parameter.opts[0]}", getattr(parameter, "help", None) or ""
    for name, each in getattr(command, "commands", {}).items():
        yield from _help_of(f"{path}/{name}", each)


def _findings(path: str, first: int, text: str) -> Iterator[Finding]:
    for line, phrase in _phrases(text):
        yield Finding(path, first + line, "reader-phrase", phrase)
    for line, words in _long_sentences(text):
        yield Finding(path, first + line, "long-sentence", words)


def _phrases(text: str) -> Iterator[tuple[int, str]]:
    for line, words in enumerate(text.splitlines()):
        for phrase in _PHRASE.findall(words):
            yield line, phrase.lower()


def _long_sentences(text: str) -> Iterator[tuple[int, str]]:
    """Yield the line and the first words of each sentence with too many words; tables and code have none."""
    blank = re.sub(r"^```.*?^```$", lambda code: "\n" * code[0].count("\n"), text, flags=re.MULTILINE | re.DOTALL)
    plain = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", re.sub(r"^(?:\||#|    ).*$", "", blank, flags=re.MULTILINE))
    for sentence in re.finditer(r"(?:(?!\n\s*\n|\n *[-*\d]\.? |[.!?:]\*{0,2}\s).)+", plain, re.DOTALL):
        if len(words := sentence[0].split()) > LONGEST_SENTENCE:
            start = sentence.start() + len(sentence[0]) - len(sentence[0].lstrip())
            yield plain.count("\n", 0, start), " ".join(words[:8])

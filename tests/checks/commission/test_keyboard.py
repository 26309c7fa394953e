"""Lines from a terminal, from a pipe, from a file."""

import io
import os
import pty
import re
from pathlib import Path

import anyio
import pytest
from rich.console import Console

from kurt2rt.checks.commission.console_operator import ConsoleOperator
from kurt2rt.checks.commission.keyboard import Keyboard
from kurt2rt.checks.commission.operator import AbortedError, AnswerChoice, OperatorQuestion, QuestionKind, Tone


async def test_a_pipe_keeps_each_line_for_its_question() -> None:
    reading, writing = os.pipe()
    with os.fdopen(reading) as lines:
        keyboard = Keyboard(lines)
        os.write(writing, b"one\r\ntw")
        assert await keyboard.line() == "one"
        os.write(writing, b"o\n")
        assert await keyboard.line() == "two"
        os.close(writing)
        assert await keyboard.line() is None
        assert not keyboard.echoes


async def test_a_file_is_read_to_its_end(tmp_path: Path) -> None:
    path = tmp_path / "answers"
    path.write_text("one\n\n")
    with path.open() as lines:
        keyboard = Keyboard(lines)
        assert [await keyboard.line() for _ in range(3)] == ["one", "", None]


async def test_keyboard_discards_input_typed_before_the_question() -> None:
    person, terminal = pty.openpty()
    with os.fdopen(terminal) as lines:
        keyboard = Keyboard(lines)
        assert keyboard.echoes
        os.write(person, b"too early\n")
        answers: list[str | None] = []

        async def ask() -> None:
            answers.append(await keyboard.line())

        async with anyio.create_task_group() as tasks:
            tasks.start_soon(ask)
            await anyio.wait_all_tasks_blocked()
            assert answers == []
            os.write(person, b"in time\n")
        assert answers == ["in time"]
    os.close(person)


async def test_keyboard_wait_does_not_block_the_event_loop() -> None:
    reading, writing = os.pipe()
    with os.fdopen(reading) as lines:
        keyboard = Keyboard(lines)
        with anyio.move_on_after(0.01) as waiting:
            await keyboard.line()
        assert waiting.cancelled_caught
        os.write(writing, b"late\n")
        assert await keyboard.line() == "late"
    os.close(writing)


async def test_console_operator_repeats_questions_and_labels_lines() -> None:
    screen = io.StringIO()
    person = ConsoleOperator(io.StringIO("maybe\n S \n"), Console(file=screen, no_color=True, width=200))
    person.tell("Which?", Tone.TITLE)
    person.tell("Exchange them", Tone.TO_DO)
    question = OperatorQuestion(
        QuestionKind.MOVE, "The wheels turn.", (AnswerChoice("", "turn them"), AnswerChoice("s", "skip this step"))
    )
    assert await person.answer(question) == "s"
    with pytest.raises(AbortedError):
        await person.answer(question)
    said = screen.getvalue()
    assert said.splitlines()[:3] == ["", "Which?", "  TO DO: Exchange them"]
    assert "  The wheels turn.\n    [Enter] turn them  [s] skip this step  [q] leave > " in said
    assert "'maybe'" in said


async def test_words_stay_whole_on_a_narrow_terminal() -> None:
    screen = io.StringIO()
    console = Console(file=screen, no_color=True, width=40, force_terminal=True, legacy_windows=False)
    person = ConsoleOperator(io.StringIO("\n"), console)
    person.tell("Why: Frames that are missing, slow or junk would stop the robot later.")
    question = OperatorQuestion(
        QuestionKind.BEGIN, "Ready?", (AnswerChoice("", "begin"), AnswerChoice("s", "skip this step"))
    )
    assert await person.answer(question) == ""
    said = re.sub(r"\x1b\[\d*m", "", screen.getvalue())
    assert [line.rstrip() for line in said.splitlines()][:5] == [
        "  Why: Frames that are missing, slow or",
        "junk would stop the robot later.",
        "  Ready?",
        "    [Enter] begin  [s] skip this step",
        "[q] leave >",
    ]
    assert "leave > " in said

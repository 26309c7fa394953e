"""Lines from a terminal, from a pipe, from a file."""

import io
import os
import pty

import anyio
import pytest
from rich.console import Console

from kurt2rt.checks.commission.console_operator import ConsoleOperator, Keyboard
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

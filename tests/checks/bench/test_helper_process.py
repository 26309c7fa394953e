"""Helper processes of the benchmark: they end with their block, also after an error."""

import os
from pathlib import Path

import pytest

from kurt2rt.checks.bench.helper_process import HelperLostError, helper_process

IDLER = "tests.checks.bench.idler"
ROOT = Path(__file__).parents[3]


@pytest.fixture(autouse=True)
def where_modules_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)


def assert_gone(pid: int) -> None:
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


async def test_helper_process_answers_and_ends_with_the_block() -> None:
    async with helper_process(IDLER) as idler:
        assert await idler.ask("idle") == {}
        assert await idler.ask("idle") == {}
    assert_gone(idler.pid)


async def test_helper_process_failure_is_raised_and_printed(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(HelperLostError, match=IDLER):
        async with helper_process(IDLER) as idler:
            await idler.ask("work")
    assert_gone(idler.pid)
    assert "KeyError: 'work'" in capfd.readouterr().err


async def test_helper_process_silence_is_an_error_and_ends_it() -> None:
    with pytest.raises(HelperLostError) as lost:
        async with helper_process(IDLER) as idler:
            await idler.ask("idle", patience_s=0.0)
    assert isinstance(lost.value.__cause__, TimeoutError)
    assert_gone(idler.pid)

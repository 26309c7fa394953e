"""Helper process of a benchmark: it does jobs (kurt2rt.checks.bench.job_loop) and ends with its parent."""

import json
import subprocess
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import anyio
import anyio.abc
from anyio.streams.buffered import BufferedByteReceiveStream

_LONGEST_ANSWER = 65_536
_ENDING_S = 5.0


class HelperLostError(RuntimeError):
    """Helper process that ended or did not answer; its error is on standard error."""


class HelperProcess:
    """Process that does one job at a time."""

    def __init__(self, module: str, process: anyio.abc.Process) -> None:
        """Wrap a running process; use `helper_process`."""
        assert process.stdin is not None
        assert process.stdout is not None
        self._module = module
        self.pid = process.pid
        """Process id."""
        self._stdin = process.stdin
        self._answers = BufferedByteReceiveStream(process.stdout)

    async def ask(self, job: str, *, patience_s: float = 30.0, **fields: Any) -> dict[str, Any]:
        """Run a job with these fields and return its answer.

        Raises HelperLostError if the process ends, or does not answer within `patience_s`.
        """
        try:
            with anyio.fail_after(patience_s):
                await self._stdin.send(json.dumps({"job": job, **fields}).encode() + b"\n")
                answer = await self._answers.receive_until(b"\n", _LONGEST_ANSWER)
        except (anyio.BrokenResourceError, anyio.EndOfStream, anyio.IncompleteRead) as error:
            raise HelperLostError(f"{self._module} ended while it was asked to {job}; see above why") from error
        except TimeoutError as error:
            raise HelperLostError(f"{self._module} did not {job} within {patience_s:g} s") from error
        fields_of_answer: dict[str, Any] = json.loads(answer)
        return fields_of_answer


@asynccontextmanager
async def helper_process(module: str, *arguments: str) -> AsyncIterator[HelperProcess]:
    """Run `python -m module ARGUMENTS` as a process that answers `HelperProcess.ask`; end it with the context.

    Raises OSError if it cannot be started.
    """
    # In a session of its own, so that Ctrl-C reaches the robot first. Its input ends when we do, and so does it.
    process = await anyio.open_process(
        [sys.executable, "-m", module, *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=None,
        start_new_session=True,
    )
    try:
        yield HelperProcess(module, process)
    finally:
        with anyio.CancelScope(shield=True):
            assert process.stdin is not None
            await process.stdin.aclose()
            with anyio.move_on_after(_ENDING_S):
                await process.wait()
            if process.returncode is None:
                process.kill()
            await process.aclose()

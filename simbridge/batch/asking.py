"""Calls from the compiled loop back into Python, which decides for robots whose mind is not compiled."""

import ctypes
from collections.abc import Callable
from typing import Any

from simbridge.batch.compiled import IS_COMPILED

FAILED = -2
"""Answer of a call that raised an error; -1 lets the robot stand and ask."""
_PROTOTYPE = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)


class PythonMind:
    """Python function that chooses actions, with an address by which the compiled loop calls it."""

    def __init__(self, decide: Callable[[int], int]) -> None:
        """Wrap `decide`, which returns the index of an action, or -1, for a robot by its index in the batch."""
        self._decide = decide
        self._error: BaseException | None = None
        self._function = _PROTOTYPE(self._answer)
        """Entry of the compiled code, which must live as long as the address is in use."""
        self.address: int = ctypes.cast(self._function, ctypes.c_void_p).value or 0
        """Address of the entry, for `ask`."""

    def raise_error(self) -> None:
        """Raise the error of a call that failed since the last time; it could not pass through compiled code."""
        if self._error is not None:
            error, self._error = self._error, None
            raise error

    def _answer(self, robot: int) -> int:
        try:
            return self._decide(robot)
        except BaseException as error:  # noqa: BLE001 - `raise_error` raises it again
            self._error = error
            return FAILED


def _ask_by_address(address: int, robot: int) -> int:
    answer: int = _PROTOTYPE(address)(robot)
    return answer


def _compile_ask() -> Any:
    """Return `ask` for compiled code: a call by address, because a function in a constant could not be cached."""
    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic

    def call(_typing: Any, _address: Any, _robot: Any) -> Any:
        def generate(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
            number = ir.IntType(64)
            function = builder.inttoptr(arguments[0], ir.FunctionType(number, [number]).as_pointer())
            return builder.call(function, [arguments[1]])

        return types.int64(types.int64, types.int64), generate

    return intrinsic(call)


ask: Callable[[int, int], int] = _compile_ask() if IS_COMPILED else _ask_by_address
"""Return the answer of the PythonMind at an address for a robot; FAILED if it raised an error."""

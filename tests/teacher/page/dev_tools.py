"""The browser's DevTools protocol without WebDriver between: a script returns several times sooner."""

import itertools
import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from selenium import webdriver
from selenium.common.exceptions import JavascriptException
from websockets.sync.client import ClientConnection, connect

_MOST_BYTES = 2**26


class DevTools:
    """Link to the page of a browser. The driver navigates, because it waits until a page is loaded."""

    def __init__(self, socket: ClientConnection) -> None:
        self._socket = socket
        self._numbers = itertools.count(1)

    def call(self, method: str, **parameters: object) -> dict[str, Any]:
        """Give a command; return its result."""
        number = next(self._numbers)
        self._socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while (answer := json.loads(self._socket.recv())).get("id") != number:
            pass  # an event
        assert "error" not in answer, f"{method}: {answer['error']}"
        result: dict[str, Any] = answer["result"]
        return result

    def run(self, script: str, *arguments: object) -> Any:
        """Run the body of a function in the page; return its result, or that of its promise."""
        call = f"(function () {{{script}\n}}).apply(null, {json.dumps(arguments)})"
        ran = self.call("Runtime.evaluate", expression=call, awaitPromise=True, returnByValue=True, userGesture=True)
        if failed := ran.get("exceptionDetails"):
            raise JavascriptException(str(failed.get("exception", failed).get("description", failed)))
        return ran["result"].get("value")


@contextmanager
def dev_tools(driver: webdriver.Chrome) -> Iterator[DevTools]:
    """Open a link to the page of a driver."""
    at = driver.capabilities["goog:chromeOptions"]["debuggerAddress"]
    page = f"ws://{at}/devtools/page/{driver.current_window_handle}"
    with connect(page, proxy=None, compression=None, ping_interval=None, max_size=_MOST_BYTES) as socket:
        yield DevTools(socket)

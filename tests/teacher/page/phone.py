"""A phone with the page open: a real browser without a window, touched as a finger does it."""

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By

from tests.teacher.page import page_time
from tests.teacher.page.dev_tools import DevTools, dev_tools
from tests.teacher.page.page_time import PageTime, pass_page_time

BROWSER, DRIVER = Path("/usr/bin/chromium"), Path("/usr/bin/chromedriver")
PORTRAIT, SMALL, LANDSCAPE, LAPTOP = (390, 844), (360, 600), (844, 390), (1280, 800)
PATIENCE_S = 60.0
"""Seconds of the page in which an event has to come."""
STEP_S = 0.05
_NOWHERE = "about:blank"

# Each page gets a process of its own, and the next one has its process already, unless it is told not to: starting
# them was most of what the stories took. A transition is painted many times. Optimising the page's scripts takes
# longer than it saves in the seconds of a story.
_FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-extensions", "--disable-sync"),
    *("--disable-site-isolation-trials", "--process-per-site", "--renderer-process-limit=1"),
    "--disable-features=SpareRendererForSitePerProcess,BackForwardCache,site-per-process,IsolateOrigins",
    *("--force-prefers-reduced-motion", "--js-flags=--no-opt,--no-maglev"),
)

# What WebDriver's own questions come to, each in one short command.
_TEXT_OF = """
const text = (e) => e?.checkVisibility({visibilityProperty: true, opacityProperty: true}) ? e.innerText.trim() : "";
"""
_TEXT = f"{_TEXT_OF} return text(document.querySelector(arguments[0]));"
_TEXTS = f"{_TEXT_OF} return [...document.querySelectorAll(arguments[0])].map(text);"
_SHOWN = """
const e = document.querySelector(arguments[0]);
const box = e?.getBoundingClientRect();
return Boolean(e?.checkVisibility({visibilityProperty: true, opacityProperty: true}) && box.width && box.height);
"""

_MIDDLE = """
const e = document.querySelector(arguments[0]);
e.scrollIntoView({block: "nearest"});
const b = e.getBoundingClientRect();
return [b.x + b.width / 2, b.y + b.height / 2];
"""

_TIDY = """
for (const each of document.querySelectorAll("dialog[open]")) each.close();
document.querySelector("#tab-teach").click();
document.activeElement?.blur();
"""


_KEEPS_WHAT_IT_SAYS = """
window.saidBefore = [];
addEventListener("DOMContentLoaded", () => {
  const line = document.querySelector("#said");
  if (!line) return;
  const keep = () => line.textContent.trim() && saidBefore.push(`${line.className}: ${line.textContent}`);
  new MutationObserver(keep).observe(line, {childList: true, characterData: true, subtree: true});
});
"""
_HAS_BEEN_HERE = "try { localStorage.setItem('kurt2rt.bubbles', 'seen'); } catch { /* about:blank has no storage */ }"


class Phone:
    """The page in its browser, whose teacher has been there before unless told otherwise."""

    def __init__(self, driver: webdriver.Chrome, tools: DevTools, screenshots: Path | None) -> None:
        self.driver = driver
        self.tools = tools
        self._screen: object = None
        self._screenshots = screenshots
        self._at: str | None = None
        self.time: PageTime | None = None
        """Time of the server whose page is open; None: of the page alone."""
        self._add_before_scripts(_HAS_BEEN_HERE)
        self._add_before_scripts(page_time.SCRIPT)
        self._add_before_scripts(_KEEPS_WHAT_IT_SAYS)

    @contextmanager
    def in_the_dark(self) -> Iterator[None]:
        """Prefer the dark theme meanwhile."""
        scheme = "prefers-color-scheme"
        self.tools.call("Emulation.setEmulatedMedia", features=[{"name": scheme, "value": "dark"}])
        try:
            yield
        finally:
            self.tools.call("Emulation.setEmulatedMedia", features=[])

    def turn(self, size: tuple[int, int], *, touch: bool = True) -> None:
        """Give the screen another size."""
        if self._screen == (size, touch):
            return
        fine = 2 if self._screenshots else 1  # without screenshots, painted in a quarter of the time
        screen = {"width": size[0], "height": size[1], "deviceScaleFactor": fine, "mobile": touch}
        self.tools.call("Emulation.setDeviceMetricsOverride", **screen)
        self.tools.call("Emulation.setTouchEmulationEnabled", enabled=touch)
        if (self._at or "").startswith("http"):
            self.wait(lambda: self.run("return [innerWidth, innerHeight];") == list(size), "the screen is turned")
        self._screen = (size, touch)

    def open(self, address: str) -> None:
        """Go to an address."""
        self._at = None
        self.driver.get(address)
        if address != _NOWHERE:
            self.driver.execute_script("")  # waits for the page to which that page goes on
        self._at = address

    def come_to(self, address: str) -> None:
        """Go to an address. Is it open already, the page is only tidied: most of a story's time is to load it."""
        if self._at != address:
            self.open(address)
        else:
            self.run(_TIDY)

    def leave(self) -> None:
        """Go where there is nothing, and no server."""
        if self._at != _NOWHERE:
            self.open(_NOWHERE)

    def text(self, selector: str) -> str:
        """Return the text of the first element of a CSS selector; empty if it is hidden."""
        return str(self.run(_TEXT, selector))

    def texts(self, selector: str) -> list[str]:
        """Return the text of each visible element."""
        return [text for text in self.run(_TEXTS, selector) if text]

    def shows(self, selector: str) -> bool:
        """Return whether the first element is visible."""
        return bool(self.run(_SHOWN, selector))

    def has(self, selector: str) -> bool:
        """Return whether there is such an element."""
        return bool(self.run("return document.querySelector(arguments[0]) !== null;", selector))

    def write(self, selector: str, text: str) -> None:
        """Type into a field."""
        self.driver.find_element(By.CSS_SELECTOR, selector).send_keys(text)

    def run(self, script: str, *arguments: object) -> Any:
        """Run a script in the page and return its result."""
        return self.tools.run(script, *arguments)

    def wait(self, until: Callable[[], object], what: str) -> None:
        """Let time pass until something is so. The failure tells the last sentences of the page, which it clears."""
        for _ in range(round(PATIENCE_S / STEP_S)):
            if until():
                return
            self.pass_time(STEP_S)
        raise AssertionError(f"never: {what}; the page said {self.run('return window.saidBefore?.slice(-4);')}")

    def pass_time(self, seconds: float) -> None:
        """Let time pass for the page and its server, in steps that are shorter than what either waits for."""
        for step in range(max(1, round(seconds / STEP_S))):
            rest_s = min(STEP_S, seconds - step * STEP_S)
            if self.time is None:
                pass_page_time(self, rest_s)
            else:
                self.time.pass_time(self, rest_s)

    def touch(self, selector: str) -> None:
        """Touch the middle of an element."""
        self.finger_down(*self.middle(selector))
        self.finger_up()

    def middle(self, selector: str) -> tuple[float, float]:
        """Return the middle of an element on the screen, scrolled there, once the page shows all that came for it.

        A new state may move what stands below its text, and a finger would touch what has come there instead.
        """
        self.pass_time(0.0)
        x, y = self.run(_MIDDLE, selector)
        return float(x), float(y)

    def finger_down(self, x: float, y: float) -> None:
        """Put a finger on the screen."""
        self._finger("touchStart", [{"x": x, "y": y}])

    def finger_to(self, x: float, y: float) -> None:
        """Move it."""
        self._finger("touchMove", [{"x": x, "y": y}])

    def finger_up(self) -> None:
        """Lift it."""
        self._finger("touchEnd", [])

    def drag_by_mouse(self, x: float, y: float, to: tuple[float, float]) -> None:
        """Drag with a mouse: after the flick of a finger a browser keeps the next tap to itself."""
        for kind, (at_x, at_y) in (("mousePressed", (x, y)), ("mouseMoved", to), ("mouseReleased", to)):
            self.tools.call("Input.dispatchMouseEvent", type=kind, x=at_x, y=at_y, button="left", clickCount=1)

    def key(self, kind: str, code: str) -> None:
        """Press or lift a key of a laptop: keyDown or keyUp, and its code."""
        key = {"Space": " ", "KeyW": "w", "KeyU": "u", "KeyY": "y"}.get(code, code)
        event: dict[str, object] = {"type": kind, "code": code, "key": key}
        if code == "Enter" and kind == "keyDown":
            event |= {"text": "\r", "windowsVirtualKeyCode": 13}  # else no button feels it
        self.tools.call("Input.dispatchKeyEvent", **event)

    @contextmanager
    def before_scripts(self, script: str) -> Iterator[None]:
        """Run a script in each page that is opened meanwhile, before its own."""
        added = self._add_before_scripts(script)
        try:
            yield
        finally:
            self.driver.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", added)

    def show(self, name: str) -> None:
        """Keep a picture of the screen where the environment asks for it."""
        if self._screenshots is not None:
            self._screenshots.mkdir(parents=True, exist_ok=True)
            assert self.driver.save_screenshot(str(self._screenshots / f"{name}.png"))

    def complaints(self) -> list[str]:
        """Return the messages of the browser's console since the last call."""
        return [entry["message"] for entry in self.driver.get_log("browser")]  # type: ignore[no-untyped-call]

    def _add_before_scripts(self, script: str) -> dict[str, Any]:
        added: dict[str, Any] = self.driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": script})
        return added

    def _finger(self, kind: str, points: list[dict[str, float]]) -> None:
        self.tools.call("Input.dispatchTouchEvent", type=kind, touchPoints=points)


@contextmanager
def phone(screenshots: Path | None) -> Iterator[Phone]:
    """Start a browser without data. Skips if none is installed, unless this is CI."""
    if not (BROWSER.exists() and DRIVER.exists()):
        why = "the browser's stories need Debian's chromium and chromium-driver"
        if os.environ.get("CI") == "true":
            pytest.fail(why)
        pytest.skip(why)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        options = webdriver.ChromeOptions()
        options.binary_location = str(BROWSER)
        for flag in (*_FLAGS, f"--user-data-dir={profile}"):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        driver = webdriver.Chrome(options, Service(str(DRIVER)))
        try:
            with dev_tools(driver) as tools:
                opened = Phone(driver, tools, screenshots)
                opened.turn(PORTRAIT)
                yield opened
        finally:
            driver.quit()

"""axe-core in the browser: accessibility faults of the page."""

import os
from importlib import import_module

import pytest

from tests.teacher.page.phone import Phone

_BUNDLED = "axe_core_python.base"
_RUN = """
const [done] = [...arguments].slice(-1);
const rules = {"label-content-name-mismatch": {enabled: true}};
const told = ({id, nodes}) => `${id}: ${nodes.map((each) => each.target.join(" ")).join(", ")}`;
const pale = () => document.body.classList.contains("no-picture");
let wasPale = pale();
const watching = new MutationObserver(() => { wasPale ||= pale(); });
watching.observe(document.body, {attributeFilter: ["class"]});
axe.run({resultTypes: ["violations"], rules}).then(
  ({violations}) => done([wasPale, violations.map(told)]),
  (error) => done([false, [String(error)]]),
).finally(() => watching.disconnect());
"""


def violations(phone: Phone) -> list[str]:
    """Return the rules that the page breaks now, each with the elements that do; empty for an accessible page.

    A page without a new state for a while is pale on purpose. axe-core keeps a slow machine busy for so long that the
    page turns pale under its eyes, so what it finds then does not count, and it looks again.

    Skips where axe-core is not installed, unless this is CI.
    """
    needed = os.environ.get("CI") == "true"
    bundled = import_module(_BUNDLED) if needed else pytest.importorskip(_BUNDLED)
    if phone.run("return typeof axe === 'undefined';"):
        phone.run(bundled.AXE_SCRIPT)
    found: list[str] = []

    def looks_at_a_new_state() -> bool:
        nonlocal found
        was_pale, found = phone.driver.execute_async_script(_RUN)
        return not was_pale or not found

    phone.wait(looks_at_a_new_state, "axe-core sees the page with a new state")
    return found

"""axe-core in the browser: accessibility faults of the page."""

import os
from importlib import import_module

import pytest

from tests.teacher.page.phone import Phone

_BUNDLED = "axe_core_python.base"
STATE_S = 0.2
"""Time in which the page has got a new state."""
_RUN = """
const rules = {"label-content-name-mismatch": {enabled: true}};
const told = ({id, nodes}) => `${id}: ${nodes.map((each) => each.target.join(" ")).join(", ")}`;
const pages = realTime();
return axe.run({resultTypes: ["violations"], rules}).then(
  ({violations}) => violations.map(told),
  (error) => [String(error)],
).finally(() => Object.assign(window, pages));
"""


def violations(phone: Phone) -> list[str]:
    """Return the rules that the page breaks now, each with the elements that do; empty for an accessible page.

    Skips where axe-core is not installed, unless this is CI.
    """
    needed = os.environ.get("CI") == "true"
    bundled = import_module(_BUNDLED) if needed else pytest.importorskip(_BUNDLED)
    if phone.run("return typeof axe === 'undefined';"):
        phone.run(bundled.AXE_SCRIPT)
    phone.pass_time(STATE_S)  # a page without a new state is pale on purpose
    found: list[str] = phone.run(_RUN)
    return found

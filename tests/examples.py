"""Numbers of examples for property tests."""

import os

from hypothesis import settings

QUICK, THOROUGH = "quick", "thorough"
_SHARE = {QUICK: 0.12, THOROUGH: 1.0}
"""Share of the examples of a property that asks for its own number."""


def register_profiles() -> None:
    """Register the quick profile of `make test` and the thorough one (EXAMPLES=thorough).

    The same examples each time, on any machine: what they find they have found at the first run. No deadline for one:
    it would be a wall-clock assertion, and the machine that runs the tests is shared.
    """
    settings.register_profile(QUICK, derandomize=True, deadline=None, print_blob=True, max_examples=12)
    settings.register_profile(THOROUGH, settings.get_profile(QUICK), max_examples=100)
    settings.load_profile(os.environ.get("EXAMPLES", QUICK))


def examples(thorough: int) -> settings:
    """So many examples where they are to be thorough, and an eighth of them in the quick one."""
    return settings(max_examples=max(1, round(thorough * _SHARE[settings.get_current_profile_name()])))

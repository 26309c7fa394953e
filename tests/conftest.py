"""What all tests share: property tests that draw the same examples every time, on any machine."""

from hypothesis import settings

# No deadline per example: it would be a wall-clock assertion, and the machine that runs the tests is shared.
# Fifty examples, for the same ones are drawn each time: what they find they have found at the first run.
settings.register_profile("repeatable", derandomize=True, deadline=None, print_blob=True, max_examples=50)
settings.load_profile("repeatable")

"""Rule-like associations: condition, action, expectation; the nearest one wins (paper, section III)."""

"""Tasks that can be taught and examined: what is allowed, how near counts as known, and how the teacher behaves."""

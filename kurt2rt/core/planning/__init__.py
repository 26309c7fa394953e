"""Planning: over the network of what was taught and what follows it, to a goal that the teacher names (paper, V.C)."""

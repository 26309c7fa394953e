"""Expectations: which situation follows an RLA, learned from what did (paper, III.A.3), and surprise at another."""

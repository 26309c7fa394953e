"""Batch simulator: many robots at once in compiled loops, equal bit by bit to the loop over the simulated CAN bus."""

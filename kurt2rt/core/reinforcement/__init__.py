"""Reinforcement (paper, phases 3 and 5): values of RLAs from rewards, and repair of RLAs with low values."""

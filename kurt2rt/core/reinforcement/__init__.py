"""Reinforcement (paper, phases 3 and 5): what rewards and blame change in the knowledge, and how RLAs compete."""

"""Agents of deep reinforcement learning, trained by the judge of a task."""

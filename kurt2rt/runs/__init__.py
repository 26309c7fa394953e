"""Driven runs: recording, replay, explanation."""

"""Clocks, pacing, signals, durable files: this process and its computer. Imports nothing of ours."""

"""Benchmarks of the runtime, each with a reference from the same run."""

"""Simulated worlds: settings, generators, maps."""

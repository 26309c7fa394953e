"""Decisions, their causes, and the settings of a task that all levels share."""

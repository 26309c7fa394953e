"""Synchronous names of the package `kurt2rt`, for scripts and notebooks."""

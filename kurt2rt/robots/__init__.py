"""Robots as plug-ins: KURT2 is the first; an entry point of `kurt2rt.robots` offers each."""

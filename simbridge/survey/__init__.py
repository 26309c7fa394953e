"""Measures of a simulated world: free poses, clearances, laps, drawings."""

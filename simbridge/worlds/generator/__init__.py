"""Generator of worlds from seeds."""

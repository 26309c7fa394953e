"""Teacher's terminal."""

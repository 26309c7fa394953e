"""Knowledge as tables for a terminal."""

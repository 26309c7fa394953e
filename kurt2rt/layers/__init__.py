"""The stack of layers: information goes up, commands come down (paper, section V)."""

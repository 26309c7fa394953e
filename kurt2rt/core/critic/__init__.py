"""The internal critic (paper, phases 4 and 5): what it thinks, how far it is trusted, and what it may do."""

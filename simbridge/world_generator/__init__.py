"""New worlds by the seed: rooms and streets that nobody has seen."""

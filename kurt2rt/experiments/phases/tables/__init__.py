"""The tables of a path of all phases, a file for each subject."""

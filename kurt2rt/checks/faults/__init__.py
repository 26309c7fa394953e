"""Faults put in on purpose: the table of what each must lead to, the drill that tries it, and the judge."""

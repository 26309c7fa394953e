"""Learners of other kinds than RLA systems; each module holds one."""

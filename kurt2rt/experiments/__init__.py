"""Lessons and exams in lockstep: teach the simulated robot, examine it without its teacher, report both."""

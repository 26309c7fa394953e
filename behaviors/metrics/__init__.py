"""Courses: what the robot is asked to do on its way in lessons and exams, and how well it does."""

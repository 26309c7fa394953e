"""Task metrics: requirements and measures of a drive in lessons and exams."""

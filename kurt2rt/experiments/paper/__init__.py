"""The paper's results section (VII.1) beside ours: jobs, their results in files, tables, figures, one report."""

"""Study of the paper's results section (VII.1): jobs, stored results, tables, figures and report."""

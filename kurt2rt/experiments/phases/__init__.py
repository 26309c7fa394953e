"""Study of the phases 1 to 5, with controls: jobs, tables, figures and report."""

"""The whole path of training, phases 1 to 5, with its controls: jobs, tables, figures, one report."""

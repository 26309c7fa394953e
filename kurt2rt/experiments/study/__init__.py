"""Parts that all studies share: jobs, stored results, statistics, reports."""

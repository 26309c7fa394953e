"""Equal tuning of rivals: the same number of trials on the same robots for each, by the search of settings."""

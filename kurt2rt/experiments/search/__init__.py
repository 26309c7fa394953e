"""Search for settings of a task: trials on search seeds, then one check on other seeds."""

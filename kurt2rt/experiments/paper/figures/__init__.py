"""The figures of the paper, drawn from our results, and one picture more for each task."""

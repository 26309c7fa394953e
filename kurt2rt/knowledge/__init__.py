"""Knowledge: an append-only journal of teaching events that never loses an acknowledged lesson."""

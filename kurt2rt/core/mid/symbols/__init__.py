"""What a history is made of: one kind of symbols a file."""

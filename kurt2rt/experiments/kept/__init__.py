"""What long experiments come to, kept in files with hashes of what made them, so that they go on and mix nothing."""

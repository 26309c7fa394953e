"""Knowledge file: an append-only journal in SQLite, read back by folding its entries."""

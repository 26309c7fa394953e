"""Knowledge files on disk: create, copy, back up, archive."""

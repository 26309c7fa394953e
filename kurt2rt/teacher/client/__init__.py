"""Client of the teacher channel."""

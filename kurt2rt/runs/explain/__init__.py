"""Why the robot did what it did: which RLA won, by how much, who taught it; in words and as a picture."""

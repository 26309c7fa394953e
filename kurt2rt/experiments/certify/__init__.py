"""Certificate of a taught robot: the probability of collisions, of getting stuck and of questions."""

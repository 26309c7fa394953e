"""Knowledge as one file to give away, with what it was taught with."""

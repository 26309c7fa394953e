"""What a change of knowledge would do, tried on recorded runs before it is made."""

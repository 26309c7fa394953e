"""A recorded run again: the same senses and commands through the same tick, with the same or with other knowledge."""

"""The doctor: what this machine offers the runtime, what is missing, and what to do about it."""

"""Two real processes over a real vcan0, in simulated time: what is exact about them, to the microsecond and the bit.

The tests run on this machine and boot one of their own for each story, so every story begins at the same instant.
Inside, `stage` starts the programs `robot` and `runtime` and candump, and does to them what the story is about.
"""

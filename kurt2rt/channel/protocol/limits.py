"""Version and limits of the wire contract."""

from kurt2rt.core.lesson_speed import SLOWEST

VERSION = 1
"""Version of the wire contract, that is of /hello and /state. A device refuses any other and tells the remedy."""
BOOT_BYTES = 4
COMMAND_ID_BYTES = 8
UPLOAD_ID_BYTES = 8
SHA256_BYTES = 32
HIGHEST_SPEED_M_S = 2.0
LONGEST_WAY_M = 100.0
LONGEST_TEXT = 64
LONGEST_FILE_NAME = 128
LONGEST_BEHAVIOUR_TICKS = 60_000
"""Ten minutes at 100 Hz."""
LARGEST_NUMBER = 2**53
"""Largest tick, sequence number or RLA: the largest integer that every language holds exactly."""
MOST_LESSONS = 20
MOST_CONTRADICTIONS = 16
"""Lessons whose neighbours the robot looks at for a list: its next tick waits for it."""
MOST_GOAL_FEATURES = 16
MOST_SITUATIONS = 250
"""Most names in an answer: 250 of the longest fit."""
PART_BYTES = 8192
"""Most bytes of a file in one answer, which the network carries in a few datagrams."""
UPLOAD_PART_BYTES = 896
"""Most bytes of a file in one request, whose body is at most 1024 bytes."""
MOST_UPLOAD_BYTES = 8_000_000
"""Largest file to upload: twice the size of 24 hours of teaching."""
FASTEST = 10
"""Most robot seconds in one second."""
SLOWEST_PERCENT = round(100 * SLOWEST)
"""Least speed of a lesson."""

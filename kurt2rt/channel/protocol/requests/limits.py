"""The version of the wire contract, and how much of anything it takes."""

VERSION = 4
"""Of the wire contract: what /hello and /state hold. A device refuses another one and says what to do."""
BOOT_BYTES = 4
COMMAND_ID_BYTES = 8
HIGHEST_SPEED_M_S = 2.0
LONGEST_WAY_M = 100.0
LONGEST_TEXT = 64
MOST_LESSONS = 20
MOST_GOAL_FEATURES = 16
MOST_SITUATIONS = 250
"""Of names that are told: so many of the longest ones fit into one answer."""
PART_BYTES = 8192
"""Of a file that one answer brings: a few datagrams of the network, as a world with many walls is."""
LONGEST_FILE_NAME = 128
UPLOAD_PART_BYTES = 896
"""Of a file that one request brings: the longest whole part of a kilobyte that a request may have."""
MOST_UPLOAD_BYTES = 8_000_000
"""Of a file that is uploaded: twice what a day of 24 hours of teaching takes."""
UPLOAD_ID_BYTES = 8
SHA256_BYTES = 32
FASTEST = 10
"""Robot seconds in one second, at most."""
LARGEST_NUMBER = 2**53
"""Of ticks, sequence numbers and RLAs: the largest that every language holds exactly."""
LONGEST_BEHAVIOUR_TICKS = 60_000
"""Ten minutes at 100 Hz."""

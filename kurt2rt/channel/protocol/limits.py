"""Version and limits of the wire contract; those of a command's fields are in core/teaching/message_fields.py."""

VERSION = 1
"""Version of the wire contract, that is of /hello and /state. A device refuses any other and tells the remedy."""
BOOT_BYTES = 4
COMMAND_ID_BYTES = 8
UPLOAD_ID_BYTES = 8
SHA256_BYTES = 32
LONGEST_WAY_M = 100.0
LONGEST_FILE_NAME = 128
MOST_LESSONS = 20
MOST_CONTRADICTIONS = 16
"""Lessons whose neighbours the robot looks at for a list: its next tick waits for it."""
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

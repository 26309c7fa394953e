"""What can go wrong before anybody is there to talk to. Each message is one line: what, where, what to do."""


class ChannelError(Exception):
    """The teacher's channel cannot be opened."""


class CredentialsError(ChannelError):
    """A pairing is missing, damaged, in use by another program, or not allowed."""

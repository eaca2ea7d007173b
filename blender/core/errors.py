"""The exception whose message the user reads."""


class Item3dError(Exception):
    """The message is one line: the subject, what was expected and found, and what to try."""

"""The one exception that users are meant to read."""


class Item3dError(Exception):
    """One line: what it is about, what was expected and found, and what to try."""

"""The one exception that the command line shows as a plain line."""


class UserError(ValueError):
    """Something that the user gave is wrong: the message names it, the value and the remedy."""

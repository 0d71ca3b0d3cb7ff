"""The kinds of faults that a channel shows by itself, one a file."""

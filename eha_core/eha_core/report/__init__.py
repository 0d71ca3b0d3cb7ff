"""A diagnosis shown to people: on the terminal, as a page, as pictures, and as a recording for other tools."""

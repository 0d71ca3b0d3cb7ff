"""Reports of a diagnosis: on the terminal, as a page, as figures, and as a recording for other tools."""

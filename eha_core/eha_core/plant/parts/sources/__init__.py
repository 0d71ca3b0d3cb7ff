"""Where the oil comes from, or what takes its place."""

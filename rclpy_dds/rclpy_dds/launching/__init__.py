"""YAML launch files: what they describe, and the processes they start."""

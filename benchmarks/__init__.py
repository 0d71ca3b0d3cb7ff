"""What the project's speed is measured against. `eha bench` runs every benchmark and prints one table."""

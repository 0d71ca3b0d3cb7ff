"""What the project's speed is measured against. `make bench` runs every benchmark and prints one table."""

"""The live page of a rig: its web server, and the page itself."""

"""Recordings as rosbag2 keeps them: MCAP files and the metadata beside them."""

"""Stage 7, next experiment: how well a test signal would tell rival explanations apart, and which does it best."""

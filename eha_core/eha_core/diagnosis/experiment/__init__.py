"""Stage 7, next experiment: how well a test signal would distinguish rival explanations, and which does it best."""

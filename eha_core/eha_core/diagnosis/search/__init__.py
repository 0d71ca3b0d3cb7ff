"""The search for what is missing: sets of effects proposed, refitted together, compared and thinned out.

`grow` adds to the best sets what promises most until nothing earns its place or only noise is left; `settle` fits the
best to their optimum from several initial guesses; `exchange` lets everything compete for each member's place; `prune`
drops what does not earn its place beside the others.
"""

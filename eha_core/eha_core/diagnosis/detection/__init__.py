"""The smallest detectable size of each effect, given a fitted model, from the search's own quadratic model."""

"""The smallest size of each effect that shows beside a fitted model, from the search's own quadratic model."""

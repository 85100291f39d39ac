"""Which physical attributes can be told from what a robot senses: features, estimators, scores."""

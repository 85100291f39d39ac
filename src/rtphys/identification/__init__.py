"""Which physical attributes can be inferred from what a robot senses: features and estimators."""

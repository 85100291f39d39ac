"""`identify`: episodes of the expert as features, and how well estimators read physics in them."""

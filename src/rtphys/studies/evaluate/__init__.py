"""Evaluating a policy on certified instances: one call."""

from rtphys.studies.evaluate.plan import EvaluatePlan
from rtphys.studies.evaluate.run import Table, evaluate

__all__ = ["EvaluatePlan", "Table", "evaluate"]

"""Collecting a dataset: one call."""

from rtphys.studies.collect.costs import Cost, Estimate, bytes_below, estimate
from rtphys.studies.collect.crew import size_of
from rtphys.studies.collect.deal import dealt
from rtphys.studies.collect.join import merge
from rtphys.studies.collect.manifest import find_collection, plans_of
from rtphys.studies.collect.measure import probe
from rtphys.studies.collect.plan import CollectPlan
from rtphys.studies.collect.run import Listener, Summary, collect
from rtphys.studies.collect.sweep import swept
from rtphys.studies.collect.tally import Tally

__all__ = [
    "CollectPlan",
    "Cost",
    "Estimate",
    "Listener",
    "Summary",
    "Tally",
    "bytes_below",
    "collect",
    "dealt",
    "estimate",
    "find_collection",
    "merge",
    "plans_of",
    "probe",
    "size_of",
    "swept",
]

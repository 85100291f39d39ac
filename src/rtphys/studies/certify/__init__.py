"""Certifying instances: which seeds the expert solves. One call."""

from rtphys.studies.certify.order import Order
from rtphys.studies.certify.plan import CertifyPlan
from rtphys.studies.certify.run import certify

__all__ = ["CertifyPlan", "Order", "certify"]

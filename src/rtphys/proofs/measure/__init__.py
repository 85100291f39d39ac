"""Measures what an episode's label says in the built world, by experiment and never by read-back.

Masses are weighed by a known force, surfaces are hit by a ball, joints are turned. What a label
multiplies is taken from the asset's files, not from what the simulator holds.
"""

"""The Mental Communication Game: a negotiation won by reading a person.

The packages and who may import whom are the floor plan, enforced by ``tests/test_floor_plan.py``.
"""

"""Extremes and faults: what must happen where a scene, a machine or an input is beyond measure."""

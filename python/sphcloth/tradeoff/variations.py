"""What packaged scenes of one kind of water vary: up to and beyond the limit of stability."""

from __future__ import annotations

COEFFICIENTS = ("0.2", "0.4", "0.8", "1.2", "1.4", "1.6", "1.8", "2.0", "2.2")
# of the limit by acceleration, where one step is chosen for all
FORCE = ("0.05", "0.2")
# ceilings of schemes in which particles have steps of their own
CEILINGS = ("1.0", "2.0", "4.0")
UNEQUAL = {"acoustic": COEFFICIENTS[1:6:2], "ceiling": CEILINGS}
ONE_RESOLUTION = {
    "constant": {"acoustic": COEFFICIENTS},
    "global": {"acoustic": COEFFICIENTS[1:6], "force": FORCE},
    "individual": UNEQUAL,
    "block": UNEQUAL,
}

"""What packaged scenes of one kind of water vary: up to and beyond the limit of stability."""

from __future__ import annotations

# of constant steps, over h_s / c_0
COEFFICIENTS = ("0.2", "0.4", "0.8", "1.2", "1.4", "1.6", "1.8", "2.0", "2.2")
# of the longest stable step, for schemes that find it; the last one is the default
SHARES = ("0.24", "0.475", "0.7", "0.95")
# ceilings of schemes in which particles have steps of their own
CEILINGS = ("1.0", "2.0", "4.0")
UNEQUAL = {"stability": SHARES[1:], "ceiling": CEILINGS}
ONE_RESOLUTION = {
    "constant": {"acoustic": COEFFICIENTS},
    "global": {"stability": SHARES},
    "individual": UNEQUAL,
    "block": UNEQUAL,
}

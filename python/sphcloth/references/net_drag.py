"""Measured drag of flat nets across a current, as fits to towing tests.

With the solidity S, the share of the area that twines cover, the drag coefficient of a net across
the flow, over rho/2 U^2 and its area, is by G. Loland, Current forces on and flow through fish
farms, thesis, Norwegian Institute of Technology 1991,

    C_D = 0.33 S + 6.54 S^2 - 4.88 S^3,

a fit to the tests of nets of S from 0.13 to 0.32 by H. Rudi, G. Loland and L. Furunes, MARINTEK
report MT 51 F88-0215, 1988.
"""

from __future__ import annotations

from sphcloth.errors import UserError

# solidities of the nets that were measured
MEASURED = (0.13, 0.32)


def measured_drag(solidity: float) -> float:
    """Return the drag coefficient of a net across the flow.

    Raises:
        UserError: a solidity that was not measured.
    """
    low, high = MEASURED
    if not low <= solidity <= high:
        raise UserError(
            f"measured_drag: solidity = {solidity:g}: nets of {low} to {high} were measured"
        )
    return 0.33 * solidity + 6.54 * solidity**2 - 4.88 * solidity**3

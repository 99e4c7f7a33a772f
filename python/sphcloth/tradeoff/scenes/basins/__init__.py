"""A drop falls into one of several basins: all other water rests."""

from __future__ import annotations

from dataclasses import replace

from sphcloth.tradeoff.scenes import resting_pool

SCENE = replace(
    resting_pool.SCENE,
    name="basins",
    summary="a drop falls into the first of twelve basins at rest, two dimensions",
    variations={
        "constant": {"acoustic": ("0.8", "1.2", "1.4", "1.6", "1.8", "2.0")},
        "global": {"stability": ("0.475", "0.7", "0.95")},
        "individual": {"stability": ("0.475", "0.95"), "ceiling": ("1.0",)},
        "block": {"stability": ("0.475", "0.7", "0.95"), "sleep": ("0.005", "0.01", "0.02")},
    },
    variables=resting_pool.SCENE.variables
    | {"basins": "12", "width": "0.4", "t_settle": "4.0", "t_end": "4.8"},
    quick={"spacing": "0.02"},
)

"""``sphcloth tradeoff``: error of a scene against its cost, for every scheme of the time step."""

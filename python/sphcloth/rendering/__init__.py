"""Pictures of water and cloth, drawn in NumPy: no display, no graphics driver."""

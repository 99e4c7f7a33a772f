"""Scenes of cloth in contact with itself, with other cloth and with obstacles."""

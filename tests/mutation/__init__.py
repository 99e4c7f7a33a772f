"""Mutants drawn at random: ``python tests/mutate_random.py``."""

"""Validation: cases with a known answer, run through LAMMPS and compared with it."""

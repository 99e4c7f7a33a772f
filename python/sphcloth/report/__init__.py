"""One HTML page of what runs have shown, with nothing to fetch from anywhere."""

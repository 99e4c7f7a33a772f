"""What a scene needs and what it never used, from a short run of its script."""

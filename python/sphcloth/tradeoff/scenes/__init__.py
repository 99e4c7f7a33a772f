"""The packaged scenes: a package each, with ``SCENE``."""

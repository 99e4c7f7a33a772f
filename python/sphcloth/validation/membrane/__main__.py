"""``python -m sphcloth.validation.membrane``."""

from sphcloth.validation.membrane import main

main()

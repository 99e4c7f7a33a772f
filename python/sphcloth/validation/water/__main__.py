"""``python -m sphcloth.validation.water``."""

from sphcloth.validation.water import main

main()

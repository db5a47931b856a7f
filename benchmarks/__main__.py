"""``python -m benchmarks`` is ``vitruvius bench``."""

import sys

from vitruvius.cli import main

main(["bench", *sys.argv[1:]])

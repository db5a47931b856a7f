"""``python -m benchmarks.paper`` is ``vitruvius bench paper``."""

import sys

from vitruvius.cli import main

main(["bench", "paper", *sys.argv[1:]])

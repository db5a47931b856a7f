"""``python -m benchmarks`` is ``vitruvius bench``."""

import sys

from agent.cli import main

main(["bench", *sys.argv[1:]])

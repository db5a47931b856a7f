"""``python -m benchmarks.simulator`` is ``vitruvius bench simulator``."""

import sys

from agent.cli import main

main(["bench", "simulator", *sys.argv[1:]])

"""``python -m benchmarks.generator`` is ``vitruvius bench generator``."""

import sys

from agent.cli import main

main(["bench", "generator", *sys.argv[1:]])

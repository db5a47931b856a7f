"""``python -m benchmarks.agents`` is ``vitruvius bench agents``."""

import sys

from agent.cli import main

main(["bench", "agents", *sys.argv[1:]])

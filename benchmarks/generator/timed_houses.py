"""Makes houses for ``pair.py`` in the checkout that PYTHONPATH names: the CPU seconds of each."""

import json
import sys
from time import process_time

from logic.generation.builder import Builder
from logic.grammar import find
from logic.request.request import Request

LIMIT = 10**9

builder = Builder(find(sys.argv[1]))
for line in sys.stdin:
    rooms, seed, index = json.loads(line)
    began = process_time()
    builder.house(Request(rooms), seed, index, LIMIT)
    print(process_time() - began, flush=True)

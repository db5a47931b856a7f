"""A solver process, started by ``logic.solver``: JSON lines in and out over pipes.

Rule files can loop, crash, eat memory or halt the process that runs them, so clingo and SWI-Prolog run here,
with limited memory, and the parent owns deadlines and Ctrl-C. The first line names the grammar; each
further line asks for one house, or why one is as it is. Each is answered by a line: ``{"versions": ...}``,
with ``warnings`` where these are asked for, ``{"house": ...}``, ``{"why": ...}`` or ``{"error": ...}``; a
count of layouts by several, of which ``{"count": null}`` is the last.
"""

import json
import os
import queue
import resource
import threading
import traceback
from typing import TextIO

import msgspec

from logic.errors import LimitReached, VitruviusError, to_record

MEMORY = 4 << 30
"""Bytes of address space that a worker may take."""


def main() -> None:
    """Answer requests until the parent closes its end of the pipe."""
    questions, answers = _private_pipes()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    requests: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(questions, requests), daemon=True).start()
    builder = None
    while True:
        request = json.loads(requests.get())
        try:
            # Imported here: that a solver is missing is an answer too.
            from logic.builder import Builder
            from logic.grammar import find
            from logic.request import Request

            if "lint" in request:
                from logic.linter import findings

                answer = {"findings": msgspec.to_builtins(findings(find(request["grammar"])))}
            elif builder is None:
                grammar = find(request["grammar"])
                builder = Builder(grammar, request["cell"])
                answer = {"versions": builder.versions, "warnings": []}
                if request.get("warn"):
                    from logic.linter import warnings

                    answer["warnings"] = list(map(str, warnings(grammar, builder.loaded)))
            elif "count" in request:
                wanted = Request.read(request["request"])
                builder.require_known(wanted)
                for count in builder.programs.counts(wanted, request["count"]):
                    answers.write(json.dumps({"count": count}) + "\n")
                    answers.flush()
                answer = {"count": None}
            elif "why" in request:
                from logic.house import House
                from logic.witness import Witness

                witness = Witness(builder, House.from_dict(request["house"]), request["inferences"])
                answer = {"why": msgspec.to_builtins(witness.why(**request["why"]))}
            else:
                wanted = Request.read(request["request"])
                house = builder.house(wanted, request["seed"], request["index"], request["inferences"])
                answer = {"house": house.to_dict()}
        except VitruviusError as error:
            answer = {"error": to_record(error)}
        except MemoryError:
            answer = {
                "error": to_record(LimitReached(f"the solvers need more than {MEMORY >> 30} GiB of memory"))
            }
        except Exception:
            answer = {"error": to_record(VitruviusError(traceback.format_exc()))}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


def _private_pipes() -> tuple[TextIO, TextIO]:
    """The pipes from and to the parent; the rules read nothing, and what they print goes to stderr."""
    questions, answers = os.fdopen(os.dup(0), encoding="utf-8"), os.fdopen(os.dup(1), "w", encoding="utf-8")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    return questions, answers


def _listen(parent: TextIO, requests: "queue.SimpleQueue[str]") -> None:
    """Pass on the parent's lines, and end with it: the solvers do not notice by themselves."""
    for line in parent:
        requests.put(line)
    os._exit(0)

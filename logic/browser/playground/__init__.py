"""``vitruvius playground``: the page of a grammar that needs no installation, as a folder of static files.

clingo and SWI-Prolog run in the browser, as WebAssembly. ``folder.py`` gathers the page of
``watch/page``, the ``engine.js`` of this folder, which takes the place of the server's, the solvers'
packages and the rules. ``solver/`` does in JavaScript what ``logic.layout``, ``logic.generation``,
``logic.language`` and ``logic.proofs`` do, with the same rules and the same random numbers: a test compares
the houses.
"""

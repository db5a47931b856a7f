"""``vitruvius playground``: a grammar's page without installation, as a folder of static files.

clingo and SWI-Prolog run in the browser, as WebAssembly. ``folder.py`` copies the page of ``watch/page``, the
``engine.js`` of this folder, which replaces the one that asks a server, the solvers' packages and the rules.
``solver/`` does in JavaScript the work of ``logic.layout``, ``logic.generation``, ``logic.language`` and
``logic.proofs``, with the same rules and the same random numbers. A test compares the houses.
"""

"""A Q-network that searches: it values every place and heading that the body can come to, and goes to the
best.

The body keeps the map, follows paths, and walks to a target in sight (``agent.planner``). Where it has no
goal the network reads a window of that map (``maps.py``) and gives each view a value (``network.py``), the
targets a step that it brings; the best one is the next goal (``chooser.py``). No view is chosen by a rule.

It learns in states that it came to itself, as in DAgger (Ross et al. 2011, arXiv:1011.0686), and its labels
are not sampled: in training the house is known, so the expected value of each view can be computed
(``values.py``), as of the searcher that knows the house (``sim.baselines.views``).
"""

"""Q-network that searches: it values every place and heading that the body can reach, and goes to the best.

The body keeps the map, follows paths, and goes to a target in sight (``agent.planner``). When the body has no
goal, the network reads a window of the map (``maps.py``). It gives each view a value (``network.py``): the
expected targets per step. The best view is the next goal (``chooser.py``). No rule chooses a view.

The network learns in states that it reached itself, as in DAgger (Ross et al. 2011, arXiv:1011.0686). Its
labels are not sampled: training knows the house, so the expected value of each view can be computed
(``values.py``), as for the searcher that knows the house (``agent.baselines.views``).
"""

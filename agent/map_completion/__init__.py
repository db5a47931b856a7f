"""Learned map completion: what lies where a planner's map shows nothing yet, and where targets lie.

A small network reads a window of the map about the body and predicts for each block, two by two cells,
whether it is floor, whether targets lie on such floor, and the type of its room. It learns from houses alone
(``learner.py``): explorers make the maps, the houses tell what was to be predicted (``truth.py``). What it
predicts is written into the planner's ``prior`` (``foresight.py``): as what places count, which of them paths
may lead through, and where views end.

The idea is that of occupancy anticipation (Ramakrishnan, Al-Halah and Grauman 2020, arXiv:2008.09285) and of
PONI (Ramakrishnan et al. 2022, arXiv:2201.10029).
"""

"""Learned map completion: what lies where a planner's map shows nothing yet, and where targets lie.

A small network reads a window of the map about the body, with where targets were picked up and which kinds
of pieces rays have met there (``marks.py``). It predicts of each block, two by two cells, whether it is floor
and how likely the next target lies in it, and of four blocks together what they are: a type of room, a kind
of piece, a wall, a door. It learns from houses alone (``learner.py``): explorers make the maps, the houses
tell what was to be predicted (``truth.py``). What it predicts is written into the planner's ``prior``
(``foresight.py``): as what places count, where bodies may stand and go, and where views end.

The idea is that of occupancy anticipation (Ramakrishnan, Al-Halah and Grauman 2020, arXiv:2008.09285) and of
PONI (Ramakrishnan et al. 2022, arXiv:2201.10029).
"""

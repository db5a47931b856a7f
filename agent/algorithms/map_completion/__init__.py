"""Learned map completion: a network predicts unseen ground on a planner's map, and where targets lie.

A small network reads a window of the map about the body. The window also shows where targets were picked up
and which kinds of furniture the rays have met there (``marks.py``). For each block of two by two cells, the
network predicts whether the block is floor and how likely the next target lies in it. For each four blocks
together it predicts their kind: a type of room, a kind of furniture, a wall, a door.

The network is trained on houses alone (``learner.py``): explorers make the maps, and the houses give the
labels (``truth.py``). Its predictions are written into the planner's ``prior`` (``foresight.py``): what
places count, where bodies may stand and go, and where views end.

The idea is that of occupancy anticipation (Ramakrishnan, Al-Halah and Grauman 2020, arXiv:2008.09285) and of
PONI (Ramakrishnan et al. 2022, arXiv:2201.10029).
"""

"""A map's whole numbers, by name: ``COUNTS`` of them for each environment."""

NONE, SEARCH, TARGET = range(3)
"""What a goal is: none, a place where a target may hide, the target that was seen."""

TIME = 0
"""Steps."""

X, Y = 1, 2
"""The eye's place, in half cells east and south of its start."""

HEADING = 3
"""In eighths of a turn."""

SINCE = 4
"""The step since which a target that is not known may have lain where it lies."""

KNOWN = 5
"""Whether a target is known."""

KIND, GOAL = 6, 7
"""What the goal is, and its node: of a target, about where it lies (``FIRM``)."""

QUEUED, AGE, STALE = 8, 9, 10
"""How long the last search's queue is; steps since that search, and cells that were found occupied since."""

NEW, SEEN, LAST_NEW = 11, 12, 13
"""Cells seen for the first time in the last step, and ever; when there were any last."""

FOUND, HERE = 14, 15
"""Targets picked up, as far as it knows: all, and those in the space that the episode began in."""

WAY, PROGRESS = 16, 17
"""Half cells to the goal, and how many fewer than before the last action."""

LOOK, THINK = 18, 19
"""Of a view: the heading to look at, -1 for none, and the steps since it was chosen."""

ALIGNED = 20
"""Whether a wall has told how the heading lies to the house."""

STRAIGHT = 21
"""Half cells that the body went straight on since the last sweep; -1 where all floor is to be noted anew."""

COUNTS = 22

"""What a map counts, by the names of the numbers: ``COUNTS`` of them for each environment."""

NONE, SEARCH, TARGET = range(3)
"""What a goal is: none, a place where a target may hide, the target that was seen."""

(TIME, X, Y, HEADING, SINCE, KNOWN, KIND, GOAL, QUEUED, AGE, STALE) = range(11)
(NEW, SEEN, LAST_NEW, FOUND, WAY, PROGRESS) = range(11, 17)
(LOOK, THINK, HERE, ALIGNED) = range(17, 21)
"""What a map counts: steps; the eye's place in half cells and its heading; since when a target that is not
known may have lain where it lies; whether one is known; the goal; how long the last search's queue is, how
old it is and how many cells were occupied since; cells that are new, and all; when there were new ones last;
targets picked up as far as it knows; half cells to the goal, and how many fewer than before the last action.
Of a view: the heading to look at, -1 for none, and the steps since it was chosen; targets picked up in the
space that the episode began in; whether a wall has told how the heading lies to the house.
"""

COUNTS = 21

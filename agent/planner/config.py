"""Every tuned number of the planner. A cell is half a body wide, 0.14 m at the default body; a node is a
corner of cells; a half cell is half of a cell's side.
"""

from dataclasses import dataclass

CERTAIN = 100
"""What a candidate target place counts that is certainly free floor; others count a part of it."""


@dataclass(frozen=True)
class PlannerConfig:
    """What a planner is tuned by. A kernel is compiled once for each configuration, and reads it as
    constants.

    Raises ``ValueError`` for numbers that the kernel cannot keep.
    """

    # Occupancy.

    map_bits: int = 8
    """The map is a torus of 2 to this power cells a side, 8 to 10: 36.7 m, 73 m or 147 m. In larger houses
    far ends lie on each other."""

    near: int = 8
    """Unseen cells up to this far from seen ones count as free for paths."""

    hit_margin: float = 0.07
    """Cells about a ray's end that count as occupied too: a centimetre, more than the shield's margin."""

    evidence_hit: int = 3
    """How much more a noisy ray that ends in a cell counts than one that passes it."""

    evidence_occupied: int = 3
    """The count from which on a cell is occupied; it is free again at 0."""

    evidence_most: int = 24
    """The greatest count."""

    wall_gap: float = 2.9
    """Cells between two ray ends on one line that are joined to a wall: less than a door is wide."""

    wall_gap_touching: float = 1.9
    """The same where bodies fill cells of a grid: there a passage may be as narrow as a body."""

    outer_cells: int = 8
    """Of the 12 cells around a candidate's inner four, how many must not have been seen either."""

    # Visibility.

    ray_width: float = 0.7
    """Cells from a ray at which a cell's centre still lies on it."""

    ray_beyond: float = 0.45
    """Cells that a ray must reach beyond a cell's centre for the cell to be seen."""

    sweep_interval: int = 2
    """Steps from a sweep of the rays to the next, while the body goes straight on and sees nothing new."""

    sweep_interval_known: int = 4
    """The same while a target is known: all floor counts as unseen once that is picked up."""

    sweep_margin: float = 1.0
    """Cells before the end of the last sweep from which on cells are marked again."""

    # The target that was seen.

    target_apart: float = 4.5
    """Cells between two sightings from which on they are of two targets: the first was picked up."""

    target_certain: float = 12.0
    """Cells from which the place of a target is known well enough to notice that it is gone."""

    target_flat: float = 0.02
    """Cells that ray ends on one face of a target may lie apart across it."""

    target_contact: float = 0.125
    """Cells between the body and a target that count as contact."""

    target_core: float = 0.5
    """Cells from a target's centre at which a ray must have met it."""

    target_behind: float = 1.0
    """Cells beyond a target's centre that a ray must reach to have missed it."""

    picked_up: float = 5.0
    """Cells from a target, along both axes, at which it was picked up if it is gone."""

    # Belief.

    floor_odds: tuple[int, ...] = (0, 0, 0, 0, 0, 0, 0, 7, 23, 38, 57, 63, 76, 87, 87, 87, 87)
    """What an unseen candidate counts, in hundredths of a seen one: by the number of the eight directions in
    which the first known cell is floor, less those in which it is occupied, -8 to 8."""

    odds_range: int = 9
    """Cells that are looked up in each of these directions."""

    pick_up_error: float = 0.05
    """Share of pick-ups that are taken for one in the start room though they were outside, or the reverse."""

    floor_elsewhere: float = 0.5
    """Share of a house's floor that lies outside the start room."""

    start_room: int = 120
    """Cells that the start room may reach from the start, in each direction."""

    # Viewpoints.

    viewpoint_pitch: int = 4
    """Nodes between two viewpoints, along both axes: a power of two."""

    viewpoint_cost: float = 4.0
    """Steps added to the length of each path when viewpoints are compared."""

    viewpoint_rays: int = 5
    """Rays in each octant of a view: a view is three octants, 135 degrees."""

    view_stride: int = 2
    """Cells between two places on such a ray."""

    view_range: int = 54
    """Cells from a viewpoint to the last place on a ray: 7.7 m, just under the range of the rays."""

    view_least: float = 0.02
    """The probability of getting so far, by a prior, below which a ray is not followed."""

    gain_most: int = 600
    """Candidates beyond which more information gain counts for nothing."""

    gain_least: float = 2.0
    """Candidates that a viewpoint must show; where none does, the goal is the nearest candidate itself."""

    gain_growth: float = 1.2
    """Times the last gain that a viewpoint may show by now."""

    gain_between: float = 1.3
    """Times the best gain beside it that a viewpoint may show from which none was computed."""

    gain_spare: int = 50
    """What both may show more, in hundredths of a candidate."""

    replan_interval: int = 32
    """Steps until the next viewpoint is chosen, though the last was not reached."""

    # Paths.

    path_interval: int = 8
    """Steps from a path search to the next if nothing changed but that more cells are occupied."""

    path_slack: int = 8
    """Nodes by which a path may be longer than expected before the search gives up."""

    path_detour: float = 1.25
    """Times the straight distance that a path to a target is expected to be long."""

    path_beyond: int = 3
    """Nodes beyond the body to which distances are computed, so that it may stray."""

    path_turns: int = 40
    """Nodes of a path along which turns are counted."""

    target_drift: int = 32
    """Half cells of path for each node that a target may turn out to lie aside before a new search."""

    target_overlap: float = 0.1
    """Cells that the body goes further than to the contact with a target."""

    goal_radius: float = 2.5
    """Cells from a goal at which a path may end if none leads to the goal itself."""

    goal_radius_touching: float = 1.5
    """The same where bodies fill cells of a grid: there a wall is as thin as a line."""

    def __post_init__(self) -> None:
        """Refuse what the kernel cannot keep."""
        if not 8 <= self.map_bits <= 10:
            raise ValueError(f"map_bits must be 8, 9 or 10, not {self.map_bits}")
        if self.viewpoint_pitch < 4 or self.viewpoint_pitch & (self.viewpoint_pitch - 1):
            raise ValueError(f"viewpoint_pitch must be a power of two, 4 or more, not {self.viewpoint_pitch}")
        if max(self.near, self.odds_range) > 14:
            raise ValueError("near and odds_range must be 14 at most: only tiles side by side become dirty")
        if len(self.floor_odds) != 17 or not all(0 <= each <= CERTAIN for each in self.floor_odds):
            raise ValueError(f"floor_odds needs 17 whole numbers, 0 to {CERTAIN}, not {self.floor_odds}")
        if not 0 < self.view_stride <= self.view_range <= 127:
            raise ValueError("view_stride must be at least 1, view_range at least that and at most 127")
        if not 0 <= self.view_least < 1:
            raise ValueError(f"view_least must be a probability below 1, not {self.view_least}")
        if min(self.sweep_interval, self.sweep_interval_known) < 2:
            raise ValueError("sweep_interval and sweep_interval_known must be 2 at least")


TUNED = PlannerConfig()
"""The numbers as they were tuned: ``docs/planner.md``."""

"""Tuned numbers of the planner.

A cell is half a body wide, 0.14 m at the default body. A node is a corner of cells. A half cell is half of a
cell's side.
"""

from dataclasses import dataclass

CERTAIN = 100
"""Weight of a candidate place that is certainly free floor; other candidates count a fraction of it."""


@dataclass(frozen=True)
class PlannerConfig:
    """Tuned numbers of a planner.

    A kernel is compiled once for each configuration and reads these numbers as constants. Raises
    ``ValueError`` for numbers that the kernel cannot store.
    """

    # Occupancy.

    map_bits: int = 8
    """Exponent of the map's side: the map is a torus of 2 to this power cells a side, 8 to 10 (36.7 m, 73 m
    or 147 m). In larger houses, distant parts fall on the same cells."""

    near: int = 8
    """Distance from seen cells, in cells, up to which unseen cells count as free for paths."""

    hit_margin: float = 0.07
    """Margin about a ray's end, in cells, in which cells count as occupied, too: a centimetre, more than the
    shield's margin."""

    evidence_hit: int = 3
    """Increment of a cell's evidence when a noisy ray ends in it; a ray that passes the cell subtracts 1."""

    evidence_occupied: int = 3
    """Evidence from which on a cell is occupied; the cell is free again at 0."""

    evidence_most: int = 24
    """Largest evidence of a cell."""

    wall_gap: float = 2.9
    """Largest gap, in cells, between two ray ends on one line that are joined to a wall: narrower than a
    door."""

    wall_gap_touching: float = 1.9
    """Same for bodies that fill cells of a grid, where a passage may be as narrow as a body."""

    outer_cells: int = 8
    """Least number of unseen cells among the 12 around a candidate's inner four."""

    # Visibility.

    ray_width: float = 0.7
    """Largest distance, in cells, from a ray to the centre of a cell that lies on the ray."""

    ray_beyond: float = 0.45
    """Distance, in cells, that a ray must reach beyond a cell's centre for the cell to be seen."""

    sweep_interval: int = 2
    """Steps from one sweep of the rays to the next while the body goes straight on and sees nothing new."""

    sweep_interval_known: int = 4
    """Same while a target is known: all floor counts as unseen once the target is picked up."""

    sweep_margin: float = 1.0
    """Cells before the end of the last sweep, from which on the next sweep marks cells again."""

    # The target that was seen.

    target_apart: float = 4.5
    """Distance between two sightings, in cells, above which they belong to two targets: the first was picked
    up."""

    target_certain: float = 12.0
    """Distance, in cells, within which the planner knows a target's place well enough to notice that it is
    gone."""

    target_flat: float = 0.02
    """Largest spread, in cells across a target's face, of ray ends on that face."""

    target_contact: float = 0.125
    """Largest gap, in cells, between the body and a target that counts as contact."""

    target_core: float = 0.5
    """Distance from a target's centre, in cells, within which a ray must have met the target."""

    target_behind: float = 1.0
    """Distance beyond a target's centre, in cells, that a ray must reach to have missed the target."""

    picked_up: float = 5.0
    """Distance from a target, in cells along each axis, within which a target that is gone counts as picked
    up."""

    # Belief.

    floor_odds: tuple[int, ...] = (0, 0, 0, 0, 0, 0, 0, 7, 23, 38, 57, 63, 76, 87, 87, 87, 87)
    """Weight of an unseen candidate, in hundredths of a seen one. The index, -8 to 8, is the number of the
    eight directions in which the first known cell is floor, minus the number in which it is occupied."""

    odds_range: int = 9
    """Number of cells that are looked up in each of these directions."""

    pick_up_error: float = 0.05
    """Fraction of pick-ups that are assigned to the start room although they were outside, or the reverse."""

    floor_elsewhere: float = 0.5
    """Fraction of a house's floor that lies outside the start room."""

    start_room: int = 120
    """Largest extent of the start room from the start, in cells, in each direction."""

    # Viewpoints.

    viewpoint_pitch: int = 4
    """Nodes between two viewpoints along each axis: a power of two."""

    viewpoint_cost: float = 4.0
    """Steps added to the length of each path when viewpoints are compared."""

    viewpoint_rays: int = 5
    """Number of rays in each octant of a view; a view is three octants, 135 degrees."""

    view_stride: int = 2
    """Cells between two places on such a ray."""

    view_range: int = 54
    """Distance from a viewpoint to the last place on a ray, in cells: 7.7 m, just under the range of the
    rays."""

    view_least: float = 0.02
    """Probability, by a prior, that sight gets so far; a ray with less is not followed."""

    gain_most: int = 600
    """Number of candidates above which more information gain does not count."""

    gain_least: float = 2.0
    """Least number of candidates that a viewpoint must show. If no viewpoint does, the goal is the nearest
    candidate."""

    gain_growth: float = 1.2
    """Largest factor by which a viewpoint's gain may have grown since it was computed."""

    gain_between: float = 1.3
    """Largest factor by which a viewpoint without a computed gain may exceed the best gain next to it."""

    gain_spare: int = 50
    """Constant added to both bounds, in hundredths of a candidate."""

    replan_interval: int = 32
    """Steps after which the planner chooses the next viewpoint even if it has not reached the last."""

    # Paths.

    path_interval: int = 8
    """Steps from one path search to the next if nothing changed except that more cells are occupied."""

    path_slack: int = 8
    """Nodes by which a path may be longer than expected before the search gives up."""

    path_detour: float = 1.25
    """Expected length of a path to a target, in units of the straight distance."""

    path_beyond: int = 3
    """Nodes beyond the body up to which distances are computed, so that the body may stray."""

    path_turns: int = 40
    """Number of nodes of a path along which turns are counted."""

    target_drift: int = 32
    """Half cells of path for each node of the target's drift: the drift that starts a new search grows with
    the path."""

    target_overlap: float = 0.1
    """Distance, in cells, that the body goes beyond the contact with a target."""

    goal_radius: float = 2.5
    """Distance from a goal, in cells, at which a path may end if none leads to the goal itself."""

    goal_radius_touching: float = 1.5
    """Same for bodies that fill cells of a grid, where a wall is as thin as a line."""

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for numbers that the kernel cannot store."""
        if not 8 <= self.map_bits <= 10:
            raise ValueError(f"map_bits must be 8, 9 or 10, not {self.map_bits}")
        if self.viewpoint_pitch < 4 or self.viewpoint_pitch & (self.viewpoint_pitch - 1):
            raise ValueError(f"viewpoint_pitch must be a power of two, 4 or more, not {self.viewpoint_pitch}")
        if max(self.near, self.odds_range) > 14:
            raise ValueError("near and odds_range must be at most 14: only adjacent tiles are updated")
        if len(self.floor_odds) != 17 or not all(0 <= each <= CERTAIN for each in self.floor_odds):
            raise ValueError(f"floor_odds needs 17 whole numbers, 0 to {CERTAIN}, not {self.floor_odds}")
        if not 0 < self.view_stride <= self.view_range <= 127:
            raise ValueError(
                "view_stride must be at least 1; view_range must be at least view_stride and at most 127"
            )
        if not 0 <= self.view_least < 1:
            raise ValueError(f"view_least must be a probability below 1, not {self.view_least}")
        if min(self.sweep_interval, self.sweep_interval_known) < 2:
            raise ValueError("sweep_interval and sweep_interval_known must be 2 at least")


TUNED = PlannerConfig()
"""Numbers as tuned in ``docs/planner.md``."""

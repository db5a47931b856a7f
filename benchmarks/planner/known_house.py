"""The Bayes limit of a house: how soon the best searcher that knows the house, but not the target, finds it.

The target lies at one of N places, each as likely. A searcher goes from pose to pose; what it has not seen is
where the target may be. Once seen, the target is picked up by a shortest path. So a route of looks has an
exact expectation, and the limit is that of the best route. To find it is a travelling repairman problem on a
graph: here it is bounded by the best of the greedy route, random routes about it, and rollouts of it.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from sim.baselines.view_planner import HASTE, REPLAN
from sim.runtime import Array, Launch, start, ti
from sim.world.episodes import Indices, Numbers
from sim.world.philox import Words, philox, uniform

ACTIONS, NEVER = 3, 1 << 20
"""Turn left, turn right, forward. Steps to what no path leads to."""

SPREADS = 0.0, 0.15, 0.3, 0.6
"""How far random routes take what a look is worth to be another: logarithms, at most twice of it."""

NEAR = 4
"""Steps within which every pose may be gone to for a look: so near a turn is all that it takes."""

OVERLAP = 0.85
"""Share of what a look shows above which another one is not tried beside it."""

Costs, Bytes = ti.types.ndarray(ti.i64, 1), ti.types.ndarray(ti.u8, 1)


@dataclass(frozen=True)
class Search:
    """A house as a searcher knows it, with P poses and N places."""

    after: np.ndarray
    """(P, 3) int32: the pose that each action leads to, -1 where it is not possible."""
    shown: np.ndarray
    """(P, N) bool: which places a look from the pose shows."""
    away: np.ndarray
    """(P, N) int32: steps from the pose to the pick-up of a target at the place, or ``NEVER``."""
    views: np.ndarray
    """(P,) bool: poses that routes may go to for a look, besides those within ``NEAR`` steps."""


class Limit(NamedTuple):
    """Expected steps to the pick-up."""

    oracle: float
    """Of what knows the target."""
    greedy: float
    """Of the route by most gain for its cost."""
    best: float
    """Of the best route that was found."""


def known_house_limit(
    search: Search, pose: int, places: np.ndarray, restarts: int = 60, candidates: int = 8, seed: int = 0
) -> Limit:
    """Expected steps from a pose to a target that lies, as likely, at any of ``places`` (N,) bool.

    ``restarts`` random routes are tried, and rollouts that compare so many ``candidates`` at every plan.
    Raises ``ValueError`` for no place, or one that no path leads to.
    """
    wanted = np.flatnonzero(places)
    if not len(wanted) or (search.away[pose, wanted] >= NEVER).any():
        raise ValueError("a limit needs a place, and a path to each: leave the others out of places")
    routes = Routes(search)
    first = routes.look(Route(pose, 0, places.copy(), 0))
    greedy = routes.finish(first, [-1], [0.0], seed)[0]
    spreads = np.array(SPREADS[1:])[np.arange(restarts) % (len(SPREADS) - 1)]
    random = routes.finish(first, [-1] * restarts, spreads, seed + 1) if restarts else []
    rolled = routes.rollout(first, candidates) if candidates else greedy
    count = len(wanted)
    best = min([greedy, rolled, *random])
    return Limit(float(search.away[pose, wanted].mean()), greedy / count, best / count)


class Route(NamedTuple):
    """A route so far: where it is, after how many steps, what it has not seen, what it has cost."""

    pose: int
    time: int
    left: np.ndarray
    """(N,) bool."""
    cost: int
    """Steps to the pick-up, summed over the places that were seen."""


class Routes:
    """Routes through a house."""

    def __init__(self, search: Search) -> None:
        """Keep the house where a kernel reads it."""
        self.search, program = search, start()
        self._tours = _tours(program)
        poses, places = search.shown.shape
        self._arrays = {
            "after": Array.of(search.after.astype(np.int32).ravel()),
            "shown": Array.of(search.shown.astype(np.uint8).ravel()),
            "away": Array.of(search.away.astype(np.int32).ravel()),
            "views": Array.of(search.views.astype(np.uint8)),
        }
        self._poses, self._places, self._batches = poses, places, {}

    def look(self, route: Route) -> Route:
        """The same, with a look from where it is."""
        new = route.left & self.search.shown[route.pose]
        cost = int((route.time + self.search.away[route.pose, new]).sum())
        return route._replace(left=route.left & ~new, cost=route.cost + cost)

    def finish(self, route: Route, goals: Any, spreads: Any, seed: int) -> np.ndarray:
        """Costs (T,) of this route, gone on to each of ``goals`` (T,), -1 for none, then greedily, with what
        looks are worth changed by ``spreads`` (T,).
        """
        count, places = len(goals), self._places
        given = self._batches.get(count)
        if given is None:
            given = self._batches[count] = {
                "state": Array(ti.i32, 2 * count),
                "goals": Array(ti.i32, count),
                "spreads": Array(ti.f32, count),
                "left": Array(ti.u8, count * places),
                "cost": Array(ti.i64, count),
                "distance": Array.of(np.full(count * self._poses, -1, np.int32)),
                "queue": Array(ti.i32, count * self._poses),
                "parent": Array(ti.i32, count * self._poses),
                "seed": Array(ti.i32, 1),
                "listed": Array(ti.i32, count * places),
            }
        given["state"].fill(np.tile(np.array([route.pose, route.time], np.int32), count))
        given["goals"].fill(np.array(goals, np.int32))
        given["spreads"].fill(np.array(spreads, np.float32))
        given["left"].fill(np.tile(route.left.astype(np.uint8), count))
        given["cost"].fill(np.full(count, route.cost, np.int64))
        given["seed"].fill(np.array([seed], np.int32))
        Launch(self._tours, self._arrays | given)()
        return given["cost"].numpy()

    def rollout(self, route: Route, candidates: int) -> int:
        """Cost of a route that at every plan goes to the candidate from which the greedy route is best."""
        while route.left.any():
            distance, parent = self.paths(route.pose)
            beside = np.flatnonzero((distance > 0) & (self.search.views | (distance <= NEAR)))
            gain = self.search.shown[np.ix_(beside, np.flatnonzero(route.left))]
            worth = gain.sum(axis=1) / (distance[beside] + HASTE)
            chosen: list[int] = []
            for k in np.argsort(-worth, kind="stable"):
                if worth[k] <= 0 or len(chosen) == candidates:
                    break
                size = gain[k].sum()
                both = [(gain[k] & gain[c]).sum() / max(size, gain[c].sum()) for c in chosen]
                if not any(share > OVERLAP for share in both):
                    chosen.append(k)
            if not chosen:  # Only poses that are no views show the rest.
                return int(self.finish(route, [-1], [0.0], 0)[0])
            padded = [int(beside[k]) for k in chosen] + [-1] * (candidates - len(chosen))
            costs = self.finish(route, padded, np.zeros(candidates), 0)
            goal, path = padded[int(costs.argmin())], []
            if goal < 0:
                return int(costs.min())
            while goal != route.pose:
                path.append(goal)
                goal = parent[goal]
            for pose in path[::-1][:REPLAN]:
                route = self.look(route._replace(pose=int(pose), time=route.time + 1))
        return route.cost

    def paths(self, pose: int) -> tuple[np.ndarray, np.ndarray]:
        """Steps (P,) to every pose, -1 where no path leads, and the pose before it."""
        distance, parent = np.full(self._poses, -1), np.full(self._poses, -1)
        front, distance[pose], steps = np.array([pose]), 0, 0
        while len(front):
            steps += 1
            there, origin = self.search.after[front].ravel(), np.repeat(front, ACTIONS)
            new = (there >= 0) & (distance[there] < 0)
            front, first = np.unique(there[new], return_index=True)
            distance[front], parent[front] = steps, origin[new][first]
        return distance, parent


@cache
def _tours(program: Any) -> Any:
    @ti.kernel
    def tours(
        after: Indices, shown: Bytes, away: Indices, views: Bytes, state: Indices, goals: Indices,
        spreads: Numbers, left: Bytes, cost: Costs, distance: Indices, queue: Indices, parent: Indices,
        seed: Indices, listed: Indices,
    ):  # fmt: skip
        """Finish each route."""
        poses, count = views.shape[0], goals.shape[0]
        places = shown.shape[0] // poses
        ti.loop_config(block_dim=1)
        for t in range(count):
            base, mask = t * poses, t * places
            pose, time, total, forced, plans = state[2 * t], state[2 * t + 1], 0, goals[t], 0
            for n in range(places):
                total += ti.cast(left[mask + n], ti.i32)
            while total > 0 and plans < ti.static(NEVER):
                number = 0
                for n in range(places):
                    if left[mask + n]:
                        listed[mask + number] = n
                        number += 1
                # Nearest poses first, until no pose further away can be better.
                head, tail, goal, best, any_, going = 0, 1, -1, ti.f32(0.0), -1, 1
                queue[base], distance[base + pose], parent[base + pose] = pose, 0, -1
                widest = ti.exp(2.0 * spreads[t])
                while going == 1 and head < tail:
                    here = queue[base + head]
                    head += 1
                    steps = distance[base + here]
                    price = ti.cast(steps, ti.f32) + ti.static(HASTE)
                    if forced >= 0:
                        if here == forced:
                            goal, going = here, 0
                    elif best > 0 and total * widest / price <= best:
                        going = 0
                    elif steps > 0 and (views[here] == 1 or steps <= ti.static(NEAR) or any_ < 0):
                        gain = 0
                        for m in range(total):
                            gain += ti.cast(shown[here * places + listed[mask + m]], ti.i32)
                        if gain > 0 and any_ < 0:
                            any_ = here
                        if gain > 0 and (views[here] == 1 or steps <= ti.static(NEAR)):
                            worth = gain / price
                            if spreads[t] > 0:
                                counter = Words(ti.u64(plans), ti.u64(here), ti.u64(t), ti.u64(0))
                                word = philox(ti.cast(seed[0], ti.u64), counter)[0]
                                worth *= ti.exp(2.0 * spreads[t] * (2.0 * uniform(word) - 1.0))
                            if worth > best:
                                best, goal = worth, here
                    if going == 1:
                        for action in range(ti.static(ACTIONS)):
                            there = after[here * ti.static(ACTIONS) + action]
                            # Nested: Taichi's ``and`` computes both sides.
                            if there >= 0:  # noqa: SIM102
                                if distance[base + there] < 0:
                                    distance[base + there], parent[base + there] = steps + 1, here
                                    queue[base + tail] = there
                                    tail += 1
                if goal < 0:
                    goal = any_
                # The path, from its end; then along it, for so long as a plan lasts.
                length = 0
                if goal >= 0:
                    length = distance[base + goal]
                for k in range(tail):
                    distance[base + queue[base + k]] = -1
                here = goal
                for k in range(length):
                    queue[base + length - 1 - k] = here
                    here = parent[base + here]
                most = ti.min(length, ti.static(REPLAN))
                if forced >= 0:
                    most = length
                for k in range(most):
                    if total > 0:
                        pose = queue[base + k]
                        time += 1
                        for n in range(places):
                            if left[mask + n] & shown[pose * places + n]:
                                left[mask + n] = ti.cast(0, ti.u8)
                                total -= 1
                                cost[t] += ti.cast(time + away[pose * places + n], ti.i64)
                plans += 1
                if length == 0 and forced < 0:
                    cost[t] += ti.cast(total, ti.i64) * ti.static(NEVER)
                    total = 0
                forced = -1

    return tours

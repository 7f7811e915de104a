# SPDX-License-Identifier: MIT-0
"""A guide that a planner in Python draws from."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Union

from . import _trellis
from ._scripts import guide as _guide
from ._trellis import Error, Guide, Problem

if TYPE_CHECKING:
    import numpy

    Array = numpy.ndarray[Any, Any]


class Draw(NamedTuple):
    """What a sampler drew.

    id:     of this draw, from 1; its answer names it.
    q:      the configuration, of shape (D,): inside the space, possibly invalid.
    guided: whether the guide drew it; else it is uniform or a goal.
    node:   the number of the node that the guide would extend, or None: the nearest one.
    """

    id: int
    q: Array
    guided: bool
    node: Optional[int]


class Sampler:
    """A guide (f, h) that a planner of one's own draws from.

        sampler = trellis.Sampler("skeleton()", problem, seed=1)
        while True:
            draw = sampler.draw()
            near = nearest(tree, draw.q)
            if motion_is_valid(tree[near], draw.q):
                sampler.accepted(draw, draw.q, near, reached=True)
            else:
                sampler.rejected(draw, tree[near], draw.q, first_invalid)

    It searches the guiding spaces, as a run of Trellis does, and learns from what becomes of the draws: the nodes that
    were added, and the places where motions are invalid. For each draw, in this order: `spent`, `draw`, one answer, then
    the motions that the planner tries besides (answers with None for the draw), then `joined`. The same seed and the
    same answers give the same draws, and those that the same planner draws within Trellis. Nodes have numbers: 0 is the
    start, the others follow in the order of their answers.

    guide:      a `trellis.Guide`, or its text, as "skeleton() >> shrink(0.5)".
    problem:    that the planner solves; its start and goals are valid.
    seed:       of all random streams, an integer of at least 0 (default 1).
    step:       the longest extension of the planner's tree, metres of the metric: guides follow paths in such steps
                (default 0.5).
    uniform:    the share of uniform draws, in [0, 1] (default 0.05).
    goal_bias:  the share of draws that are a goal, in [0, 1), for a planner that draws none itself (default 0).
    grant:      validity checks that the searches below may spend before a draw; until they are done, draws are uniform.
                0: 1.5 times those of the straight motion from start to goal (default: no limit).
    optimistic: no answers will come: each draw counts as accepted, as for planners that draw in bulk (default False).

    One thread uses a sampler at a time. Calls release the interpreter lock while levels are searched, and Ctrl-C ends
    them. Needs numpy. Raises `trellis.Error` for a fault of these, or a guide that does not suit the problem.
    """

    problem: Problem
    guide: Guide

    def __init__(
        self,
        guide: Union[Guide, str],
        problem: Problem,
        seed: int = 1,
        *,
        step: float = 0.5,
        uniform: float = 0.05,
        goal_bias: float = 0.0,
        grant: float = math.inf,
        optimistic: bool = False,
    ) -> None:
        self.guide = _guide(guide) if isinstance(guide, str) else guide
        self.problem = problem
        self._optimistic = optimistic
        self._of = _trellis.sampler(self.guide, problem, seed, step, uniform, goal_bias, grant, optimistic)

    def __repr__(self) -> str:
        return f"<trellis.Sampler {self.guide} on '{self.problem.name}', {self.state}>"

    def draw(self, side: str = "start") -> Draw:
        """Draws the next proposal, after the searches below that it needs. A draw that has no answer at the next one
        counts as rejected without a place.

        side: the tree that it is for, "start" (default) or "goal".
        """
        return Draw(*self._of.draw(side))

    def draw_many(self, n: int, side: str = "start") -> Array:
        """Draws n proposals, of shape (n, D), of which each counts as accepted.

        Raises `trellis.Error` unless the sampler is `optimistic`.
        """
        found: Array = self._of.draw_many(n, side)
        return found

    def root(self, side: str = "start", goal: int = 0) -> int:
        """The number of a root: the start, or a goal, which becomes a node at the first call."""
        return self._of.root(side, goal)

    def node(self, q: Any) -> Optional[int]:
        """The number of the node with exactly these coordinates, or None."""
        return self._of.node(q)

    def accepted(
        self,
        draw: Optional[Draw],
        q: Any,
        parent: Optional[int] = None,
        *,
        reached: bool = False,
        connected: bool = True,
        side: str = "start",
    ) -> int:
        """Answers that a node was added at q, and returns its number.

        draw:      the last one; None: the planner tried this motion without a draw.
        q:         of shape (D,).
        parent:    the number of the node that was extended; None: there is none, as in a roadmap.
        reached:   whether q is the draw itself (default False: a part of the way).
        connected: whether checked motions connect it to the start, or with side="goal" to a goal (default True).
        side:      the tree that it belongs to, "start" (default) or "goal".

        Raises `trellis.Error` for a draw that is not the last one or has an answer, and for an unknown parent.
        """
        return self._of.accepted(0 if draw is None else draw.id, q, parent, reached, connected, side)

    def rejected(self, draw: Optional[Draw], start: Any = None, end: Any = None, at: Any = None) -> None:
        """Answers that no node was added, or that a motion is invalid.

        draw:  the last one; None: a motion without a draw.
        start: the valid beginning of the motion; None: there was no motion.
        end:   its other end; needed without a draw.
        at:    a configuration on it that was found invalid; None: the draw was out of reach.

        Raises `trellis.Error` as `accepted`.
        """
        self._of.rejected(0 if draw is None else draw.id, start, end, at)

    def joined(self, node: int, side: str = "start") -> None:
        """A node of a roadmap became connected to the start (default) or to a goal."""
        self._of.joined(node, side)

    def cleared(self) -> None:
        """The planner discarded its tree or roadmap: the start has number 0 again, and the others follow anew."""
        self._of.cleared()

    def path_found(self, length: float) -> None:
        """The planner has found a path, the first or a shorter one; its length in metres of the metric."""
        self._of.path_found(length)

    def worth_connecting(self, start: Any, end: Any) -> bool:
        """Whether the guide has no evidence against a motion beyond the last draw, as to a goal or to another tree."""
        return self._of.worth_connecting(start, end)

    def edge_factor(self, a: Any, b: Any) -> float:
        """A factor of at least 1 on the cost of an edge in a search of a lazy roadmap."""
        return self._of.edge_factor(a, b)

    def spent(self, checks: int) -> None:
        """Adds validity checks of the planner since the last call: guides divide work by them."""
        self._of.spent(checks)

    def allow(self, checks: int) -> str:
        """Searches below without a draw, for at most about so much work, in checks and proposals. Returns `state`."""
        return self._of.allow(checks)

    def density(self, Q: Any) -> Optional[Array]:
        """The density of the next draw at configurations of shape (N, D), per volume in metric coordinates, of shape
        (N,); None where it has no closed form. Searches below as `draw` does."""
        found: Optional[Array] = self._of.density(Q)
        return found

    @property
    def state(self) -> str:
        """How far the search of the guiding space is: "untried", "searching", "found", "nothing" (it ended without a
        path) or "impossible" (it is finite and contains no path)."""
        return self._of.state()

    @property
    def checks(self) -> int:
        """Validity checks of all levels below and of the guide itself, without the planner's."""
        return self._of.checks()

    @property
    def levels(self) -> List[Dict[str, Any]]:
        """A dict of each level, the planner's first: `level`, `name`, `planner`, `checks`, `solved`, `names` of the
        coordinates, `proposals` (N, D), `nodes` (M, D), `parents` (M,), -1 for none, and `path` (K, D) or None."""
        return self._of.levels()


__all__ = ["Draw", "Error", "Sampler"]

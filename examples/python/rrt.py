# SPDX-License-Identifier: MIT-0
"""An RRT in numpy that draws from a guide of Trellis.

    python3 examples/python/rrt.py [PROBLEM [GUIDE]]

prints its validity checks with uniform draws and with the guide's, medians of ten seeds, and the sampling efficiency of
the guide's draws of the last one. PROBLEM: default 'worlds.maze { cells = 6, seed = 1 }'; GUIDE: default 'skeleton()'.
"""
import sys

import numpy as np

import trellis

STEP, RESOLUTION, MOST = 0.5, 0.05, 20000


def rrt(problem, sampler):
    """Returns the path, or None, and the number of validity checks."""
    weights, wraps = np.array(problem.weights), np.array(problem.periodic)
    goal = np.array(problem.goals[0])
    tree, parents, checks = [np.array(problem.start)], [0], 0

    def to(a, b):
        """The difference of coordinates, the short way round."""
        d = b - a
        return np.where(wraps, (d + np.pi) % (2 * np.pi) - np.pi, d)

    for _ in range(MOST):
        draw = sampler.draw()
        distances = np.linalg.norm(to(np.array(tree), draw.q) * weights, axis=1)
        near = int(np.argmin(distances))
        whole = to(tree[near], draw.q) * min(1.0, STEP / max(distances[near], 1e-9))
        n = max(1, int(np.ceil(np.linalg.norm(whole * weights) / RESOLUTION)))
        motion = tree[near] + np.arange(1, n + 1)[:, None] / n * whole
        motion = np.where(wraps, (motion + np.pi) % (2 * np.pi) - np.pi, motion)
        invalid = np.flatnonzero(~problem.valid(motion))
        spent = int(invalid[0]) + 1 if invalid.size else n
        checks += spent
        sampler.spent(spent)
        if invalid.size:
            sampler.rejected(draw, tree[near], motion[-1], motion[invalid[0]])
            continue
        sampler.accepted(draw, motion[-1], near, reached=distances[near] <= STEP)
        tree.append(motion[-1])
        parents.append(near)
        if np.linalg.norm(to(motion[-1], goal) * weights) < 0.2:
            path, at = [], len(tree) - 1
            while at != 0:
                path.append(tree[at])
                at = parents[at]
            return [tree[0], *path[::-1]], checks
    return None, checks


def main(problem="worlds.maze { cells = 6, seed = 1 }", guide="skeleton()"):
    problem = trellis.problem(problem)
    for text in ("uniform()", guide):
        checks = []
        for seed in range(1, 11):
            sampler = trellis.Sampler(text, problem, seed, step=STEP, goal_bias=0.05)
            path, spent = rrt(problem, sampler)
            checks.append(spent + sampler.checks if path else np.inf)
        print(f"{text}: {np.median(checks):.0f} checks, {np.isfinite(checks).sum()} of 10 solved")
    if path:
        print(trellis.Recorder.of(sampler).measure(path, delta=0.5))


if __name__ == "__main__":
    main(*sys.argv[1:])

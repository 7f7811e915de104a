# SPDX-License-Identifier: MIT-0
"""The schedule of a team: when its robots move, and how close they come."""
from __future__ import annotations

import itertools
from typing import Any, List, Mapping, NamedTuple, Optional, Tuple

import numpy as np

from . import _style
from ._document import Document, Error, Results, read
from ._scenes import Array, PlanarRobot, Scene, path_of
from ._style import COLUMN, FAINT, GREY, INK, SMALL
from ._worlds import Seed, best, chosen_run, chosen_scene, pictured

# Distances -----------------------------------------------------------------------------------------------------------


def _nearest(simplex: Array, used: Array) -> Tuple[Array, Array]:
    """The points nearest to the origin of simplices (n, 4, 3), and which corners they need; `used` marks the corners
    that there are."""
    count = len(simplex)
    best = np.full(count, np.inf)
    point, kept = np.zeros((count, 3)), np.zeros((count, 4), bool)
    for size in (1, 2, 3, 4):
        for corners in itertools.combinations(range(4), size):
            rows = np.flatnonzero(used[:, corners].all(1))
            if not len(rows):
                continue
            w = simplex[rows][:, corners]
            share = _affine(w)
            inside = (share >= -1e-12).all(1) & np.isfinite(share).all(1)
            at = (share[..., None] * w).sum(1)
            length = (at * at).sum(1)
            better = inside & (length < best[rows] * (1 - 1e-12))
            rows, at = rows[better], at[better]
            best[rows], point[rows], kept[rows] = length[better], at, False
            kept[rows[:, None], np.array(corners)] = True
    return point, kept


def _affine(w: Array) -> Array:
    """The shares of the corners in the point nearest to the origin of the flat that they span."""
    count, size, _ = w.shape
    if size == 1:
        return np.ones((count, 1))
    gram = w @ w.transpose(0, 2, 1)
    scale = np.maximum(np.trace(gram, axis1=1, axis2=2), 1e-300)[:, None, None]
    system = np.zeros((count, size + 1, size + 1))
    system[:, :size, :size] = gram / scale + 1e-14 * np.eye(size)
    system[:, :size, size] = system[:, size, :size] = 1.0
    right = np.zeros((count, size + 1, 1))
    right[:, size] = 1.0
    try:
        return np.linalg.solve(system, right)[:, :size, 0]
    except np.linalg.LinAlgError:
        return (np.linalg.pinv(system) @ right)[:, :size, 0]


def distances(first: Array, second: Array) -> Array:
    """Distances of convex hulls (n, k, 3) and (n, m, 3), pair by pair; 0 where they meet (Gilbert, Johnson,
    Keerthi)."""
    count = len(first)
    out = np.zeros(count)
    simplex, used = np.zeros((count, 4, 3)), np.zeros((count, 4), bool)
    v = first[:, 0] - second[:, 0]
    simplex[:, 0], used[:, 0] = v, True
    size = np.maximum(np.abs(first).max((1, 2)), np.abs(second).max((1, 2))) + 1e-12
    open_ = np.arange(count)
    for _ in range(40):
        d = v[open_]
        far = np.take_along_axis(first[open_], np.argmin((first[open_] * d[:, None]).sum(-1), 1)[:, None, None], 1)
        near = np.take_along_axis(second[open_], np.argmax((second[open_] * d[:, None]).sum(-1), 1)[:, None, None], 1)
        w = (far - near)[:, 0]
        square = (d * d).sum(1)
        done = (square - (d * w).sum(1) <= 1e-9 * square) | (square <= (1e-9 * size[open_]) ** 2)
        out[open_[done]] = np.where(square[done] <= (1e-9 * size[open_[done]]) ** 2, 0, np.sqrt(square[done]))
        open_, w = open_[~done], w[~done]
        if not len(open_):
            return out
        free = np.argmin(used[open_], 1)
        simplex[open_, free], used[open_, free] = w, True
        v[open_], used[open_] = _nearest(simplex[open_], used[open_])
        whole = used[open_].all(1)  # the origin is inside
        out[open_[whole]] = 0
        open_ = open_[~whole]
    out[open_] = np.linalg.norm(v[open_], axis=1)
    return out


class _Part(NamedTuple):
    """A convex part of a robot at several moments: the hull of points (moments, k, 3), grown by a radius."""

    member: int
    points: Array
    radius: float


def _components(triangles: Array, count: int) -> Array:
    """Of each vertex, the number of the connected piece that it belongs to."""
    label = np.arange(count)
    while True:
        least = label[triangles].min(1)
        new = label.copy()
        for k in range(3):
            np.minimum.at(new, triangles[:, k], least)
        new = np.minimum(new, new[new])
        if (new == label).all():
            return label
        label = new


def _parts(scene: Scene, rows: Array) -> List[_Part]:
    robot = scene.robot
    parts: List[_Part] = []
    if isinstance(robot, PlanarRobot):
        for body, radius, points in robot.shapes(rows):
            flat = np.concatenate([points, np.zeros(points.shape[:2] + (1,))], 2)
            parts.append(_Part(robot.member[body], flat, radius))
        return parts
    spatial: Any = robot
    surfaces = spatial.surfaces
    pieces = _components(surfaces.triangles, len(surfaces.vertices))
    vertices = np.stack([spatial.placed(q).surfaces.vertices for q in rows])
    columns = spatial.columns()
    for piece in np.unique(pieces):
        own = np.flatnonzero(pieces == piece)
        column = columns[surfaces.of_vertex[own[0]]]
        parts.append(_Part(scene.member_of(column), vertices[:, own], 0.0))
    return parts


def gaps(scene: Scene, rows: Array) -> Array:
    """The smallest distance between two robots of a team at each configuration, m. Each part counts as its convex hull.
    """
    parts = _parts(scene, rows)
    middle = np.stack([part.points.mean(1) for part in parts])
    reach = np.stack([np.linalg.norm(part.points - middle[i][:, None], axis=2).max(1) + part.radius
                      for i, part in enumerate(parts)])
    members = np.array([part.member for part in parts])
    i, j = np.triu_indices(len(parts), 1)
    i, j = (one[members[i] != members[j]] for one in (i, j))
    smallest = np.full(len(rows), np.inf)
    lower = np.empty((len(i), len(rows)))
    for k, (a, b) in enumerate(zip(i, j)):
        apart = np.linalg.norm(middle[a] - middle[b], axis=1)
        lower[k] = apart - reach[a] - reach[b]
        smallest = np.minimum(smallest, np.maximum(0, apart - parts[a].radius - parts[b].radius))
    # The nearest pairs first: those that cannot come closer are not computed.
    order = np.argsort(lower, axis=0, kind="stable")
    moment = np.arange(len(rows))
    for rank in range(len(i)):
        pair = order[rank, moment]
        moment = moment[lower[pair, moment] < smallest[moment]]
        if not len(moment):
            break
        pair = order[rank, moment]
        wide = max(len(parts[k].points[0]) for one in (i, j) for k in np.unique(one[pair]))
        padded = [np.stack([_padded(parts[one[p]].points[t], wide) for p, t in zip(pair, moment)]) for one in (i, j)]
        grown = np.array([parts[i[p]].radius + parts[j[p]].radius for p in pair])
        found = np.maximum(0, distances(*padded) - grown)
        smallest[moment] = np.minimum(smallest[moment], found)
    return smallest


def _padded(points: Array, count: int) -> Array:
    return np.concatenate([points, np.repeat(points[:1], count - len(points), 0)])


# Schedule ------------------------------------------------------------------------------------------------------------


def _timed(run: Mapping[str, Any]) -> bool:
    path = path_of(run)
    at: List[float] = (run.get("times") or {}).get("at") or []
    return path is not None and len(at) == len(path) and at[-1] > 0


def scheduled(results: Results) -> List[str]:
    """The problems of teams with a run that has times."""
    found = []
    for problem in pictured(results):
        runs = [run for name in results.strategies for run in results.runs(problem, name)]
        if any(_timed(run) for run in runs) and len(chosen_scene(results, problem).team) > 1:
            found.append(problem)
    return found


def _speeds(scene: Scene, path: Array, at: Array) -> Array:
    """The speed of each robot on each leg, in the metric of the space, m/s."""
    span = np.diff(at)
    lengths = np.stack([scene.space.distances(path[:-1], path[1:], member.columns) for member in scene.team])
    return np.where(span > 0, lengths / np.where(span > 0, span, 1), 0)


def _lanes(ax: Any, scene: Scene, at: Array, speeds: Array) -> None:
    top = max(float(speeds.max()), 1e-300)
    end = at[-1]
    for i, (member, own) in enumerate(zip(scene.team, speeds)):
        moves = np.flatnonzero(own > 0.02 * top)
        stop = at[moves[-1] + 1] if len(moves) else 0.0
        height = np.repeat(own / top, 2) * 0.76
        x = np.repeat(at, 2)[1:-1]
        ax.fill_between(x, i + 0.38 - height, i + 0.38, color=member.colour, linewidth=0, zorder=2)
        ax.plot([0, stop], [i + 0.38] * 2, color=member.colour, linewidth=0.5, zorder=3, solid_capstyle="butt")
        waits = float(np.diff(at)[(own <= 0.02 * top) & (at[1:] <= stop + 1e-12)].sum())
        if waits > 0.005 * end:
            _style.words(ax, 1, i, f"waits {_style.digits(waits)} s", 1.5, color=INK)
        elif stop < 0.99 * end:
            _style.words(ax, 1, i, f"until {_style.digits(stop, 3)} s", 1.5, color=GREY)
    _style.rows_axis(ax, [f"robot {member.number}" for member in scene.team])


def schedule(document: Document, *, problem: Optional[str] = None, strategy: Optional[str] = None, seed: Seed = None,
             ax: Any = None) -> Any:
    """Which robot of a team moves when, who slows down or waits, and how close do they come? A lane for each robot, as
    high as it is fast, in the metric of its space; at the right how long it waits before it arrives, or when it arrives
    before the last. Below, the smallest distance between two robots, of all bodies, with its least value.

    document: what `read` takes; it needs no samples.
    problem:  the name of a problem with a team (default the first).
    strategy: the name of a strategy (default the cheapest that is no baseline and has a path).
    seed:     of the run (default the first solved one).
    ax:       two axes, for the lanes and for the distance (default those of a new figure, 86 mm wide).

    Returns both axes, an array. Raises `Error` as `world` does, for a robot alone, and for a run without a path.
    """
    results = read(document)
    if problem is None:
        found = scheduled(results)
        if not found:
            raise Error(f"{results.file}: no run of a team has a path with times")
        problem = found[0]
    scene = chosen_scene(results, problem)
    if len(scene.team) < 2:
        raise Error(f"{results.file}: '{problem}' has no team, which a schedule needs")
    name = best(results, problem) if strategy is None else results.chosen([strategy])[0]
    run = chosen_run(results, problem, name, seed, solved=True)
    path = path_of(run)
    if path is None or not _timed(run):
        raise Error(f"{results.file}: the path of '{name}' on '{problem}' has no times")
    at = np.asarray(run["times"]["at"], float)
    moments = np.union1d(np.linspace(0, at[-1], 241), at)
    gap = gaps(scene, scene.space.along(path, at, moments))
    count = len(scene.team)
    label = "smallest gap, m"
    with _style.styled():
        axes = _style.given(ax, 2, "schedule")
        if axes is None:
            axes = _placed(count, max(_style.width_of([label], SMALL), _style.width_of([f"robot {count}"])) + 4.5)
        lanes, low = axes
        _lanes(lanes, scene, at, _speeds(scene, path, at))
        lanes.tick_params(axis="x", length=0)
        lanes.spines["bottom"].set_visible(False)
        _style.linear_axis(lanes, 0, at[-1])
        lanes.set_xticklabels([])
        lanes.set_title(_style.cut(f"{problem}, {name}: all arrive within {_style.digits(at[-1], 3)} s",
                                   _style.size_of(lanes)[0] + 14))
        low.fill_between(moments, gap, color=FAINT, linewidth=0, zorder=1)
        low.plot(moments, gap, color=INK, linewidth=0.8, zorder=2)
        least = int(np.argmin(gap))
        low.plot(moments[least], gap[least], "o", markersize=3, color=INK, clip_on=False, zorder=4)
        _style.linear_axis(low, 0, at[-1])
        low.set_ylim(0, max(float(gap.max()) * 1.05, 1e-9))
        low.set_yticks([])
        low.spines["left"].set_visible(False)
        low.grid(axis="x", color=FAINT, linewidth=0.5)
        middle = low.get_ylim()[1] / 2
        _style.words(low, 0, middle, label, -2, ha="right", color=INK)
        _style.words(low, 1, middle, f"{_style.digits(float(gap[least]))} m", 1.5, 1.4, color=INK)
        _style.words(low, 1, middle, f"at {_style.digits(float(moments[least]), 3)} s", 1.5, -1.4, color=INK)
        low.set_xlabel("time, s", fontsize=_style.SIZE, color=INK)
    return _style.returned(axes)


def _placed(count: int, left: float) -> List[Any]:
    row = min(5.5, (_style.HIGHEST - 29) / count)
    height = count * row + 29
    figure = _style.sheet("schedule", COLUMN, height)
    right = 15.0
    wide = (COLUMN - left - right) / COLUMN
    return [figure.add_axes([left / COLUMN, bottom / height, wide, high / height], label=f"schedule {k}")
            for k, (bottom, high) in enumerate(((22.5, count * row), (8.5, 11.0)))]

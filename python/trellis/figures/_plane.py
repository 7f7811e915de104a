# SPDX-License-Identifier: MIT-0
"""Pictures of the plane: obstacles, samples, trees, paths and robots in axes of matplotlib."""
from __future__ import annotations

from typing import Any, List, Optional, Sequence, Tuple

import numpy as np
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from . import _style
from ._scenes import Array, PlanarRobot, Scene

OBSTACLE, OBSTACLE_EDGE = "#e4e2dd", "#8f8b83"

# Layers, from the bottom to the top.
FILL, SAMPLES, TREE, EDGES, PATH, BODIES, ENDS, FRAME = 1.0, 2.0, 3.0, 6.0, 8.0, 10.0, 11.0, 12.0

# Outlines ------------------------------------------------------------------------------------------------------------


def rings_of(obstacles: Sequence[Sequence[float]], size: float) -> List[Array]:
    """The obstacles as polygons, counter-clockwise: of discs as many corners as their size in the picture needs."""
    rings = []
    for shape in obstacles:
        if len(shape) == 3:
            count = int(np.clip(16 * np.sqrt(max(shape[2], 0) / size * 40) + 12, 16, 96))
            angle = np.arange(count) * 2 * np.pi / count
            ring = np.asarray(shape[:2], float) + shape[2] * np.stack([np.cos(angle), np.sin(angle)], 1)
        else:
            ring = np.reshape(np.asarray(shape, float), (-1, 2))
            turn = ring[:, 0] * np.roll(ring[:, 1], -1) - ring[:, 1] * np.roll(ring[:, 0], -1)
            if turn.sum() < 0:
                ring = ring[::-1]
        rings.append(ring)
    return rings


def _pairs(lo: Array, hi: Array, other_lo: Array, other_hi: Array, size: float) -> Tuple[Array, Array]:
    """All pairs of boxes, one of each kind, that meet: by cells of a grid."""
    cells = int(np.clip(np.sqrt(len(other_lo)), 1, 256))
    origin = min(lo.min(), other_lo.min()) if len(lo) else 0.0
    extent = max(hi.max(), other_hi.max()) - origin if len(lo) else size

    def spread(a: Array, b: Array) -> Tuple[Array, Array]:
        first = np.clip(((a - origin) / extent * cells).astype(int), 0, cells - 1)
        last = np.clip(((b - origin) / extent * cells).astype(int), 0, cells - 1)
        count = last - first + 1
        total = count.prod(1)
        who = np.repeat(np.arange(len(a)), total)
        k = np.arange(len(who)) - np.repeat(np.cumsum(total) - total, total)
        cell = (first[who, 0] + k % count[who, 0]) * cells + first[who, 1] + k // count[who, 0]
        return who, cell

    mine, my_cell = spread(lo, hi)
    theirs, their_cell = spread(other_lo, other_hi)
    order = np.argsort(their_cell, kind="stable")
    theirs, their_cell = theirs[order], their_cell[order]
    begin, end = np.searchsorted(their_cell, my_cell, "left"), np.searchsorted(their_cell, my_cell, "right")
    count = end - begin
    first = np.repeat(mine, count)
    second = theirs[np.arange(len(first)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(begin, count)]
    meet = ((lo[first] <= other_hi[second]) & (hi[first] >= other_lo[second])).all(1)
    keys = np.unique(first[meet] * np.int64(max(1, len(other_lo))) + second[meet])
    return keys // max(1, len(other_lo)), keys % max(1, len(other_lo))


def _inside(points: Array, ring: Array) -> Array:
    """Whether points lie in a polygon (even-odd rule)."""
    a, b = ring, np.roll(ring, -1, 0)
    x, y = points[:, :1], points[:, 1:]
    spans = (a[:, 1] > y) != (b[:, 1] > y)
    rise = b[:, 1] - a[:, 1]
    at = a[:, 0] + (y - a[:, 1]) * (b[:, 0] - a[:, 0]) / np.where(rise == 0, 1, rise)
    inside: Array = (spans & (x < at)).sum(1) % 2 == 1
    return inside


def outline(rings: Sequence[Array], size: float) -> Array:
    """The boundary of the union of polygons: segments (n, 2, 2). A piece of an edge that lies in another polygon, or
    between two that touch, is left out.

    size: of the picture, by which points count as one.
    """
    if not rings:
        return np.zeros((0, 2, 2))
    owner = np.repeat(np.arange(len(rings)), [len(ring) for ring in rings])
    a = np.concatenate(rings)
    b = np.concatenate([np.roll(ring, -1, 0) for ring in rings])
    proper = np.hypot(*(b - a).T) > 1e-12 * size
    a, b, owner = a[proper], b[proper], owner[proper]
    eps = 1e-6 * size
    lo, hi = np.minimum(a, b) - eps, np.maximum(a, b) + eps
    # Where edges of other polygons cross or touch each edge.
    i, j = _pairs(lo, hi, lo, hi, size)
    other = owner[i] != owner[j]
    i, j = i[other], j[other]
    d, e, gap = (b - a)[i], (b - a)[j], a[j] - a[i]
    cross = d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0]
    safe = np.where(np.abs(cross) < 1e-15, 1, cross)
    t = (gap[:, 0] * e[:, 1] - gap[:, 1] * e[:, 0]) / safe
    u = (gap[:, 0] * d[:, 1] - gap[:, 1] * d[:, 0]) / safe
    length = np.hypot(*d.T)
    slack = eps / np.hypot(*e.T)
    crossing = (np.abs(cross) > 1e-9 * length * np.hypot(*e.T)) & (u >= -slack) & (u <= 1 + slack)
    cuts, of = [t[crossing]], [i[crossing]]
    for end in (a, b):  # ends of others on the edge, as of parallel ones
        along = ((end[j] - a[i]) * d).sum(1) / length**2
        off = np.abs((end[j] - a[i])[:, 0] * d[:, 1] - (end[j] - a[i])[:, 1] * d[:, 0]) / length
        near = off <= eps
        cuts.append(along[near])
        of.append(i[near])
    count = len(a)
    cut = np.concatenate([np.zeros(count), np.ones(count), *cuts])
    edge = np.concatenate([np.arange(count), np.arange(count), *of])
    kept = (cut >= 0) & (cut <= 1)
    order = np.lexsort((cut[kept], edge[kept]))
    cut, edge = cut[kept][order], edge[kept][order]
    piece = (edge[1:] == edge[:-1]) & ((cut[1:] - cut[:-1]) * np.hypot(*(b - a)[edge[1:]].T) > 2 * eps)
    edge, begin, end_ = edge[:-1][piece], cut[:-1][piece], cut[1:][piece]
    direction = (b - a)[edge]
    outward = np.stack([direction[:, 1], -direction[:, 0]], 1) / np.hypot(*direction.T)[:, None]
    probe = a[edge] + direction * ((begin + end_) / 2)[:, None] + outward * eps
    bounds = np.array([[ring.min(0), ring.max(0)] for ring in rings])
    who, ring_of = _pairs(probe, probe, bounds[:, 0], bounds[:, 1], size)
    foreign = ring_of != owner[edge[who]]
    who, ring_of = who[foreign], ring_of[foreign]
    hidden = np.zeros(len(edge), bool)
    order = np.argsort(ring_of, kind="stable")
    who, ring_of = who[order], ring_of[order]
    starts = [0, *(np.flatnonzero(ring_of[1:] != ring_of[:-1]) + 1), len(ring_of)] if len(ring_of) else []
    for start, stop in zip(starts[:-1], starts[1:]):
        some = who[start:stop]
        hidden[some[_inside(probe[some], rings[ring_of[start]])]] = True
    # Pieces that follow each other become one line again.
    shown = ~hidden
    joins = (edge[1:] == edge[:-1]) & (np.abs(begin[1:] - end_[:-1]) < 1e-9) & shown[1:] & shown[:-1]
    first = shown & ~np.concatenate([[False], joins])
    last = shown & ~np.concatenate([joins, [False]])
    return np.stack([a[edge[first]] + (b - a)[edge[first]] * begin[first, None],
                     a[edge[last]] + (b - a)[edge[last]] * end_[last, None]], 1)


# Strokes -------------------------------------------------------------------------------------------------------------


def compound(lines: Sequence[Array], closed: bool = False) -> Path:
    """Lines of points as one path."""
    vertices, codes = [], []
    for line in lines:
        code = np.full(len(line) + closed, Path.LINETO)
        code[0] = Path.MOVETO
        if closed:
            code[-1] = Path.CLOSEPOLY
            line = np.concatenate([line, line[:1]])
        vertices.append(line)
        codes.append(code)
    if not vertices:
        return Path(np.zeros((0, 2)))
    return Path(np.concatenate(vertices), np.concatenate(codes))


def chained(segments: Array) -> List[Array]:
    """Segments as lines: those that follow each other end to end become one."""
    if not len(segments):
        return []
    joins = np.isclose(segments[1:, 0], segments[:-1, 1], rtol=1e-12, atol=1e-12 * np.abs(segments).max()).all(1)
    starts = np.flatnonzero(np.concatenate([[True], ~joins]))
    ends = np.concatenate([starts[1:], [len(segments)]])
    return [np.concatenate([segments[i:i + 1, 0], segments[i:j, 1]]) for i, j in zip(starts, ends)]


def strokes(ax: Any, segments: Array, **options: Any) -> None:
    """Many segments as one path: one element of a file."""
    segments = np.asarray(segments, float).reshape(-1, 2, 2)
    if not len(segments):
        return
    patch = PathPatch(compound(chained(segments)), fill=False, **options)
    ax.add_artist(patch)
    patch.set_clip_path(ax.patch)


def filled(ax: Any, rings: Sequence[Array], **options: Any) -> None:
    """Polygons as one path, without seams where they touch."""
    if not len(rings):
        return
    patch = PathPatch(compound(rings, True), **options)
    ax.add_artist(patch)
    patch.set_clip_path(ax.patch)


def dots(ax: Any, points: Array, colour: str, alpha: float, size: float = 1.0, layer: float = SAMPLES) -> None:
    """Samples, as pixels."""
    if len(points):
        ax.plot(*points[:, :2].T, "o", markersize=size, markeredgewidth=0, color=colour, alpha=alpha, zorder=layer,
                rasterized=True)


def tree_stroke(count: int) -> Tuple[float, float]:
    """Width and opacity of the lines of a tree with so many."""
    return (0.45, 0.85) if count < 800 else (0.4, 0.6) if count < 5000 else (0.3, 0.45 if count < 20000 else 0.25)


def sample_alpha(count: int) -> float:
    """Opacity of so many samples."""
    return float(np.clip(250 / max(1, count), 0.15, 0.55))


# Views ---------------------------------------------------------------------------------------------------------------


class Body:
    """A robot to draw at a configuration.

    face: None for an outline alone. colours: of the robots of a team, in place of face and edge.
    """

    def __init__(self, robot: Any, q: Array, face: Optional[str], edge: str, width: float = 0.5, alpha: float = 1.0,
                 layer: float = BODIES, colours: Sequence[str] = ()) -> None:
        self.robot, self.q, self.face, self.edge = robot, q, face, edge
        self.width, self.alpha, self.layer, self.colours = width, alpha, layer, list(colours)


class PlaneView:
    """A picture of a world of the plane in axes."""

    def __init__(self, scene: Scene, bounds: Optional[Tuple[Array, Array]] = None) -> None:
        self.scene = scene
        self.lo, self.hi = bounds if bounds is not None else (scene.lo, scene.hi)
        self.extent = float(max(self.hi - self.lo))
        self._rings = rings_of(scene.world["obstacles"], self.extent)
        self._outline: Optional[Array] = None

    @property
    def aspect(self) -> float:
        """Height by width."""
        return float((self.hi[1] - self.lo[1]) / (self.hi[0] - self.lo[0]))

    def project(self, points: Array) -> Array:
        """Points of the world in the picture."""
        return np.asarray(points, float)[..., :2]

    def begin(self, ax: Any, bodies: Sequence[Body] = ()) -> None:
        """Draws the world and robots."""
        if self._outline is None:
            self._outline = outline(self._rings, self.extent)
        for side in ax.spines.values():
            side.set(visible=True, color=_style.GREY, linewidth=0.5, zorder=FRAME)
        ax.set(xticks=[], yticks=[], xlim=(self.lo[0], self.hi[0]), ylim=(self.lo[1], self.hi[1]))
        ax.set_aspect("equal", adjustable="box")
        filled(ax, self._rings, facecolor=OBSTACLE, linewidth=0, zorder=FILL)
        strokes(ax, self._outline, edgecolor=OBSTACLE_EDGE, linewidth=0.5, zorder=EDGES, capstyle="projecting")
        for body in bodies:
            self._body(ax, body)

    def axes(self, ax: Any) -> None:
        """Labels the axes, in metres."""
        ticks = [_style.round_ticks(lo, hi, 7) for lo, hi in zip(self.lo, self.hi)]
        texts = [[f"{tick:.6g}".replace("-", "−") for tick in its] for its in ticks]
        ax.set_xticks(ticks[0])
        ax.set_xticklabels(texts[0])
        ax.set_yticks(ticks[1])
        ax.set_yticklabels(texts[1])
        ax.tick_params(axis="y", labelsize=6.5)
        ax.set_xlabel("x, m", fontsize=_style.SIZE, color=_style.INK)
        ax.set_ylabel("y, m", fontsize=_style.SIZE, color=_style.INK)

    def _body(self, ax: Any, body: Body) -> None:
        if not isinstance(body.robot, PlanarRobot) or len(body.q) < body.robot.dimension:
            return
        placed = body.robot.placed(body.q)
        # Of a team each robot apart; of an arm all links as one shape, without seams at its joints.
        for member in sorted({shape.member for shape in placed}):
            rings = rings_of([[*shape.points[0], shape.radius] if shape.radius > 0 else shape.points.ravel()
                              for shape in placed if shape.member == member], self.extent)
            own = body.colours[member] if member < len(body.colours) else None
            if body.face is not None:
                filled(ax, rings, facecolor=own if own and body.face != "white" else body.face, linewidth=0,
                       alpha=body.alpha, zorder=body.layer)
            strokes(ax, outline(rings, self.extent), edgecolor=own or body.edge, linewidth=body.width, alpha=body.alpha,
                    zorder=body.layer, capstyle="round", joinstyle="round")

    def segments(self, ax: Any, segments: Array, colour: str, width: float, alpha: float) -> None:
        """Lines of a tree or a graph."""
        strokes(ax, segments[..., :2], edgecolor=colour, linewidth=width, alpha=alpha, zorder=TREE,
                rasterized=len(segments) > 5000)

    def samples(self, ax: Any, points: Array, colour: str, alpha: float) -> None:
        """Points that a search proposed."""
        dots(ax, points, colour, alpha)

    def path(self, ax: Any, points: Array, colour: str, width: float = 1.1, halo: bool = True) -> None:
        """A path, with a white line below it."""
        line = dict(solid_capstyle="round", solid_joinstyle="round")
        if halo:
            ax.plot(*points[:, :2].T, color="white", linewidth=width + 1.5, zorder=PATH, **line)
        ax.plot(*points[:, :2].T, color=colour, linewidth=width, zorder=PATH + 0.5, **line)

    def mark(self, ax: Any, point: Array, face: str, edge: str) -> None:
        """A start or a goal."""
        ax.plot(*point[:2], "o", markersize=3.6, markerfacecolor=face, markeredgecolor=edge, markeredgewidth=0.9,
                zorder=ENDS, clip_on=False)

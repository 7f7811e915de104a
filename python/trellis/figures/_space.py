# SPDX-License-Identifier: MIT-0
"""Pictures of space: a depth buffer decides what is seen; faces are pixels, and all lines are vectors, split by it."""
from __future__ import annotations

from typing import Any, List, Optional, Sequence, Tuple

import numpy as np
from matplotlib.colors import to_rgb

from . import _plane, _style
from ._plane import OBSTACLE, OBSTACLE_EDGE, Body, dots, strokes
from ._scenes import Array, Scene, Surfaces

_BOX = "#b9bdc1"
_SHARP = 400  # edges of a robot at most: of one with more, its outline is drawn alone
_IMAGE = 2.0  # the layer of the faces
_DENSITY = 300 / 25.4  # pixels per millimetre of a file


def camera(azimuth: float, elevation: float) -> Array:
    """The directions to the right, upwards and towards the viewer, as columns; angles in degrees."""
    a, e = np.radians([azimuth, elevation])
    to = np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    return np.stack([right, np.cross(to, right), to], 1)


class DepthBuffer:
    """Which triangle is nearest in each pixel of a square picture. z is larger where it is nearer.

    lo: the lower left corner. size: of the picture's side. count: of pixels along it.
    """

    def __init__(self, lo: Array, size: float, count: int) -> None:
        self.lo = np.asarray(lo, float)
        self.size = float(size)
        self.count = int(count)
        self.pixel = self.size / self.count
        self.depth = np.full(self.count * self.count, -np.inf)
        self.face = np.full(self.count * self.count, -1, np.int32)
        self.planes = np.zeros((0, 3))  # z = p0 + p1 x + p2 y of each triangle
        # How far behind a plane a point still counts as seen.
        self.slack = 1e-4 * self.size

    def copy(self) -> "DepthBuffer":
        out = DepthBuffer(self.lo, self.size, self.count)
        out.depth, out.face, out.planes = self.depth.copy(), self.face.copy(), self.planes
        return out

    def add(self, corners: Array) -> None:
        """Triangles (n, 3, 3) as x, y, z of the picture; they get the next numbers."""
        corners = np.asarray(corners, float).reshape(-1, 3, 3)
        first = len(self.planes)
        a, b, c = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = b[:, 0] * c[:, 1] - c[:, 0] * b[:, 1]
        flat = np.abs(area) < 1e-9 * self.pixel**2
        safe = np.where(flat, 1, area)
        px = (b[:, 2] * c[:, 1] - c[:, 2] * b[:, 1]) / safe
        py = (c[:, 2] * b[:, 0] - b[:, 2] * c[:, 0]) / safe
        planes = np.stack([a[:, 2] - px * a[:, 0] - py * a[:, 1], px, py], 1)
        self.planes = np.concatenate([self.planes, planes])
        in_pixels = (corners[..., :2] - self.lo) / self.pixel - 0.5  # the centre of pixel k is at k
        lo = np.clip(np.ceil(in_pixels.min(1) - 1e-6), 0, self.count).astype(int)
        hi = np.clip(np.floor(in_pixels.max(1) + 1e-6), -1, self.count - 1).astype(int)
        extent = hi - lo + 1
        drawn = np.flatnonzero((extent > 0).all(1) & ~flat)
        # Triangles of about the same extent are filled together.
        groups = np.ceil(np.log2(np.maximum(1, extent[drawn]))).astype(int)
        keys = groups[:, 0] * 64 + groups[:, 1]
        for key in np.unique(keys):
            wide, high = 1 << (int(key) // 64), 1 << (int(key) % 64)
            some = drawn[keys == key]
            step = max(1, 400000 // (wide * high))
            for at in range(0, len(some), step):
                self._fill(some[at:at + step], in_pixels, lo, hi, planes, wide, high, first)

    def _fill(self, which: Array, corners: Array, lo: Array, hi: Array, planes: Array, wide: int, high: int,
              first: int) -> None:
        x = lo[which, 0, None, None] + np.arange(wide)[None, None, :]
        y = lo[which, 1, None, None] + np.arange(high)[None, :, None]
        inside = (x <= hi[which, 0, None, None]) & (y <= hi[which, 1, None, None])
        a, b, c = (corners[which, k][:, :, None, None] for k in range(3))
        turn = np.sign((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (c[:, 0] - a[:, 0]) * (b[:, 1] - a[:, 1]))
        for p, q in ((a, b), (b, c), (c, a)):
            side = (q[:, 0] - p[:, 0]) * (y - p[:, 1]) - (q[:, 1] - p[:, 1]) * (x - p[:, 0])
            inside &= side * turn >= -1e-9
        who, row, column = np.nonzero(inside)
        if not len(who):
            return
        px, py = x[who, 0, column], y[who, row, 0]
        plane = planes[which[who]]
        z = plane[:, 0] + plane[:, 1] * (self.lo[0] + (px + 0.5) * self.pixel)
        z += plane[:, 2] * (self.lo[1] + (py + 0.5) * self.pixel)
        at = py * self.count + px
        nearer = z > self.depth[at]
        at, z, face = at[nearer], z[nearer], which[who[nearer]] + first
        order = np.lexsort((z, at))
        at, z, face = at[order], z[order], face[order]
        best = np.concatenate([at[1:] != at[:-1], [True]]) if len(at) else np.zeros(0, bool)
        self.depth[at[best]] = z[best]
        self.face[at[best]] = face[best]

    def faces_at(self, points: Array) -> Array:
        """The triangle in the pixel of each point; -1 of none."""
        return self._face_of(np.floor((points[..., :2] - self.lo) / self.pixel).astype(int))

    def _face_of(self, at: Array) -> Array:
        inside = ((at >= 0) & (at < self.count)).all(-1)
        at = np.clip(at, 0, self.count - 1)
        return np.where(inside, self.face[at[..., 1] * self.count + at[..., 0]], -1)

    def seen(self, points: Array) -> Array:
        """Whether no triangle covers each point (n, 3): the planes of the triangles in its pixel and in those beside it
        are compared at the point itself, and all of them have to cover it. So an outline is not hidden by its own body,
        whose planes are steep there."""
        points = np.asarray(points, float)
        at = np.floor((points[:, :2] - self.lo) / self.pixel).astype(int)
        hidden = np.arange(len(points))
        for beside in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)):
            face = self._face_of(at[hidden] + np.array(beside))
            hidden, face = hidden[face >= 0], face[face >= 0]
            plane, p = self.planes[face], points[hidden]
            covers = p[:, 2] < plane[:, 0] + plane[:, 1] * p[:, 0] + plane[:, 2] * p[:, 1] - self.slack
            hidden = hidden[covers]
        visible = np.ones(len(points), bool)
        visible[hidden] = False
        return visible

    def split(self, segments: Array) -> Tuple[Array, Array]:
        """Pieces of segments (n, 2, 3) that are seen, and those that are hidden, both (n, 2, 2)."""
        segments = np.asarray(segments, float).reshape(-1, 2, 3)
        a, d = segments[:, 0], segments[:, 1] - segments[:, 0]
        count = np.maximum(1, np.ceil(np.hypot(d[:, 0], d[:, 1]) / (1.5 * self.pixel))).astype(int)
        who = np.repeat(np.arange(len(a)), count)
        place = np.arange(len(who)) - np.repeat(np.cumsum(count) - count, count)
        seen = self.seen(a[who] + d[who] * ((place + 0.5) / count[who])[:, None])
        change = np.flatnonzero((who[1:] == who[:-1]) & (seen[1:] != seen[:-1]))
        # Where visibility changes between two middles: bisection.
        lo, hi = (place[change] + 0.5) / count[who[change]], (place[change + 1] + 0.5) / count[who[change]]
        for _ in range(5):
            middle = (lo + hi) / 2
            same = self.seen(a[who[change]] + d[who[change]] * middle[:, None]) == seen[change]
            lo, hi = np.where(same, middle, lo), np.where(same, hi, middle)
        number = np.arange(len(a))
        cut = np.concatenate([np.zeros(len(a)), (lo + hi) / 2, np.ones(len(a))])
        of = np.concatenate([number, who[change], number])
        first = np.cumsum(count) - count
        state = np.concatenate([seen[first], seen[change + 1], np.zeros(len(a), bool)]) if len(a) else np.zeros(0, bool)
        order = np.lexsort((cut, of))
        cut, of, state = cut[order], of[order], state[order]
        piece = np.flatnonzero(of[1:] == of[:-1])
        ends = [a[of[piece], :2] + d[of[piece], :2] * cut[piece + k, None] for k in (0, 1)]
        pieces, state = np.stack(ends, 1), state[piece]
        return pieces[state], pieces[~state]


# Surfaces ------------------------------------------------------------------------------------------------------------


def normals_of(surfaces: Surfaces) -> Array:
    """Unit normals of the triangles."""
    p = surfaces.vertices[surfaces.triangles]
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)


def silhouette(surfaces: Surfaces, to: Array) -> Array:
    """The edges of closed surfaces where a triangle that faces the viewer meets one that does not: (n, 2, 3)."""
    facing = normals_of(surfaces) @ to > 0
    closed = surfaces.closed[surfaces.of_triangle] if len(surfaces.closed) else np.zeros(0, bool)
    triangles, facing = surfaces.triangles[closed], facing[closed]
    if not len(triangles):
        return np.zeros((0, 2, 3))
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), 1)
    side = np.tile(facing, 3)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, side = ends[order], side[order]
    pair = np.flatnonzero((ends[1:] == ends[:-1]).all(1) & (side[1:] != side[:-1]))
    found: Array = surfaces.vertices[ends[pair]]
    return found


def opened(surfaces: Surfaces, lo: Array, hi: Array, to: Array) -> Surfaces:
    """The surfaces of a world without what closes the view: a ceiling or a wall before all else is left out, and of a
    surface about everything the sides that face the viewer."""
    size = hi - lo
    count = len(surfaces.closed)
    if not count or not len(surfaces.vertices):
        return surfaces
    least, most = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(least, surfaces.of_vertex, surfaces.vertices)
    np.maximum.at(most, surfaces.of_vertex, surfaces.vertices)
    share = (np.minimum(most, hi) - np.maximum(least, lo)) / size
    encloses = (share >= 0.6).all(1)
    closes = np.zeros(count, bool)
    inside = 0.05 * size.max()
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        if abs(to[axis]) <= 0.05:
            continue
        beyond = least[:, axis] >= hi[axis] - inside if to[axis] > 0 else most[:, axis] <= lo[axis] + inside
        closes |= beyond & (share[:, others] >= 0.6).all(1)
    rim = np.zeros((len(surfaces.vertices), 3), bool)
    for axis in range(3):
        if abs(to[axis]) > 0.05:
            at = surfaces.vertices[:, axis]
            rim[:, axis] = at >= hi[axis] - 0.03 * size[axis] if to[axis] > 0 else at <= lo[axis] + 0.03 * size[axis]
    flat = np.abs(normals_of(surfaces)) > 0.95
    before = (rim[surfaces.triangles].all(1) & flat).any(1)
    of = surfaces.of_triangle
    edge_rim = rim[surfaces.edges].all(1).any(1)
    return surfaces.without(closes[of] | (encloses[of] & before),
                            closes[surfaces.of_edge] | (encloses[surfaces.of_edge] & edge_rim))


# Views ---------------------------------------------------------------------------------------------------------------


def _shade(normals: Array, view: Array, colour: Any, dark: float) -> Array:
    """Colours of faces by the light from above the viewer's left shoulder."""
    light = view @ (np.array([-0.35, 0.55, 0.75]) / np.linalg.norm([0.35, 0.55, 0.75]))
    lit = normals * np.sign(normals @ view[:, 2] + 1e-12)[:, None] @ light
    factor = dark + (1 - dark) * np.clip(lit, 0, 1) * 1.2
    return np.clip(np.asarray(colour) * factor[:, None], 0, 1)


class SpaceView:
    """A picture of a world of space in axes, seen from far away."""

    def __init__(self, scene: Scene, bounds: Optional[Tuple[Array, Array]] = None) -> None:
        self.scene = scene
        self.view = camera(*scene.world["view"])
        self.surfaces = opened(Surfaces.unpack(scene.world["surfaces"]), scene.lo, scene.hi, self.view[:, 2])
        corners = np.array([[(scene.lo, scene.hi)[i >> k & 1][k] for k in range(3)] for i in range(8)])
        self.corners = corners @ self.view
        self.close = bounds is not None
        shown = self.corners[:, :2] if bounds is None else np.stack(bounds)[:, :2]
        margin = 0.01 * np.ptp(shown, axis=0).max()
        self.lo, self.hi = shown.min(0) - margin, shown.max(0) + margin
        self._normals = normals_of(self.surfaces)
        self._world: Optional[DepthBuffer] = None

    @property
    def aspect(self) -> float:
        """Height by width."""
        return float((self.hi[1] - self.lo[1]) / (self.hi[0] - self.lo[0]))

    def content(self) -> Array:
        """The obstacles in the picture, as far as the bounds go."""
        inside = np.clip(self.surfaces.vertices, self.scene.lo, self.scene.hi)
        return (inside @ self.view)[:, :2]

    def project(self, points: Array) -> Array:
        """Points of the world in the picture, with their depth."""
        return np.asarray(points, float) @ self.view

    def _buffer(self, ax: Any) -> DepthBuffer:
        """The depth buffer of the world, for this size of the axes."""
        side = float(max(self.hi - self.lo))
        longest = max(_style.size_of(ax))
        count = int(np.clip(round(longest * _DENSITY) * 2, 200, 1100))
        if self._world is None or self._world.count != count:
            self._world = DepthBuffer(self.lo, side, count)
            self._world.add((self.surfaces.vertices @ self.view)[self.surfaces.triangles])
        return self._world

    def begin(self, ax: Any, bodies: Sequence[Body] = ()) -> None:
        """Draws the world and robots."""
        world = self._buffer(ax)
        ax.set(xticks=[], yticks=[])
        for side in ax.spines.values():
            side.set(visible=self.close, color=_style.GREY, linewidth=0.5, zorder=_plane.FRAME)
        ax.set(xlim=(self.lo[0], self.hi[0]), ylim=(self.lo[1], self.hi[1]))
        ax.set_aspect("equal", adjustable="box")
        whole = world.copy() if bodies else world
        colours = [_shade(self._normals, self.view, to_rgb(OBSTACLE), 0.76)]
        ways: List[Tuple[Array, Body]] = []
        for body in bodies:
            if not getattr(body.robot, "spatial", False) or len(body.q) < body.robot.dimension:
                continue
            ways.append((self._solid(whole, body, colours), body))
        self._faces(ax, whole, np.concatenate(colours))
        self._box(ax, whole)
        self._edges(ax, world, whole)
        for edges, body in ways:
            seen, _ = whole.split(edges)
            strokes(ax, seen, edgecolor=body.edge, linewidth=body.width * 0.8, zorder=_plane.EDGES, capstyle="round")
            _, hidden = world.split(edges)
            strokes(ax, hidden, edgecolor=body.edge, linewidth=body.width * 0.6, alpha=0.3 * body.alpha,
                    zorder=_plane.EDGES, capstyle="round")

    def _solid(self, buffer: DepthBuffer, body: Body, colours: List[Array]) -> Array:
        """Adds a robot to the depth buffer, and returns its edges."""
        solid = body.robot.placed(body.q)
        surfaces = solid.surfaces
        buffer.add((surfaces.vertices @ self.view)[surfaces.triangles])
        members = [self.scene.member_of(int(column)) for column in solid.members]
        faces = [to_rgb(body.colours[member] if member < len(body.colours) else body.face or "white")
                 for member in members] or [to_rgb(body.face or "white")]
        mixed = np.array(faces) * body.alpha + (1 - body.alpha)
        shaded = _shade(normals_of(surfaces), self.view, mixed[surfaces.of_triangle], 0.7)
        colours.append(shaded)
        sharp = surfaces.vertices[surfaces.edges] if len(surfaces.edges) <= _SHARP else np.zeros((0, 2, 3))
        return np.concatenate([sharp, silhouette(surfaces, self.view[:, 2])]) @ self.view

    def _faces(self, ax: Any, buffer: DepthBuffer, colours: Array) -> None:
        """The faces as an image: four pixels of the buffer become one."""
        shown = np.floor((self.hi - buffer.lo) / buffer.pixel / 2 + 1e-9).astype(int) * 2
        wide, high = shown.clip(2, buffer.count // 2 * 2)
        face = buffer.face.reshape(buffer.count, -1)[:high, :wide]
        covered = (face >= 0).astype(float)
        rgb = np.where((face >= 0)[..., None], colours[face] if len(colours) else 0.0, 0.0)
        def quarter(x: Array) -> Array:
            return (x[0::2, 0::2] + x[1::2, 0::2] + x[0::2, 1::2] + x[1::2, 1::2]) / 4
        share = quarter(covered)
        image = np.dstack([quarter(rgb) / np.maximum(share, 0.25)[..., None], share])
        image = np.round(image * 255).astype(np.uint8)
        end = buffer.lo + np.array([wide, high]) * buffer.pixel
        ax.imshow(image, origin="lower", extent=(buffer.lo[0], end[0], buffer.lo[1], end[1]), interpolation="nearest",
                  zorder=_IMAGE, aspect="equal", rasterized=True)  # vector files move other images by pixels
        ax.set(xlim=(self.lo[0], self.hi[0]), ylim=(self.lo[1], self.hi[1]))

    def _box(self, ax: Any, buffer: DepthBuffer) -> None:
        """The edges of the bounds, but for those before the scene."""
        nearest = int(np.argmax(self.corners[:, 2]))
        ends = [(i, i | bit) for i in range(8) for bit in (1, 2, 4) if not i & bit and nearest not in (i, i | bit)]
        seen, _ = buffer.split(self.corners[np.array(ends)])
        strokes(ax, seen, edgecolor=_BOX, linewidth=0.5, zorder=1.0, capstyle="round")

    def _edges(self, ax: Any, world: DepthBuffer, whole: DepthBuffer) -> None:
        """The edges of obstacles that are seen; none between two faces in one plane, as of boxes side by side."""
        lines = np.concatenate([self.surfaces.vertices[self.surfaces.edges],
                                silhouette(self.surfaces, self.view[:, 2])]) @ self.view
        seen, _ = whole.split(lines)
        d = seen[:, 1] - seen[:, 0]
        length = np.hypot(d[:, 0], d[:, 1])
        count = np.maximum(1, np.ceil(length / (4 * world.pixel))).astype(int)
        who = np.repeat(np.arange(len(seen)), count)
        place = np.arange(len(who)) - np.repeat(np.cumsum(count) - count, count)
        ends = [seen[who, 0] + d[who] * ((place + k) / count[who])[:, None] for k in (0, 1)]
        middle = (ends[0] + ends[1]) / 2
        across = np.stack([-d[:, 1], d[:, 0]], 1) / np.maximum(length, 1e-300)[:, None] * 1.8 * world.pixel
        left, right = world.faces_at(middle + across[who]), world.faces_at(middle - across[who])
        plane = world.planes
        flat = (left >= 0) & (right >= 0)
        if len(plane) and flat.any():
            p, q = plane[left], plane[right]
            z = [one[:, 0] + one[:, 1] * middle[:, 0] + one[:, 2] * middle[:, 1] for one in (p, q)]
            steep = 1 + np.abs(p[:, 1:]).sum(1)
            flat &= (np.abs(p[:, 1:] - q[:, 1:]).max(1) < 1e-3 * steep) & (np.abs(z[0] - z[1]) < world.slack * steep)
        pieces = np.stack(ends, 1)[~flat]
        strokes(ax, pieces, edgecolor=OBSTACLE_EDGE, linewidth=0.45, zorder=_plane.TREE - 0.5, capstyle="round")

    def axes(self, ax: Any) -> None:
        """Labels three edges of the bounds with the extent of each axis, in metres: of each axis the lowest edge that
        does not end at the corner nearest to the viewer."""
        middle = self.corners[:, :2].mean(0)
        for axis, name in enumerate("xyz"):
            pairs = [(i, i | 1 << axis) for i in range(8) if not i >> axis & 1]
            outer = [pair for pair in pairs if self._outer(pair)]
            low = min(outer or pairs, key=lambda pair: (self.corners[list(pair), 1].sum(), pair))
            if axis == 2:
                low = min(outer or pairs, key=lambda pair: (self.corners[list(pair), 0].sum(), pair))
            ends = self.corners[list(low), :2]
            away = ends.mean(0) - middle
            away = away / max(float(np.hypot(*away)), 1e-300)
            lo, hi = self.scene.lo[axis], self.scene.hi[axis]
            text = f"{name} {lo:.4g} – {hi:.4g} m".replace("-", "−")
            along = ends[1] - ends[0]
            if float(np.hypot(*along)) < 0.05 * float(max(self.hi - self.lo)):  # seen from its end
                continue
            turn = float(np.degrees(np.arctan2(along[1], along[0])))
            turn = turn - 180 if turn > 90 else turn + 180 if turn <= -90 else turn
            ax.annotate(text, ends.mean(0), xytext=tuple(away * 1.7 * _style.POINT), textcoords="offset points",
                        ha="center", va="center", rotation=turn, rotation_mode="anchor", fontsize=_style.SMALL,
                        color=_style.GREY, annotation_clip=False)

    def _outer(self, pair: Tuple[int, int]) -> bool:
        """Whether an edge of the bounds is on the outline of their picture."""
        a, b = self.corners[pair[0], :2], self.corners[pair[1], :2]
        d = b - a
        side = d[0] * (self.corners[:, 1] - a[1]) - d[1] * (self.corners[:, 0] - a[0])
        slack = 1e-9 * float(np.abs(side).max())
        return bool((side <= slack).all() or (side >= -slack).all())

    def _split(self, ax: Any, points: Array) -> Tuple[Array, Array]:
        """Seen and hidden pieces of segments of the world; robots hide none."""
        return self._buffer(ax).split(self.project(points))

    def segments(self, ax: Any, segments: Array, colour: str, width: float, alpha: float) -> None:
        """Lines of a tree or a graph; those behind obstacles are fainter."""
        many = len(segments) > 5000
        for pieces, share in zip(self._split(ax, segments), (1.0, 0.15)):
            strokes(ax, pieces, edgecolor=colour, linewidth=width, alpha=alpha * share, zorder=_plane.TREE,
                    rasterized=many)

    def samples(self, ax: Any, points: Array, colour: str, alpha: float) -> None:
        """Points that a search proposed; those behind obstacles are fainter."""
        at = self.project(points)
        seen = self._buffer(ax).seen(at)
        dots(ax, at[~seen], colour, alpha * 0.2, layer=_IMAGE + 0.2)
        dots(ax, at[seen], colour, alpha, layer=_IMAGE + 0.3)

    def path(self, ax: Any, points: Array, colour: str, width: float = 1.1, halo: bool = True) -> None:
        """A path, with a white line below it; where it is behind obstacles it is thin and faint."""
        seen, hidden = self._split(ax, np.stack([points[:-1], points[1:]], 1))
        round_ = dict(capstyle="round", joinstyle="round")
        strokes(ax, hidden, edgecolor=colour, linewidth=width * 0.7, alpha=0.4, zorder=_plane.PATH, **round_)
        if halo:
            strokes(ax, seen, edgecolor="white", linewidth=width + 1.3, zorder=_plane.PATH + 0.3, **round_)
        strokes(ax, seen, edgecolor=colour, linewidth=width, zorder=_plane.PATH + 0.5, **round_)

    def mark(self, ax: Any, point: Array, face: str, edge: str) -> None:
        """A start or a goal; behind obstacles it is faint."""
        at = self.project(point)
        alpha = 1.0 if bool(self._buffer(ax).seen(at[None])[0]) else 0.45
        ax.plot(*at[:2], "o", markersize=3.6, markerfacecolor=face, markeredgecolor=edge, markeredgewidth=0.9,
                alpha=alpha, zorder=_plane.ENDS, clip_on=False)

# SPDX-License-Identifier: MIT-0
"""Worlds, robots and samples: what documents and folders of samples contain for pictures, unpacked."""
from __future__ import annotations

import base64
import copy
import json
import math
import pathlib
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ._document import Error, Results

Array = Any  # of numpy

# Packed numbers ------------------------------------------------------------------------------------------------------


def varints(text: Optional[str]) -> Array:
    """Whole numbers of any length: seven bits to a byte, the lowest first."""
    data = np.frombuffer(base64.b64decode(text or ""), np.uint8).astype(np.int64)
    last = data < 128
    if not len(data):
        return np.zeros(0, np.int64)
    ends = np.flatnonzero(last)
    first = np.concatenate([[0], ends[:-1] + 1])
    place = np.arange(len(data)) - np.repeat(first, ends - first + 1)
    return np.add.reduceat((data & 127) << (7 * place), first)


def signed(values: Array) -> Array:
    """Maps 0, 1, 2, 3, ... to 0, -1, 1, -2, ..."""
    return np.where(values % 2, -(values // 2) - 1, values // 2)


class Surfaces(NamedTuple):
    """Triangles of space. Triangles and edges index the vertices; `of_*` say which surface each of them belongs to."""

    vertices: Array
    triangles: Array
    edges: Array
    of_vertex: Array
    of_triangle: Array
    of_edge: Array
    closed: Array  # of each surface

    @classmethod
    def unpack(cls, packed: Mapping[str, str]) -> "Surfaces":
        vertices = np.frombuffer(base64.b64decode(packed["vertices"]), "<f4").reshape(-1, 3).astype(float)
        parts = varints(packed["parts"]).reshape(-1, 4)
        triangles = varints(packed["triangles"]).reshape(-1, 3)
        edges = varints(packed["edges"]).reshape(-1, 2)
        first = np.cumsum(parts[:, 0]) - parts[:, 0]
        number = np.arange(len(parts))
        of = [np.repeat(number, parts[:, k]) for k in range(3)]
        triangles, edges = triangles + first[of[1]][:, None], edges + first[of[2]][:, None]
        return cls(vertices, triangles, edges, of[0], of[1], of[2], parts[:, 3] > 0)

    def without(self, triangles: Array, edges: Array) -> "Surfaces":
        """The same without the marked triangles and edges."""
        return self._replace(triangles=self.triangles[~triangles], of_triangle=self.of_triangle[~triangles],
                             edges=self.edges[~edges], of_edge=self.of_edge[~edges])


# Turns ---------------------------------------------------------------------------------------------------------------


def turned(q: Array, v: Array) -> Array:
    """Vectors turned by unit quaternions x, y, z, w; rows of both, or one."""
    axis, w = q[..., :3], q[..., 3:]
    t = 2 * np.cross(axis, v)
    return v + w * t + np.cross(axis, t)


def times(a: Array, b: Array) -> Array:
    """The quaternions a * b."""
    ax, ay, az, aw = (a[..., k] for k in range(4))
    bx, by, bz, bw = (b[..., k] for k in range(4))
    return np.stack([aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
                     aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz], -1)


def unit(q: Array) -> Array:
    """Quaternions of length 1; one of length 0 turns nothing."""
    length = np.linalg.norm(q, axis=-1, keepdims=True)
    return np.where(length > 0, q / np.where(length > 0, length, 1), np.array([0.0, 0.0, 0.0, 1.0]))


def about(axis: Array, angle: Array) -> Array:
    """The quaternions that turn by angles about an axis."""
    half = np.asarray(angle)[..., None] / 2
    return np.concatenate([np.sin(half) * axis, np.cos(half)], -1)


# Configurations ------------------------------------------------------------------------------------------------------


class Space:
    """The axes of configurations: where they wrap, what a unit of each is in metres, and which are quaternions."""

    def __init__(self, axes: Sequence[Sequence[Any]], rotations: Sequence[int] = ()) -> None:
        self.lo = np.array([axis[1] for axis in axes], float)
        self.hi = np.array([axis[2] for axis in axes], float)
        self.wraps = np.array([bool(axis[3]) for axis in axes], bool)
        self.weight = np.array([axis[4] for axis in axes], float)
        self.rotations = list(rotations)
        self.plain = np.ones(len(axes), bool)
        for column in self.rotations:
            self.plain[column:column + 4] = False

    def rows(self, text: Optional[str]) -> Array:
        """Packed configurations: 16 bits a coordinate, between the ends of its axis."""
        if not len(self.lo):
            return np.zeros((0, 0))
        share = np.frombuffer(base64.b64decode(text or ""), "<u2").reshape(-1, len(self.lo)) / 65535
        rows = self.lo + share * (self.hi - self.lo)
        for column in self.rotations:
            rows[:, column:column + 4] = unit(rows[:, column:column + 4])
        return rows

    def difference(self, a: Array, b: Array) -> Array:
        """b - a of each coordinate, the short way round where it wraps."""
        delta = b - a
        period = np.where(self.wraps, self.hi - self.lo, 1)
        return np.where(self.wraps, delta - period * np.round(delta / period), delta)

    def between(self, a: Array, b: Array, share: Array) -> Array:
        """The configurations at shares of the straight motions from a to b; all have as many rows."""
        share = np.asarray(share, float)[..., None]
        out = a + share * self.difference(a, b)
        for column in self.rotations:
            part = slice(column, column + 4)
            out[..., part] = _slerp(a[..., part], b[..., part], share)
        return out

    def distances(self, a: Array, b: Array, columns: Optional[Sequence[int]] = None) -> Array:
        """The lengths of straight motions in the metric of the space, or of some of its columns, m."""
        chosen = self.plain.copy()
        rotations = self.rotations
        if columns is not None:
            chosen &= np.isin(np.arange(len(self.lo)), list(columns))
            rotations = [column for column in rotations if column in set(columns)]
        square = (np.where(chosen, self.difference(a, b) * self.weight, 0) ** 2).sum(-1)
        for column in rotations:
            part = slice(column, column + 4)
            cos = np.abs((a[..., part] * b[..., part]).sum(-1))
            square = square + (2 * np.arccos(np.minimum(1, cos)) * self.weight[column]) ** 2
        return np.sqrt(square)

    def along(self, path: Array, at: Array, moments: Array) -> Array:
        """The configurations of a path at moments: `at` has the moment of each of its rows, in ascending order."""
        moments = np.asarray(moments, float)
        if len(path) < 2:
            return np.repeat(path[:1], len(moments), 0)
        leg = np.clip(np.searchsorted(at, moments, "left"), 1, len(path) - 1)
        span = at[leg] - at[leg - 1]
        share = np.where(span > 0, (moments - at[leg - 1]) / np.where(span > 0, span, 1), 1.0)
        return self.between(path[leg - 1], path[leg], np.clip(share, 0, 1))

    def lengths(self, path: Array) -> Array:
        """How far along a path each of its rows is, in the metric."""
        return np.concatenate([[0.0], np.cumsum(self.distances(path[:-1], path[1:]))]) if len(path) else np.zeros(0)


def _slerp(a: Array, b: Array, share: Array) -> Array:
    cos = (a * b).sum(-1, keepdims=True)
    b = np.where(cos < 0, -b, b)
    half = np.arccos(np.minimum(1, np.abs(cos)))
    sin = np.sin(half)
    near = sin < 1e-6
    safe = np.where(near, 1, sin)
    return unit(np.where(near, 1 - share, np.sin((1 - share) * half) / safe) * a
                + np.where(near, share, np.sin(share * half) / safe) * b)


# Robots --------------------------------------------------------------------------------------------------------------


class Shape(NamedTuple):
    """A part of a robot of the plane where a configuration places it: a disc about one point, or a polygon."""

    points: Array
    radius: float
    member: int  # which robot of a team; 0 of a robot alone


class Solid(NamedTuple):
    """A robot of space where a configuration places it."""

    surfaces: Surfaces
    members: Array  # of each surface: which robot of a team


class Robot:
    """A robot: where configurations place its bodies, and its tip.

    dimension: of its configurations. radius: of a ball about it, m.
    """

    spatial = False

    def __init__(self, raw: Mapping[str, Any]) -> None:
        self.raw = raw
        self.dimension = int(raw["dimension"])
        self.radius = float(raw["radius"])

    @property
    def is_point(self) -> bool:
        """Whether it has no body to draw."""
        raise NotImplementedError

    def tip(self, rows: Array, member: int = 0) -> Optional[Array]:
        """Where configurations place the end of its last link; None of a robot without links."""
        raise NotImplementedError


class PlanarRobot(Robot):
    """A body, an arm or a team of the plane."""

    def __init__(self, raw: Mapping[str, Any]) -> None:
        super().__init__(raw)
        self.bodies = list(raw["bodies"])
        self.member = [int(body.get("robot", 0)) for body in self.bodies]

    @property
    def is_point(self) -> bool:
        return all(len(part) == 3 and part[2] <= 0 for body in self.bodies for part in body["parts"])

    def poses(self, rows: Array) -> List[Tuple[Array, Array, Array, Array]]:
        """x, y, cosine and sine of each body, in rows."""
        rows = np.asarray(rows, float)
        out: List[Tuple[Array, Array, Array, Array]] = []
        one, none = np.ones(len(rows)), np.zeros(len(rows))
        for body in self.bodies:
            if body["parent"] >= 0:
                x, y, c, s = out[body["parent"]]
            elif self.raw["translates"]:
                x, y, c, s = rows[:, 0], rows[:, 1], one, none
            elif body.get("position", -1) >= 0:
                x, y, c, s = rows[:, body["position"]], rows[:, body["position"] + 1], one, none
            else:
                x, y, c, s = self.raw["base"][0] + none, self.raw["base"][1] + none, one, none
            jx, jy = body["joint"]
            x, y = x + c * jx - s * jy, y + s * jx + c * jy
            if body["axis"] >= 0:
                c1, s1 = np.cos(rows[:, body["axis"]]), np.sin(rows[:, body["axis"]])
                if body["absolute"] or body["parent"] < 0:
                    c, s = c1, s1
                else:
                    c, s = c * c1 - s * s1, s * c1 + c * s1
            out.append((x, y, c, s))
        return out

    def shapes(self, rows: Array) -> Iterator[Tuple[int, float, Array]]:
        """The body, the radius and, for all rows, the points of each part: the centre of a disc, or the vertices."""
        for i, (body, (x, y, c, s)) in enumerate(zip(self.bodies, self.poses(rows))):
            for part in body["parts"]:
                disc = len(part) == 3
                p = np.reshape(part[:2] if disc else part, (-1, 2)).astype(float)
                points = np.stack([x[:, None] + c[:, None] * p[:, 0] - s[:, None] * p[:, 1],
                                   y[:, None] + s[:, None] * p[:, 0] + c[:, None] * p[:, 1]], -1)
                yield i, float(part[2]) if disc else 0.0, points

    def placed(self, q: Array) -> List[Shape]:
        """The parts where a configuration places them; parts that are points are left out."""
        return [Shape(points[0], radius, self.member[body]) for body, radius, points in self.shapes(np.array([q]))
                if len(points[0]) > 1 or radius > 0]

    def tip(self, rows: Array, member: int = 0) -> Optional[Array]:
        own = [i for i, one in enumerate(self.member) if one == member]
        if self.raw["translates"] or not own or self.bodies[own[0]].get("position", -1) >= 0:
            return None
        rows = np.asarray(rows, float)
        x, y, c, s = self.poses(rows)[own[-1]]
        far = max((max(part[0::2]) for part in self.bodies[own[-1]]["parts"] if len(part) != 3), default=0.0)
        return np.stack([x + c * far, y + s * far], -1)


class _Spatial(Robot):
    spatial = True

    def __init__(self, raw: Mapping[str, Any]) -> None:
        super().__init__(raw)
        self.surfaces = Surfaces.unpack(raw["surfaces"])

    @property
    def is_point(self) -> bool:
        return len(self.surfaces.triangles) == 0

    def poses(self, rows: Array) -> List[Tuple[Array, Array]]:
        """The position and the quaternion of each surface, in rows."""
        raise NotImplementedError

    def columns(self) -> List[int]:
        """Of each surface, a column of the configuration that moves it; -1 of none."""
        raise NotImplementedError

    def placed(self, q: Array) -> Solid:
        """All surfaces where a configuration places them."""
        poses = self.poses(np.asarray(q, float)[None])
        if not poses:
            return Solid(self.surfaces, np.zeros(0, int))
        position = np.array([pose[0][0] for pose in poses])[self.surfaces.of_vertex]
        rotation = np.array([pose[1][0] for pose in poses])[self.surfaces.of_vertex]
        vertices = turned(rotation, self.surfaces.vertices) + position
        return Solid(self.surfaces._replace(vertices=vertices), np.array(self.columns(), int))


class RigidRobot(_Spatial):
    """A rigid body of space, or a team of them."""

    def _moves(self) -> List[Tuple[int, bool]]:
        count = len(self.surfaces.closed)
        listed = self.raw.get("columns") or [[0, self.raw["rotates"]]] * count
        return [(int(column), bool(turns)) for column, turns in listed]

    def columns(self) -> List[int]:
        return [column for column, _ in self._moves()]

    def poses(self, rows: Array) -> List[Tuple[Array, Array]]:
        still = np.tile([0.0, 0.0, 0.0, 1.0], (len(rows), 1))
        return [(rows[:, k:k + 3], unit(rows[:, k + 3:k + 7]) if turns else still) for k, turns in self._moves()]

    def tip(self, rows: Array, member: int = 0) -> Optional[Array]:
        return None


def _across(axis: Array) -> Tuple[Array, Array]:
    """Two directions across an axis, as the planner chooses them."""
    other = np.array([1.0, 0, 0]) if abs(axis[0]) < 0.9 else np.array([0, 1.0, 0])
    first = other - (other @ axis) * axis
    u = first / np.linalg.norm(first)
    return u, np.cross(axis, u)


class TreeRobot(_Spatial):
    """A robot of links and joints; also several in one world."""

    def columns(self) -> List[int]:
        out = [-1]  # the base, whose parent it is itself
        for body in self.raw["bodies"][1:]:
            moves = body["kind"] != "fixed" and body["column"] >= 0
            out.append(int(body["column"]) if moves else out[body["parent"]])
        return out

    def poses(self, rows: Array) -> List[Tuple[Array, Array]]:
        rows = np.asarray(rows, float)
        ones = np.ones((len(rows), 1))
        base = np.asarray(self.raw["base"], float)
        out = [(base[:3] * ones, base[3:] * ones)]
        for body in self.raw["bodies"][1:]:
            origin, axis = np.asarray(body["origin"], float), np.asarray(body["axis"], float)
            position, rotation = out[body["parent"]]
            position = position + turned(rotation, origin[:3])
            rotation = times(rotation, origin[3:] * ones)
            moved, turn = _joint(body, rows, axis)
            if moved is not None:
                position = position + turned(rotation, moved)
            if turn is not None:
                rotation = times(rotation, turn)
            out.append((position, rotation))
        return out

    def point(self, rows: Array, tip: Sequence[float]) -> Array:
        """Where configurations place a point of a body: [body, x, y, z]."""
        position, rotation = self.poses(rows)[int(tip[0])]
        return position + turned(rotation, np.asarray(tip[1:], float))

    def tip(self, rows: Array, member: int = 0) -> Optional[Array]:
        tips = self.raw.get("tips") or [self.raw["tip"]]
        return self.point(rows, tips[member if member < len(tips) else 0])


def _joint(body: Mapping[str, Any], rows: Array, axis: Array) -> Tuple[Optional[Array], Optional[Array]]:
    """How far a joint moves its body, and how it turns it."""
    kind, k = body["kind"], int(body["column"])
    if kind in ("planar", "sliding in a plane"):
        u, v = _across(axis)
        moved = rows[:, k, None] * u + rows[:, k + 1, None] * v
        return moved, about(axis, rows[:, k + 2]) if kind == "planar" else None
    if kind in ("floating", "sliding"):
        return rows[:, k:k + 3], unit(rows[:, k + 3:k + 7]) if kind == "floating" else None
    if kind == "fixed" or k < 0:
        return None, None
    value = body["multiplier"] * rows[:, k] + body["offset"]
    if kind == "prismatic":
        return value[:, None] * axis, None
    return None, about(axis, value)


def robot_of(raw: Mapping[str, Any]) -> Robot:
    """The robot of an entry of `robots`."""
    kind = raw.get("kind") or ("planar" if "surfaces" not in raw else "tree" if "bodies" in raw else "rigid")
    made: Dict[str, Any] = {"planar": PlanarRobot, "rigid": RigidRobot, "tree": TreeRobot}
    robot: Robot = made[kind](raw)
    return robot


# Traces --------------------------------------------------------------------------------------------------------------


class Trace:
    """Where configurations place one robot: its reference point, or the tip of an arm.

    member: its place in the team. curved: whether straight motions of the configuration may bend the trace.
    """

    def __init__(self, dimension: int, member: int, position: Sequence[int] = (), robot: Optional[Robot] = None,
                 tip: Optional[Sequence[float]] = None, first: int = 0) -> None:
        self.dimension = dimension
        self.member = member
        self.position = list(position)[:dimension]
        self.robot = robot
        self.curved = not self.position
        self._tip = tip
        self._first = first

    def points(self, rows: Array) -> Array:
        """The points of configurations, in rows; coordinates that a level lacks are 0."""
        rows = np.asarray(rows, float)
        if self.position:
            found = rows[:, self.position]
        elif isinstance(self.robot, TreeRobot) and self._tip is not None:
            found = self.robot.point(rows[:, self._first:], self._tip)
        else:
            tips = self.robot.tip(rows[:, self._first:], self.member) if self.robot is not None else None
            found = np.zeros((len(rows), 0)) if tips is None else tips
        lacks = self.dimension - found.shape[1]
        return np.concatenate([found, np.zeros((len(rows), lacks))], 1) if lacks > 0 else found


def _traces(dimension: int, raw: Mapping[str, Any], robot: Optional[Robot], width: int) -> List[Trace]:
    first = int(raw.get("first") or 0)
    listed = [Trace(dimension, int(one["robot"]), one["position"], robot, one.get("tip"), first)
              for one in raw.get("traces") or [] if len(one["position"]) >= 2 or one.get("tip")]
    if isinstance(robot, PlanarRobot) and robot.dimension <= width - first:
        # Arms of a planar team: their tips have positions.
        known = {trace.member for trace in listed}
        for member in sorted(set(robot.member) - known) if len(set(robot.member)) > 1 else ():
            listed.append(Trace(dimension, member, (), robot, None, first))
    if listed or raw.get("traces"):
        return sorted(listed, key=lambda trace: trace.member)
    if len(raw["position"]) >= 2:
        return [Trace(dimension, 0, raw["position"])]
    if robot is not None and robot.dimension <= width - first:
        example = np.zeros((1, width - first))
        if robot.tip(example) is not None:
            return [Trace(dimension, 0, (), robot, None, first)]
    return []


# Scenes --------------------------------------------------------------------------------------------------------------


class Member(NamedTuple):
    """A robot of a team."""

    number: int
    columns: List[int]
    colour: str


_TEAM = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#8C564B", "#6A51A3")


def _member_colour(place: int) -> str:
    """The colours of Okabe and Ito but black, two more, and then all of them darker."""
    share = 0.6 ** (place // len(_TEAM))
    colour = _TEAM[place % len(_TEAM)]
    return "#" + "".join(f"{round(int(colour[k:k + 2], 16) * share):02X}" for k in (1, 3, 5))


class Scene:
    """World, robot and space of a problem.

    dimension: of the world, 2 or 3. start, goals: configurations. team: empty of a robot alone.
    """

    def __init__(self, raw: Mapping[str, Any], world: Mapping[str, Any], robot: Optional[Robot],
                 problem: Mapping[str, Any]) -> None:
        self.name = str(raw["problem"])
        self.world = world
        self.dimension = int(world["dimension"])
        bounds = np.asarray(world["bounds"], float)
        self.lo, self.hi = bounds[:self.dimension], bounds[self.dimension:]
        self.robot = robot
        self.space = Space(raw["axes"], raw.get("rotations") or ())
        self.traces = _traces(self.dimension, raw, robot, len(raw["axes"]))
        self.team = [Member(int(one["number"]), [int(k) for k in one["axes"]], _member_colour(i))
                     for i, one in enumerate(raw.get("team") or [])]
        self.start = _configuration(problem.get("start"), len(raw["axes"]))
        goals = [problem.get("goal"), *(problem.get("further_goals") or [])]
        self.goals = [one for one in (_configuration(goal, len(raw["axes"])) for goal in goals) if one is not None]

    def seen_from(self, view: Sequence[float]) -> "Scene":
        """The same for another camera: azimuth and elevation, in degrees."""
        other = copy.copy(self)
        other.world = {**self.world, "view": list(view)}
        return other

    def member_of(self, column: int) -> int:
        """The robot of the team that a column moves; 0 of a robot alone."""
        return next((i for i, one in enumerate(self.team) if column in one.columns), 0)


def _configuration(given: Any, width: int) -> Optional[Array]:
    """A start or a goal; None where the document has none of this width, as for a goal that is a region."""
    try:
        found = np.asarray(given, float)
    except (TypeError, ValueError):
        return None
    return found if width and found.shape == (width,) and np.isfinite(found).all() else None


class Level:
    """A level of a run: its tree or graph, its proposals, and the last path that it handed up.

    traces: where it has positions in the world; empty: in none. path: None where it found none.
    """

    def __init__(self, raw: Mapping[str, Any], robot: Optional[Robot], scene: Scene, path: Optional[Array]) -> None:
        self.name = str(raw["name"])
        self.planner = str(raw["planner"])
        self.space_name = str(raw["space"])
        self.parent = int(raw["parent"])
        self.robot = robot
        self.space = Space(raw["axes"], raw.get("rotations") or ())
        self.traces = _traces(scene.dimension, raw, robot, len(raw["axes"]))
        self.nodes = self.space.rows(raw["nodes"])
        self.proposals = self.space.rows(raw["proposals"])
        self.first = int(raw.get("first") or 0)
        self.path = path
        self.raw = raw

    @property
    def edges(self) -> Array:
        """Pairs of nodes: of a tree each node with its parent, then the edges of a graph."""
        pairs = []
        if self.raw["parents"]:
            up = signed(varints(self.raw["parents"]))
            child = np.arange(len(up))
            pairs.append(np.stack([child - up, child], 1)[up != 0])
        ends = signed(varints(self.raw["edges"])).reshape(-1, 2)
        first = np.cumsum(ends[:, 0])
        pairs.append(np.stack([first, first + ends[:, 1]], 1))
        return np.concatenate(pairs)

    def motions(self, trace: Trace, pieces: int = 8) -> Array:
        """Segments of the trace of all edges: (n, 2, dimension). One that bends has several."""
        edges = self.edges
        a, b = self.nodes[edges[:, 0]], self.nodes[edges[:, 1]]
        if not trace.curved or len(edges) > 20000:
            return np.stack([trace.points(a), trace.points(b)], 1)
        points = np.stack([trace.points(self.space.between(a, b, np.full(len(a), k / pieces)))
                           for k in range(pieces + 1)], 1)
        return np.stack([points[:, :-1], points[:, 1:]], 2).reshape(-1, 2, points.shape[-1])


def traced(space: Space, trace: Trace, path: Array, step: int = 8) -> Array:
    """The points of a trace along a path; between its rows too, where straight motions may bend it."""
    if not trace.curved or len(path) < 2:
        return trace.points(path)
    at = np.arange(len(path), dtype=float)
    return trace.points(space.along(path, at, np.linspace(0, len(path) - 1, (len(path) - 1) * step + 1)))


# Pictures ------------------------------------------------------------------------------------------------------------


def scene_of(results: Results, problem: str) -> Optional[Scene]:
    """The scene of a problem; None where the document has no world for it."""
    if problem not in results.scenes:
        document = results.document
        entry = next((one for one in document.get("scenes") or [] if one["problem"] == problem), None)
        if entry is None or entry.get("world") is None:
            results.scenes[problem] = None
        else:
            known = next(one for one in document["experiment"]["problems"] if one["name"] == problem)
            robot = None if entry.get("robot") is None else robot_of(document["robots"][entry["robot"]])
            results.scenes[problem] = Scene(entry, document["worlds"][entry["world"]], robot, known)
    found: Optional[Scene] = results.scenes[problem]
    return found


class Index:
    """The index of a folder of samples."""

    def __init__(self, folder: pathlib.Path) -> None:
        self.folder = folder
        self.runs: Dict[Tuple[str, str, str], Mapping[str, str]] = {}
        index = folder / "index.json"
        try:
            content = json.loads(index.read_text(encoding="utf-8"))
            self.robots = [robot_of(raw) for raw in content["robots"]]
            for one in content["runs"]:
                self.runs[one["problem"], one["strategy"], str(one["seed"])] = one
        except FileNotFoundError:
            raise Error(f"{index} is missing: name the folder of `trellis run --samples` as samples=") from None
        except (ValueError, KeyError, TypeError) as fault:
            raise Error(f"{index}: this is no index of samples ({fault})") from fault


def index_of(results: Results) -> Optional[Index]:
    """The samples beside a document; None of one that has none, and of several documents."""
    if results.samples is None:
        return None
    if results.index is None:
        results.index = Index(pathlib.Path(results.samples))
    found: Index = results.index
    return found


def has_samples(results: Results, run: Mapping[str, Any]) -> bool:
    """Whether there are samples of a run, in a folder that is there."""
    if results.parts:
        return any(has_samples(part, run) for part in results.parts)
    if results.samples is None or not pathlib.Path(results.samples, "index.json").is_file():
        return False
    index = index_of(results)
    return index is not None and _key(run) in index.runs


def _key(run: Mapping[str, Any]) -> Tuple[str, str, str]:
    return run["problem"], run["strategy"], str(run["seed"])


def levels_of(results: Results, run: Mapping[str, Any], scene: Scene) -> Optional[List[Level]]:
    """The levels of a run, the robot's own first; None where the document has no samples."""
    for part in results.parts:
        if has_samples(part, run):
            return levels_of(part, run, scene)
    index = index_of(results)
    entry = None if index is None else index.runs.get(_key(run))
    if index is None or entry is None:
        return None
    try:
        packed = json.loads((index.folder / entry["file"]).read_text(encoding="utf-8"))
    except FileNotFoundError as missing:
        raise Error(f"{missing.filename} is missing, which {index.folder / 'index.json'} lists") from missing
    last = {turn[0]: turn[4] for turn in packed["turns"] if turn[4]}
    levels = []
    for number, raw in enumerate(packed["levels"]):
        robot = index.robots[raw["robot"]] if raw["robot"] >= 0 else None
        level = Level(raw, robot, scene, None)
        if number in last:
            level.path = level.space.rows(last[number])
        levels.append(level)
    if levels:
        levels[0].path = path_of(run)
    return levels


def path_of(run: Mapping[str, Any]) -> Optional[Array]:
    """The path of a run; None of one that is not solved."""
    path = run.get("path")
    return np.asarray(path, float) if run["solved"] and path else None


def metres(run: Mapping[str, Any]) -> str:
    """The length of a run's path."""
    length = run.get("length")
    return "no path" if not run["solved"] or length is None or not math.isfinite(float(length)) else (
        f"{float(length):.1f} m" if float(length) >= 9.95 else f"{float(length):.2f} m")

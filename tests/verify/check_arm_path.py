#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks paths of a robot of a URDF file by code that shares nothing with Trellis: numpy alone.

check_arm_path.py SCRIPT.lua RESULT.json [options]    paths of `trellis run SCRIPT.lua --json RESULT.json`
check_arm_path.py SCRIPT.lua --run TRELLIS            runs the program TRELLIS first; pairs that it warns of may touch
check_arm_path.py --self-test                         known contacts are found, known distances are right

It reads the URDF file, its meshes (STL, OBJ, COLLADA) and its SRDF file, and of the script the literal parts:
robot.urdf, world and its shapes (box, sphere, cylinder, capsule). Anything else there is an error, not left out.
Links obstacles are triangles, balls and segments with a radius; cylinders have 96 sides with their corners on the
surface, which lies at most 0.0006 radii outside of what is checked. A motion is the straight line between two
configurations, for continuous joints the shorter way round.

Each pair, a link and an obstacle or two links, is followed along the path: from an exact distance d it advances by as
much as the pair cannot approach by d, but by at least --step. So a contact can be missed only where bodies overlap by
less than --step; the report says how many intervals that step decided. A body that lies wholly inside a closed one is
found at the path's configurations. SCRIPT and RESULT may name files of other folders; meshes are looked for as
Trellis does: beside the URDF file and in the folders above it.

Not checked: links that one joint or fixed joints connect, pairs that the SRDF file disables, and those of --allow.

Status: 0, every path is free; 1, a contact or a joint beyond its limits; 2, the input could not be read; 77, no
numpy.
"""
import argparse
import json
import math
import os
import re
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

# The arrays are small: threads of BLAS would only wait for each other.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
try:
    import numpy as np
except ImportError:
    print("check_arm_path.py: skipped, numpy is not installed")
    sys.exit(77)


class Unreadable(Exception):
    """An input that this program does not read."""


# ---- the literal part of a script -----------------------------------------------------------------------------------


class Table:
    """A table of Lua: its list and its named fields."""

    def __init__(self):
        self.items, self.fields = [], {}


class Call:
    """A call of a word of the language, with its arguments."""

    def __init__(self, name, arguments):
        self.name, self.arguments = name, arguments


TOKEN = re.compile(
    r"\s+|--\[\[.*?\]\]|--[^\n]*|(?P<number>0x[\da-fA-F]+|\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+(?:[eE][-+]?\d+)?)"
    r"|(?P<string>\"(?:\\.|[^\"\\])*\"|'(?:\\.|[^'\\])*')|(?P<name>[A-Za-z_]\w*)"
    r"|(?P<mark>\.\.\.?|[=~<>]=|<<|>>|//|::|.)",
    re.S,
)


class Script:
    """The values that the statements `local NAME = VALUE` and `NAME = VALUE` of a script give to names, and its
    problems."""

    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            text = file.read()
        self.tokens = [(m.lastgroup, m.group()) for m in TOKEN.finditer(text) if m.lastgroup]
        self.tokens.append(("end", ""))
        self.at, self.names, self.problems = 0, {}, {}
        while self.tokens[self.at][0] != "end":
            self.statement()

    def take(self, text=None):
        kind, found = self.tokens[self.at]
        if text is not None and found != text:
            raise Unreadable(f"the script is not literal: expected {text!r}, got {found!r}")
        self.at += 1
        return kind, found

    def next_is(self, *texts):
        return self.tokens[self.at][1] in texts and self.tokens[self.at][0] != "string"

    def statement(self):
        if self.next_is(";"):
            self.take()
        elif self.next_is("return"):
            self.take()
            self.values()
        elif self.next_is("local"):
            self.take()
            self.assignment()
        elif self.tokens[self.at + 1][1] in ("=", ","):
            self.assignment()
        else:
            self.value()

    def assignment(self):
        names = [self.take()[1]]
        while self.next_is(","):
            self.take()
            names.append(self.take()[1])
        self.take("=")
        for name, value in zip(names, self.values()):
            self.names[name] = value

    def values(self):
        found = [self.value()]
        while self.next_is(","):
            self.take()
            found.append(self.value())
        return found

    def value(self, level=0):
        """A value with operators that bind more tightly than `level`."""
        if self.next_is("-"):
            self.take()
            left = -self.value(3)
        else:
            left = self.simple()
        while True:
            mark = self.tokens[self.at][1] if self.tokens[self.at][0] == "mark" else ""
            binds = {">>": 1, "+": 2, "-": 2, "*": 3, "/": 3}.get(mark, 0)
            if binds <= level:
                return left
            self.take()
            right = self.value(binds)
            if isinstance(left, float) and isinstance(right, float):
                left = {"+": left + right, "-": left - right, "*": left * right, "/": left / (right or 1.0)}.get(mark)
            else:
                left = Call(mark, [left, right])

    def simple(self):
        kind, text = self.take()
        if kind == "number":
            return float(int(text, 16)) if text.startswith("0x") else float(text)
        if kind == "string":
            return text[1:-1]
        if text == "{":
            return self.table()
        if text == "(":
            value = self.value()
            self.take(")")
            return value
        if kind != "name" or text in ("function", "for", "if", "while", "repeat", "do", "goto"):
            raise Unreadable(f"the script is not literal: {text!r}")
        name, value = text, self.names.get(text, Call(text, None))
        if text in ("true", "false", "nil"):
            value = {"true": True, "false": False, "nil": None}[text]
        while True:
            if self.next_is(".", ":"):
                mark = self.take()[1]
                field = self.take()[1]
                name += mark + field
                value = value.fields.get(field) if isinstance(value, Table) else Call(name, None)
                if name == "math.pi":
                    value = math.pi
            elif self.next_is("(", "{") or self.tokens[self.at][0] == "string":
                value = self.call(name)
            elif self.next_is("["):
                self.take()
                self.value()
                self.take("]")
                value = Call(name + "[]", None)
            else:
                return value

    def call(self, name):
        if self.next_is("("):
            self.take()
            arguments = [] if self.next_is(")") else self.values()
            self.take(")")
        else:
            arguments = [self.simple()]
        if name == "math.rad":
            return math.radians(arguments[0])
        found = Call(name, arguments)
        if name == "problem":
            fields = arguments[0].fields
            self.problems[fields.get("name", "problem")] = fields
        return found

    def table(self):
        found = Table()
        while not self.next_is("}"):
            if self.tokens[self.at][0] == "name" and self.tokens[self.at + 1][1] == "=":
                name = self.take()[1]
                self.take("=")
                found.fields[name] = self.value()
            elif self.next_is("["):
                self.take()
                key = self.value()
                self.take("]")
                self.take("=")
                found.fields[str(key)] = self.value()
            else:
                found.items.append(self.value())
            if self.next_is(",", ";"):
                self.take()
        self.take("}")
        return found


# ---- rotations, shapes, meshes --------------------------------------------------------------------------------------


def rotation(axis, angle):
    """The rotation by each angle about an axis: an array of shape (..., 3, 3)."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.asarray(angle)[..., None, None]
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * (k @ k)


def rpy_rotation(rpy):
    return rotation([0, 0, 1], rpy[2]) @ rotation([0, 1, 0], rpy[1]) @ rotation([1, 0, 0], rpy[0])


class Soup:
    """Triangles, each with a radius: a ball has three equal corners, a capsule two. `closed`: of closed surfaces."""

    def __init__(self, triangles, radius=0.0, closed=True):
        self.triangles = np.asarray(triangles, float).reshape(-1, 3, 3)
        self.radius = np.full(len(self.triangles), float(radius))
        self.closed = np.full(len(self.triangles), closed)

    def moved(self, turn, shift):
        self.triangles = self.triangles @ np.asarray(turn).T + np.asarray(shift)
        return self

    @staticmethod
    def join(soups):
        whole = Soup(np.concatenate([s.triangles for s in soups]))
        whole.radius = np.concatenate([s.radius for s in soups])
        whole.closed = np.concatenate([s.closed for s in soups])
        return whole


def box(lo, hi):
    corners = np.array([[(hi if i >> k & 1 else lo)[k] for k in range(3)] for i in range(8)], float)
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return Soup([corners[[a, b, c]] for f in faces for a, b, c in ((f[0], f[1], f[2]), (f[0], f[2], f[3]))])


def ball(centre, radius):
    return Soup([[centre] * 3], radius, closed=False)


def cylinder(radius, length, sides=96):
    angle = 2 * math.pi * np.arange(sides) / sides
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(sides)], 1)
    low, high = ring - [0, 0, length / 2], ring + [0, 0, length / 2]
    bottom, top = np.array([0, 0, -length / 2]), np.array([0, 0, length / 2])
    after = np.roll(np.arange(sides), -1)
    triangles = [[low[i], low[j], high[j]] for i, j in enumerate(after)]
    triangles += [[low[i], high[j], high[i]] for i, j in enumerate(after)]
    triangles += [[bottom, low[j], low[i]] for i, j in enumerate(after)]
    triangles += [[top, high[i], high[j]] for i, j in enumerate(after)]
    return Soup(triangles)


def capsule(radius, length):
    return Soup([[[0, 0, -length / 2], [0, 0, length / 2], [0, 0, length / 2]]], radius, closed=False)


def read_stl(data):
    if len(data) >= 84 and 84 + 50 * struct.unpack_from("<I", data, 80)[0] <= len(data):
        count = struct.unpack_from("<I", data, 80)[0]
        if count and (not data[:5] == b"solid" or 84 + 50 * count == len(data)):
            kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
            return np.frombuffer(data, kind, count, 84)["corners"].astype(float)
    numbers = re.findall(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", data)
    if not numbers:
        raise Unreadable("no STL file")
    return np.array(numbers, dtype=float).reshape(-1, 3, 3)


def read_obj(data):
    points, triangles = [], []
    for line in data.decode("utf-8", "replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(w.split("/")[0]) for w in words[1:]]
            corners = [c - 1 if c > 0 else len(points) + c for c in corners]
            triangles += [[points[c] for c in (corners[0], a, b)] for a, b in zip(corners[1:], corners[2:])]
    return np.array(triangles).reshape(-1, 3, 3)


def read_collada(data):
    root = ElementTree.fromstring(data)
    for element in root.iter():
        element.tag = element.tag.split("}")[-1]
    unit = root.find("asset/unit")
    metres = float(unit.get("meter", 1)) if unit is not None else 1.0
    identified = {e.get("id"): e for e in root.iter() if e.get("id")}

    def source(reference):
        element = identified[reference[1:]]
        if element.tag == "vertices":
            return source(next(i.get("source") for i in element.findall("input") if i.get("semantic") == "POSITION"))
        accessor = element.find("technique_common/accessor")
        stride = int(accessor.get("stride", 1))
        numbers = np.array((element.find("float_array").text or "").split(), float)
        first, size = int(accessor.get("offset", 0)), int(accessor.get("count")) * stride
        return numbers[first:first + size].reshape(-1, stride)[:, :3]

    def geometry(reference):
        triangles = []
        mesh = identified[reference[1:]].find("mesh")
        for group in mesh if mesh is not None else []:
            if group.tag not in ("triangles", "polylist", "polygons", "tristrips", "trifans"):
                continue
            inputs = group.findall("input")
            stride = 1 + max(int(i.get("offset", 0)) for i in inputs)
            vertex = next(i for i in inputs if i.get("semantic") == "VERTEX")
            points, offset = source(vertex.get("source")), int(vertex.get("offset", 0))
            lists = [np.array((p.text or "").split(), int)[offset::stride] for p in group.findall("p")]
            if group.tag == "triangles":
                triangles += [points[i].reshape(-1, 3, 3) for i in lists]
            elif group.tag == "polylist":
                at = 0
                for count in map(int, (group.findtext("vcount") or "").split()):
                    face = points[lists[0][at:at + count]]
                    triangles += [face[[0, k, k + 1]][None] for k in range(1, count - 1)]
                    at += count
            else:
                for face in (points[i] for i in lists):
                    first = (lambda k: 0) if group.tag != "tristrips" else (lambda k: k - 1)
                    triangles += [face[[first(k), k, k + 1]][None] for k in range(1, len(face) - 1)]
        return triangles

    found = []

    def node(element, at):
        for child in element:
            numbers = np.array((child.text or "").split(), float) if child.tag in TRANSFORMS else None
            if child.tag == "matrix":
                at = at @ numbers.reshape(4, 4)
            elif numbers is not None:
                step = np.eye(4)
                if child.tag == "translate":
                    step[:3, 3] = numbers
                elif child.tag == "scale":
                    step[:3, :3] = np.diag(numbers)
                else:
                    step[:3, :3] = rotation(numbers[:3], math.radians(numbers[3]))
                at = at @ step
        for child in element:
            if child.tag == "instance_geometry":
                found.extend(t @ at[:3, :3].T + at[:3, 3] for t in geometry(child.get("url")))
            elif child.tag == "instance_node":
                node(identified[child.get("url")[1:]], at)
            elif child.tag == "node":
                node(child, at)

    for scene in root.iter("visual_scene"):
        node(scene, np.eye(4))
    if not found:
        raise Unreadable("no triangles in the COLLADA file")
    return np.concatenate(found) * metres


TRANSFORMS = ("matrix", "translate", "rotate", "scale")


def find_mesh(name, urdf):
    """The file that a mesh's name means: beside the URDF file or in a folder above it, as a package there."""
    rest = re.sub(r"^(package|model|file)://", "", name)
    if os.path.isabs(rest) and os.path.exists(rest):
        return rest
    folder = os.path.dirname(os.path.abspath(urdf))
    tails = [rest] + ([rest.split("/", 1)[1]] if name.startswith("package://") and "/" in rest else [])
    for tail in tails:
        above = folder
        while True:
            if os.path.exists(os.path.join(above, tail)):
                return os.path.join(above, tail)
            if above == os.path.dirname(above):
                break
            above = os.path.dirname(above)
    raise Unreadable(f"{urdf}: mesh {name} is not found")


def read_mesh(path):
    with open(path, "rb") as file:
        data = file.read()
    kind = path.lower().rsplit(".", 1)[-1]
    if kind not in ("stl", "stla", "stlb", "obj", "dae"):
        raise Unreadable(f"{path}: STL, OBJ and COLLADA are read")
    try:
        return {"obj": read_obj, "dae": read_collada}.get(kind, read_stl)(data)
    except (ValueError, KeyError, IndexError, AttributeError, ElementTree.ParseError) as fault:
        raise Unreadable(f"{path}: {fault!r}") from fault


# ---- the robot ------------------------------------------------------------------------------------------------------


def three(element, name, default):
    text = element.get(name) if element is not None else None
    return np.array([float(w) for w in text.split()]) if text and text.strip() else np.array(default, float)


class Joint:
    def __init__(self, name, kind, parent, child, shift, turn, axis, lo, hi, mimic):
        self.name, self.kind, self.parent, self.child = name, kind, parent, child
        self.shift, self.turn, self.axis = shift, turn, axis
        self.lo, self.hi, self.mimic = lo, hi, mimic


class Robot:
    """Links with their geometry, and joints, breadth first."""

    def __init__(self, urdf, srdf=None, base=None):
        root = ElementTree.parse(urdf).getroot()
        self.geometry, cache = {}, {}
        for link in root.findall("link"):
            soups = []
            for collision in link.findall("collision"):
                shapes = collision.find("geometry")
                for shape in shapes if shapes is not None else []:
                    soups.append(self.shape(shape, urdf, cache))
                    origin = collision.find("origin")
                    soups[-1].moved(rpy_rotation(three(origin, "rpy", [0, 0, 0])), three(origin, "xyz", [0, 0, 0]))
            self.geometry[link.get("name")] = Soup.join(soups) if soups else None
        joints = [self.joint(j) for j in root.findall("joint") if j.find("parent") is not None]
        children = {j.child for j in joints}
        roots = [name for name in self.geometry if name not in children]
        if len(roots) != 1:
            raise Unreadable(f"{urdf}: {len(roots)} links have no joint above them")
        self.base = roots[0]
        self.joints, links = [], [self.base]
        for link in links:
            for j in joints:
                if j.parent == link:
                    self.joints.append(j)
                    links.append(j.child)
        self.links = links
        self.by_name = {j.name: j for j in self.joints}
        self.above = {j.child: j for j in self.joints}
        self.place = base if base is not None else (np.eye(3), np.zeros(3))
        self.disabled, self.groups, self.states = set(), {}, {}
        if srdf:
            self.read_srdf(ElementTree.parse(srdf).getroot())

    @staticmethod
    def shape(shape, urdf, cache):
        if shape.tag == "box":
            size = three(shape, "size", [0, 0, 0])
            return box(-size / 2, size / 2)
        if shape.tag == "sphere":
            return ball([0, 0, 0], float(shape.get("radius")))
        if shape.tag in ("cylinder", "capsule"):
            make = cylinder if shape.tag == "cylinder" else capsule
            return make(float(shape.get("radius")), float(shape.get("length")))
        if shape.tag != "mesh":
            raise Unreadable(f"{urdf}: geometry '{shape.tag}'")
        path = find_mesh(shape.get("filename"), urdf)
        if path not in cache:
            cache[path] = read_mesh(path)
        return Soup(cache[path] * three(shape, "scale", [1, 1, 1]))

    @staticmethod
    def joint(element):
        origin, axis, limit, mimic = (element.find(n) for n in ("origin", "axis", "limit", "mimic"))
        direction = three(axis, "xyz", [1, 0, 0])
        follows = None
        if mimic is not None and element.get("type") != "fixed":
            follows = (mimic.get("joint"), float(mimic.get("multiplier") or 1), float(mimic.get("offset") or 0))
        bound = [float(limit.get(n) or 0) if limit is not None else 0.0 for n in ("lower", "upper")]
        return Joint(element.get("name"), element.get("type"), element.find("parent").get("link"),
                     element.find("child").get("link"), three(origin, "xyz", [0, 0, 0]),
                     rpy_rotation(three(origin, "rpy", [0, 0, 0])), direction, bound[0], bound[1], follows)

    def read_srdf(self, root):
        for pair in root.findall("disable_collisions"):
            self.disabled.add(frozenset((pair.get("link1"), pair.get("link2"))))
        for name in [e.get("link") for e in root.findall("disable_default_collisions")]:
            self.disabled |= {frozenset((name, other)) for other in self.geometry}
        for pair in root.findall("enable_collisions"):
            self.disabled.discard(frozenset((pair.get("link1"), pair.get("link2"))))
        elements = {g.get("name"): g for g in root.findall("group") if len(g)}

        def members(name):
            found = set()
            for part in elements[name]:
                if part.tag == "joint":
                    found.add(part.get("name"))
                elif part.tag == "link" and part.get("name") in self.above:
                    found.add(self.above[part.get("name")].name)
                elif part.tag == "group" and part.get("name") in elements:
                    found |= members(part.get("name"))
                elif part.tag == "chain":
                    link = part.get("tip_link")
                    while link != part.get("base_link") and link in self.above:
                        found.add(self.above[link].name)
                        link = self.above[link].parent
            return found

        self.groups = {name: members(name) for name in elements}

    def moves(self, joint):
        return joint.kind in ("revolute", "continuous", "prismatic") and not joint.mimic and (
            joint.kind == "continuous" or joint.hi > joint.lo)

    def moving(self, group=None):
        """The names of the joints of a group (a name, a list of joints, or None: all), in the order of coordinates."""
        names = self.groups.get(group) if isinstance(group, str) else group
        if isinstance(group, str) and names is None:
            raise Unreadable(f"the SRDF file has no group '{group}'")
        return [j.name for j in self.joints if self.moves(j) and (names is None or j.name in names)]

    def values(self, q):
        """The value of every joint, of the values of those that lead: numbers or arrays of them."""

        def value(joint, depth=0):
            if joint.mimic and depth < len(self.joints):
                leader, factor, offset = joint.mimic
                return factor * value(self.by_name[leader], depth + 1) + offset
            lo, hi = (joint.lo, joint.hi) if joint.kind != "continuous" and joint.hi >= joint.lo else (0.0, 0.0)
            return q.get(joint.name, min(max(0.0, lo), hi))

        return {j.name: value(j) for j in self.joints if j.kind in ("revolute", "continuous", "prismatic")}

    def poses(self, q):
        """The rotation and position of every link at n configurations, of arrays of n values for each joint."""
        values = self.values(q)
        found = {self.base: self.place}
        for j in self.joints:
            turn, shift = found[j.parent]
            at = (turn @ j.turn, turn @ j.shift + shift)
            if j.kind in ("revolute", "continuous"):
                at = (at[0] @ rotation(j.axis, values[j.name]), at[1])
            elif j.kind == "prismatic":
                step = np.asarray(values[j.name])[..., None] * (j.axis / np.linalg.norm(j.axis))
                at = (at[0], at[1] + (at[0] @ step[..., None])[..., 0])
            found[j.child] = at
        return found

    def chain(self, link):
        """The joints from the base to a link."""
        found = []
        while link in self.above:
            found.append(self.above[link])
            link = found[-1].parent
        return found[::-1]

    def rigid_group(self, link):
        while link in self.above and self.above[link].kind == "fixed":
            link = self.above[link].parent
        return link

    def adjacent(self, a, b):
        """Whether fixed joints, or these and one other, connect two links."""
        a, b = self.rigid_group(a), self.rigid_group(b)
        return a == b or any(
            x in self.above and self.rigid_group(self.above[x].parent) == y for x, y in ((a, b), (b, a)))


# ---- distances ------------------------------------------------------------------------------------------------------


def dot(a, b):
    return np.einsum("...i,...i->...", a, b)


def segment_distances(p, q, r, s):
    """Squared distances of the segments pq and rs, which may be points."""
    u, v, w = q - p, s - r, p - r
    a, b, c, d, e = dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)
    tiny = 1e-300
    det = a * c - b * b
    t = np.where(det > 1e-12 * a * c, np.clip((b * e - c * d) / np.maximum(det, tiny), 0, 1), 0.0)
    at = np.clip((b * t + e) / np.maximum(c, tiny), 0, 1)
    t = np.clip((b * at - d) / np.maximum(a, tiny), 0, 1)
    between = w + t[..., None] * u - at[..., None] * v
    return dot(between, between)


def triangle_distances(a, b):
    """Distances of n pairs of triangles (n, 3, 3), 0 where they meet."""
    i, j = np.divmod(np.arange(9), 3)
    best = segment_distances(a[:, i], a[:, (i + 1) % 3], b[:, j], b[:, (j + 1) % 3]).min(1)
    for first, second in ((a, b), (b, a)):
        edge1, edge2 = second[:, 1] - second[:, 0], second[:, 2] - second[:, 0]
        normal = np.cross(edge1, edge2)
        square = dot(normal, normal)
        flat = square > 1e-30
        scale = np.where(flat, 1 / np.maximum(square, 1e-300), 0)[:, None]
        start = first - second[:, None, 0]
        height = dot(start, normal[:, None])

        def inside(points):
            x = dot(np.cross(points, edge2[:, None]), normal[:, None]) * scale
            y = dot(np.cross(edge1[:, None], points), normal[:, None]) * scale
            return (x >= 0) & (y >= 0) & (x + y <= 1) & flat[:, None]

        near = np.where(inside(start), height * height * scale, np.inf)
        best = np.minimum(best, near.min(1))
        following = np.roll(height, -1, 1)
        crosses = height * following < 0
        share = np.where(crosses, height / np.where(crosses, height - following, 1), 0)[..., None]
        meet = start + share * (np.roll(start, -1, 1) - start)
        best = np.where((crosses & inside(meet)).any(1), 0, best)
    return np.sqrt(best)


class Body:
    """A soup with a tree of balls: levels of 8 children, the lowest of at most 16 triangles."""

    def __init__(self, soup):
        count = len(soup.triangles)
        depth = max(0, math.ceil(math.log2(max(1, count / 8))))
        order, middles = [np.arange(count)], soup.triangles.mean(1)
        for _ in range(depth):
            halves = []
            for part in order:
                spread = middles[part]
                if len(part) > 1:
                    part = part[np.argsort(spread[:, np.argmax(np.ptp(spread, axis=0))], kind="stable")]
                halves += [part[: len(part) // 2], part[len(part) // 2:]]
            order = halves
        self.leaves = order
        indices = np.concatenate(order)
        self.triangles, self.radius = soup.triangles[indices], soup.radius[indices]
        self.closed = self.triangles[soup.closed[indices]]
        self.centre = self.triangles.mean(1)
        self.extent = np.linalg.norm(self.triangles - self.centre[:, None], axis=2).max(1) + self.radius
        ends = np.cumsum([len(p) for p in order])
        self.ranges = np.stack([ends - [len(p) for p in order], ends], 1)
        self.levels = [self.cover(self.ranges)]
        while len(self.levels[0][0]) > 1:
            ranges = self.levels[0][2]
            grouped = [(ranges[k][0], ranges[min(k + 8, len(ranges)) - 1][1]) for k in range(0, len(ranges), 8)]
            self.levels.insert(0, self.cover(np.array(grouped)))
        self.middle, self.reach = self.levels[0][0][0], self.levels[0][1][0]
        self.farthest = (np.linalg.norm(self.triangles, axis=2).max(1) + self.radius).max()

    def cover(self, ranges):
        centres, radii = np.zeros((len(ranges), 3)), np.full(len(ranges), -np.inf)
        for k, (lo, hi) in enumerate(ranges):
            if hi > lo:
                points = self.triangles[lo:hi].reshape(-1, 3)
                centres[k] = (points.min(0) + points.max(0)) / 2
                radii[k] = (np.linalg.norm(points - centres[k], axis=1) + np.repeat(self.radius[lo:hi], 3)).max()
        return centres, radii, ranges

    def contains(self, point):
        """Whether a closed part is round a point, by its winding number."""
        if not len(self.closed):
            return False
        a, b, c = (self.closed[:, k] - point for k in range(3))
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        top = dot(a, np.cross(b, c))
        below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
        return abs(np.arctan2(top, below).sum() / (2 * math.pi)) > 0.5


def distance(a, b, turn, shift, limit):
    """The distance of two bodies, b at a pose in a's frame: exact below `limit`, else a lower bound of at least it."""
    first, second = np.zeros(1, int), np.zeros(1, int)
    bound, beyond = limit, np.inf
    for level in range(max(len(a.levels), len(b.levels))):
        one = a.levels[min(level, len(a.levels) - 1)]
        two = b.levels[min(level, len(b.levels) - 1)]
        if level:
            grow = np.arange(8)
            if level < len(a.levels):
                first = (first[:, None] * 8 + grow).ravel()
                second = np.repeat(second, 8)
                keep = first < len(one[0])
                first, second = first[keep], second[keep]
            if level < len(b.levels):
                second = (second[:, None] * 8 + grow).ravel()
                first = np.repeat(first, 8)
                keep = second < len(two[0])
                first, second = first[keep], second[keep]
        centres = two[0] @ turn.T + shift
        between = np.linalg.norm(one[0][first] - centres[second], axis=1)
        reach = one[1][first] + two[1][second]
        filled = np.isfinite(reach)
        bound = min(bound, (between + reach)[filled].min(initial=np.inf))
        near = filled & (between - reach <= bound)
        beyond = min(beyond, (between - reach)[filled & ~near].min(initial=np.inf))
        first, second = first[near], second[near]
        if not len(first):
            return max(beyond, limit)
    size_a, size_b = np.diff(a.ranges)[first, 0], np.diff(b.ranges)[second, 0]
    count = size_a * size_b
    owner = np.repeat(np.arange(len(count)), count)
    index = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    i = a.ranges[first[owner], 0] + index // size_b[owner]
    j = b.ranges[second[owner], 0] + index % size_b[owner]
    centres = b.centre @ turn.T + shift
    between = np.linalg.norm(a.centre[i] - centres[j], axis=1)
    reach = a.extent[i] + b.extent[j]
    bound = min(bound, (between + reach).min(initial=np.inf))
    near = between - reach <= bound
    i, j, lower = i[near], j[near], (between - reach)[near]
    # Boxes about the triangles, along the axes of a and along those of b: long thin triangles fill their balls badly.
    moved = b.triangles @ turn.T + shift
    for one, at, two, to in ((a.triangles, i, moved, j), ((a.triangles - shift) @ turn, i, b.triangles, j)):
        lo, hi = one.min(1)[at], one.max(1)[at]
        gap = np.maximum(np.maximum(two.min(1)[to] - hi, lo - two.max(1)[to]), 0)
        lower = np.maximum(lower, np.sqrt(dot(gap, gap)) - a.radius[i] - b.radius[j])
    order = np.argsort(lower, kind="stable")
    best, part, size = limit, 0, 32
    while part < len(order) and lower[order[part]] < best:
        chosen = order[part:part + size]
        x, y = i[chosen], j[chosen]
        best = min(best, (triangle_distances(a.triangles[x], moved[y]) - a.radius[x] - b.radius[y]).min())
        part, size = part + size, min(2000, size * 4)
    return best


# ---- the check of a path --------------------------------------------------------------------------------------------


class Pair:
    def __init__(self, name, a, b, body_a, body_b, rates):
        self.name, self.a, self.b, self.body_a, self.body_b, self.rates = name, a, b, body_a, body_b, rates
        self.least, self.exact, self.undecided, self.contact = np.inf, False, 0, None


class Checker:
    """Follows pairs of bodies along paths."""

    def __init__(self, robot, joints, fixed, obstacles, allowed, step, limit):
        self.robot, self.joints, self.fixed, self.step, self.limit = robot, joints, fixed, step, limit
        self.bodies = {name: Body(soup) for name, soup in robot.geometry.items() if soup is not None}
        self.obstacles = {name: Body(soup) for name, soup in obstacles}
        self.pairs = [
            Pair(f"{link} / {name}", link, None, body, obstacle, self.rates(link, None))
            for link, body in self.bodies.items() for name, obstacle in self.obstacles.items()]
        names = [name for name in robot.links if name in self.bodies]
        self.left_out = 0
        for i, a in enumerate(names):
            for b in names[i + 1:]:
                if robot.adjacent(a, b):
                    continue
                if frozenset((a, b)) in robot.disabled or frozenset((a, b)) in allowed:
                    self.left_out += 1
                    continue
                self.pairs.append(Pair(f"{a} / {b}", a, b, self.bodies[a], self.bodies[b], self.rates(a, b)))

    def rates(self, a, b):
        """By how much a pair approaches at most while each joint moves by 1, a radian or a metre."""
        chains = [self.robot.chain(a), self.robot.chain(b) if b else []]
        common = 0
        while b and common < min(map(len, chains)) and chains[0][common] is chains[1][common]:
            common += 1
        found = {}
        for chain, link in zip(chains, (a, b)):
            reach = self.bodies[link].farthest if link else 0.0
            for joint in reversed(chain[common:]):
                rate = 1.0 if joint.kind == "prismatic" else reach
                leader, factor, depth = joint, 1.0, 0
                while leader.mimic and depth < len(self.robot.joints):
                    factor, leader, depth = factor * leader.mimic[1], self.robot.by_name[leader.mimic[0]], depth + 1
                if joint.kind in ("revolute", "continuous", "prismatic"):
                    found[leader.name] = found.get(leader.name, 0.0) + rate * abs(factor)
                reach += np.linalg.norm(joint.shift)
                if joint.kind == "prismatic":
                    lead = max(abs(leader.lo), abs(leader.hi))
                    reach += abs(factor) * lead + (abs(joint.mimic[2]) if joint.mimic else 0.0)
        return found

    def check(self, path):
        """Follows every pair along a path of configurations; returns the faults of joints' limits."""
        faults = []
        for pair in self.pairs:
            pair.least, pair.exact, pair.undecided, pair.contact = np.inf, False, 0, None
        path = np.asarray(path, float)
        for name, column in zip(self.joints, path.T):
            joint = self.robot.by_name[name]
            if joint.kind != "continuous" and (column.min() < joint.lo - 1e-9 or column.max() > joint.hi + 1e-9):
                faults.append(f"joint {name} leaves its limits: {column.min():.6g} to {column.max():.6g}, "
                              f"limits {joint.lo:.6g} to {joint.hi:.6g}")
        wraps = np.array([self.robot.by_name[n].kind == "continuous" for n in self.joints])
        if len(path) == 1:
            path = np.concatenate([path, path])
        for number, (start, end) in enumerate(zip(path, path[1:])):
            change = end - start
            change[wraps] = (change[wraps] + math.pi) % (2 * math.pi) - math.pi
            moved = [sum(abs(c) * p.rates.get(n, 0.0) for n, c in zip(self.joints, change)) for p in self.pairs]
            count = max(1, math.ceil(max(moved, default=0.0) / self.step))
            share = np.arange(count + 1) / count
            q = dict(self.fixed)
            q = {n: np.full(count + 1, float(v)) for n, v in q.items()}
            q.update({n: s + share * c for n, s, c in zip(self.joints, start, change)})
            poses = self.robot.poses(q)
            full = {}
            for name, (turn, shift) in poses.items():
                full[name] = (np.broadcast_to(turn, (count + 1, 3, 3)), np.broadcast_to(shift, (count + 1, 3)))
            for pair, motion in zip(self.pairs, moved):
                if pair.contact is None:
                    self.follow(pair, full, count, motion / count, number)
        return faults

    def follow(self, pair, poses, count, motion, number):
        turn_a, shift_a = poses[pair.a]
        centre_a = turn_a @ pair.body_a.middle + shift_a
        if pair.b:
            turn_b, shift_b = poses[pair.b]
            centre_b = turn_b @ pair.body_b.middle + shift_b
        else:
            centre_b = pair.body_b.middle
        apart = np.linalg.norm(centre_a - centre_b, axis=1) - pair.body_a.reach - pair.body_b.reach
        if apart.min() > min(pair.least, self.limit):
            if not pair.exact:
                pair.least = min(pair.least, apart.min())
            return
        # b in the frame of a, and how far its points move there: with its ball's centre, and turning about it.
        inverse = turn_a.transpose(0, 2, 1)
        turn = inverse @ turn_b if pair.b else inverse
        shift = (inverse @ ((shift_b if pair.b else 0.0) - shift_a)[..., None])[..., 0]
        middle = turn @ pair.body_b.middle + shift
        cosine = (np.einsum("nij,nij->n", turn[1:], turn[:-1]) - 1) / 2
        moves = np.linalg.norm(np.diff(middle, axis=0), axis=1)
        moves += np.arccos(np.clip(cosine, -1, 1)) * pair.body_b.reach
        moved = np.concatenate([[0.0], np.cumsum(np.minimum(moves, motion))])
        k = 0
        while k <= count:
            found = apart[k]
            if found <= self.limit:
                found = distance(pair.body_a, pair.body_b, turn[k], shift[k], self.limit)
                inner = k in (0, count) and found > 0 and (
                    pair.body_a.contains(turn[k] @ pair.body_b.triangles[0, 0] + shift[k])
                    or pair.body_b.contains(turn[k].T @ (pair.body_a.triangles[0, 0] - shift[k])))
                if found <= 0 or inner:
                    pair.least, pair.exact, pair.contact = 0.0, True, (number, k / count)
                    return
                pair.exact = pair.exact or found < self.limit
            pair.least = min(pair.least, found)
            if k == count:
                return
            ahead = int(np.searchsorted(moved, moved[k] + found, side="right")) - 1
            pair.undecided += ahead <= k
            k = min(count, max(k + 1, ahead))

    def report(self, name, faults, out, most):
        contacts = [p for p in self.pairs if p.contact is not None]
        for fault in faults:
            out(f"  LIMIT {fault}")
        for p in contacts:
            out(f"  CONTACT {p.name}: motion {p.contact[0] + 1}, at {p.contact[1]:.4f} of it")
        near = sorted((p for p in self.pairs if p.contact is None), key=lambda p: p.least)
        for p in near[:most]:
            size = f"{p.least:.6f} m" if p.exact else f"more than {min(p.least, self.limit):.3f} m"
            note = f", {p.undecided} intervals of at most {self.step} m by their ends alone" if p.undecided else ""
            out(f"  {p.name}: {size}{note}")
        links = sum(p.b is not None for p in self.pairs)
        verdict = "CONTACT" if contacts else "LIMITS" if faults else "free"
        out(f"{name}: {verdict}; {len(self.pairs) - links} pairs of link and obstacle, {links} of two links, "
            f"{self.left_out} disabled")
        return not contacts and not faults


# ---- scripts and documents ------------------------------------------------------------------------------------------


def numbers(table, count, what):
    if not isinstance(table, Table) or len(table.items) != count or not all(isinstance(x, float) for x in table.items):
        raise Unreadable(f"{what}: expected {count} literal numbers")
    return np.array(table.items)


def placed(value, what):
    """The rotation and the position of a literal pose."""
    if value is None:
        return np.eye(3), np.zeros(3)
    if not isinstance(value, Call) or value.name != "pose":
        raise Unreadable(f"{what}: expected a literal pose")
    table = value.arguments[0]
    shift = numbers(table, 3, what) if table.items else np.zeros(3)
    turn = np.eye(3)
    if "rpy" in table.fields:
        turn = rpy_rotation(numbers(table.fields["rpy"], 3, what))
    elif "axis" in table.fields:
        turn = rotation(numbers(table.fields["axis"], 3, what), table.fields["angle"])
    elif "quaternion" in table.fields:
        x, y, z, w = numbers(table.fields["quaternion"], 4, what)
        size = math.sqrt(x * x + y * y + z * z)
        turn = rotation([x, y, z], 2 * math.atan2(size, w)) if size > 0 else turn
    return turn, shift


SHAPES = ("box", "sphere", "cylinder", "capsule")


def read_world(value):
    if not isinstance(value, Call) or value.name != "world":
        raise Unreadable("the problem's world must be world { ... } with literal shapes")
    found = []
    for number, shape in enumerate(value.arguments[0].items, 1):
        if not isinstance(shape, Call) or not shape.arguments or shape.name not in SHAPES:
            raise Unreadable(f"obstacle {number}: boxes, spheres, cylinders and capsules are read")
        table = shape.arguments[0]
        name = table.fields.get("name", f"{shape.name} {number}")
        if shape.name == "box":
            corners = numbers(table, 6, name)
            soup = box(corners[:3], corners[3:])
        elif shape.name == "sphere":
            centre = numbers(table, 4, name)
            soup = ball(centre[:3], centre[3])
        else:
            make = cylinder if shape.name == "cylinder" else capsule
            soup = make(table.fields["radius"], table.fields["length"])
        found.append((name, soup.moved(*placed(table.fields.get("pose"), name))))
    return found


def read_problem(script, fields, folder, options):
    """The checker of a problem of a script."""
    made = fields.get("robot")
    if not isinstance(made, Call) or made.name != "robot.urdf":
        raise Unreadable("the problem's robot must be robot.urdf(...), written out")
    given = made.arguments[1].fields if len(made.arguments) > 1 else {}
    for name in given:
        if name not in ("srdf", "group", "values", "base", "packages", "self_collision"):
            raise Unreadable(f"robot.urdf: option '{name}' is not read here")
    base = given.get("base")
    if base == "planar":
        raise Unreadable("robot.urdf: base = 'planar' is not read here")
    if given.get("self_collision") is False:
        raise Unreadable("robot.urdf: self_collision = false is not read here")

    def file(name):
        return name if os.path.isabs(name) else os.path.join(folder, name)

    srdf = given.get("srdf")
    robot = Robot(file(made.arguments[0]), file(srdf) if srdf else None, placed(base, "base") if base else None)
    group = given.get("group")
    if isinstance(group, Table):
        group = group.items
    joints = options.joints.split(",") if options.joints else robot.moving(group)
    values = given["values"].fields if "values" in given else {}
    allowed = {frozenset(pair.split(",")) for pair in options.allow}
    return Checker(robot, joints, values, read_world(fields.get("world")), allowed, options.step, options.margin)


def warned_pairs(text):
    """The pairs of links of a run's warnings that say which are not checked: 'a' and 'b'."""
    return [f"{a},{b}" for line in text.splitlines() if "warning" in line and "touch" in line
            for a, b in re.findall(r"'([^']+)' and '([^']+)'", line)]


def run_script(options):
    """Runs the script; returns the document."""
    with tempfile.TemporaryDirectory() as folder:
        result = os.path.join(folder, "result.json")
        command = [options.run, "run", "--trust", options.script, "--json", result]
        run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
        if not os.path.exists(result):
            raise Unreadable(f"{' '.join(command)}: status {run.returncode}\n{run.stderr}")
        options.allow += warned_pairs(run.stderr)
        with open(result, encoding="utf-8") as file:
            return json.load(file)


def check_document(options):
    script = Script(options.script)
    if options.run:
        document = run_script(options)
    else:
        with open(options.result, encoding="utf-8") as file:
            document = json.load(file)
    folder = os.path.dirname(os.path.abspath(options.script))
    checkers, described, good, paths = {}, {p["name"]: p for p in document["experiment"]["problems"]}, True, 0
    for run in document["runs"]:
        if not run["path"]:
            continue
        name = run["problem"]
        if name not in script.problems:
            raise Unreadable(f"the script has no problem {{ name = \"{name}\" }} that is written out")
        if name not in checkers:
            checkers[name] = read_problem(script, script.problems[name], folder, options)
            if described[name].get("coordinates") and not options.joints:
                checkers[name].joints = described[name]["coordinates"]
        checker = checkers[name]
        if len(run["path"][0]) != len(checker.joints):
            raise Unreadable(f"'{name}': {len(run['path'][0])} coordinates, but {len(checker.joints)} joints move: "
                             f"{' '.join(checker.joints)}; --joints names them")
        title = f"{name}, {run['strategy']}, seed {run['seed']}"
        good = checker.report(title, checker.check(run["path"]), print, options.most) and good
        paths += 1
    print(f"{paths} paths: {'all free' if good else 'NOT all free'}")
    if not paths:
        raise Unreadable("the document has no path")
    return good


# ---- the self-test --------------------------------------------------------------------------------------------------

ARM = """<robot name="arm">
  <link name="base"><collision>
    <geometry><mesh filename="package://arm/cube.stl" scale="0.2 0.2 0.2"/></geometry>
  </collision></link>
  <link name="one"><collision><origin xyz="0.5 0 0"/><geometry><box size="0.8 0.1 0.1"/></geometry></collision></link>
  <link name="two"><collision>
    <origin xyz="0.5 0 0"/><geometry><cylinder radius="0.05" length="0.8"/></geometry>
  </collision></link>
  <link name="three"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="a" type="continuous"><parent link="base"/><child link="one"/><axis xyz="0 0 1"/></joint>
  <joint name="b" type="revolute"><parent link="one"/><child link="two"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-3.1" upper="3.1"/></joint>
  <joint name="c" type="prismatic"><parent link="two"/><child link="three"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-0.5" upper="0.5"/></joint>
</robot>
"""


def stl(soup):
    data = bytearray(80) + struct.pack("<I", len(soup.triangles))
    for t in soup.triangles:
        data += struct.pack("<12fH", 0, 0, 0, *t.ravel(), 0)
    return bytes(data)


def self_test():
    """Contacts that are known must be found, and distances that are known must be right."""
    failed = []

    def expect(what, holds):
        print(f"{'ok    ' if holds else 'FAILED'} {what}")
        if not holds:
            failed.append(what)

    still = np.eye(3)
    unit = Body(box([0, 0, 0], [1, 1, 1]))
    for what, other, shift, right in (
            ("box and box", unit, [1.5, 0.3, 0.2], 0.5), ("box and box, corners", unit, [2, 2, 2], math.sqrt(3)),
            ("box and ball", Body(ball([0, 0, 0], 0.25)), [1.5, 0.5, 0.5], 0.25),
            ("box and capsule", Body(capsule(0.1, 1.0)), [0.5, 0.5, 1.8], 0.2),
            ("box and cylinder", Body(cylinder(0.2, 1.0)), [0.5, 0.5, 2.0], 0.5),
            ("crossing boxes", unit, [0.5, 0.5, 0.5], 0.0)):
        found = distance(unit, other, still, np.array(shift), 10.0)
        expect(f"{what}: {found:.9f} m, right is {right:.9f}", abs(found - right) < 1e-9)
    random = np.random.default_rng(1)
    fine = Body(Soup(random.normal(size=(700, 3, 3)) * 0.05 + random.normal(size=(700, 1, 3))))
    turn, shift = rotation([1, 2, 3], 0.7), np.array([5.0, 1.0, 0.5])
    i, j = np.divmod(np.arange(700 * 700), 700)
    moved = fine.triangles @ turn.T + shift
    direct = min(triangle_distances(fine.triangles[i[k:k + 50000]], moved[j[k:k + 50000]]).min()
                 for k in range(0, len(i), 50000))
    found = distance(fine, fine, turn, shift, 100.0)
    expect(f"the tree of balls finds the nearest of 490,000 pairs: {found:.9f} m", abs(found - direct) < 1e-12)
    expect("a point inside a box is found", unit.contains(np.array([0.5, 0.5, 0.5])))
    expect("a point beside a box is not inside", not unit.contains(np.array([1.5, 0.5, 0.5])))

    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "arm.urdf"), "w", encoding="utf-8") as file:
            file.write(ARM)
        with open(os.path.join(folder, "cube.stl"), "wb") as file:
            file.write(stl(box([-0.5, -0.5, -0.5], [0.5, 0.5, 0.5])))
        script = os.path.join(folder, "s.lua")

        def check(path, shape, q=None, values=""):
            with open(script, "w", encoding="utf-8") as file:
                file.write("-- a comment { \nlocal arm = robot.urdf(\"arm.urdf\", { group = {\"a\", \"b\"" + (
                    "" if values else ", \"c\"") + "}" + values + " })\n"
                    "local room = world { bounds = {-5, -5, -5, 5, 5, 5}, contain = \"none\", " + shape + " }\n"
                    "local p = problem { name = \"p\", world = room, robot = arm, start = {0, 0}, goal = {1, 0} }\n"
                    "return skeleton() >> rrt_connect { step = 1 }, p\n")
            options = argparse.Namespace(joints="", allow=[], step=0.002, margin=0.05)
            made = Script(script)
            checker = read_problem(made, made.problems["p"], folder, options)
            faults = checker.check(path)
            return {p.name: p for p in checker.pairs if p.contact}, checker, faults

        far = "sphere { 4, 4, 4, 0.1 }"
        contacts, checker, faults = check([[0, 0, 0], [1, 1, 0.2]], far)
        expect("a free path is accepted", not contacts and not faults)
        contacts, _, _ = check([[0, 0, 0], [math.pi / 2, 0, 0]],
                               "box { 1.3, 1.3, -0.1, 1.5, 1.5, 0.1, name = \"post\" }")
        expect("a contact between two free ends is found", set(contacts) == {"three / post"})
        contacts, _, _ = check([[0, 0, 0], [math.pi / 2, 0, 0]],
                               "box { -5e-4, -5e-4, -1, 5e-4, 5e-4, 1, name = \"wire\", pose = pose {1.4, 1.4, 0} }")
        expect("a contact with a wire of 1 mm is found", set(contacts) == {"three / wire"})
        contacts, _, _ = check([[0, 0, 0], [0, 3.1, 0]], far)
        expect("a self-contact is found", "base / two" in contacts or "base / three" in contacts)
        contacts, checker, _ = check([[0, 3.0, 0], [0.5, 3.0, 0]], far)
        expect("a self-contact of the whole path is found", "base / three" in contacts or "base / two" in contacts)
        contacts, _, _ = check([[3.0, 0, 0], [-3.0, 0, 0]], "sphere { 1.5, 0, 0, 0.2, name = \"front\" }")
        expect("a continuous joint turns the shorter way", not contacts)
        contacts, _, _ = check([[3.0, 0, 0], [-3.0, 0, 0]], "sphere { -1.5, 0, 0, 0.2, name = \"back\" }")
        expect("and meets what is there", set(contacts) == {"two / back"})
        contacts, _, _ = check([[0, 0, 0], [0.1, 0, 0]], "sphere { 0, 0, 0, 0.02, name = \"inner\" }")
        expect("an obstacle inside of a closed mesh is found", "base / inner" in contacts)
        _, _, faults = check([[0, 0, 0], [0, 0, 0.6]], far)
        expect("a joint beyond its limit is found", len(faults) == 1)
        contacts, checker, _ = check([[0, 0], [0.2, 0]], "sphere { 2, 0, 0.7, 0.1, name = \"above\" }",
                                     values=", values = { c = 0.45 }")
        least = next(p for p in checker.pairs if p.name == "three / above").least
        expect(f"joints that do not move stay at their values: {least:.6f} m",
               not contacts and abs(least - 0.05) < 1e-6)
    print("self-test:", "FAILED" if failed else "passed")
    return not failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("script", nargs="?", help="a script for trellis run")
    parser.add_argument("result", nargs="?", help="what trellis run --json wrote of it")
    parser.add_argument("--run", metavar="TRELLIS", help="a program that runs the script, in place of a document")
    parser.add_argument("--self-test", action="store_true", help="checks this program")
    parser.add_argument("--joints", default="", metavar="A,B,...",
                        help="the joints of the path's coordinates, in order")
    parser.add_argument("--allow", action="append", default=[], metavar="A,B",
                        help="two links that may touch, as a warning of the run names them; may be repeated")
    parser.add_argument("--step", type=float, default=0.001, help="metres: the least advance along a path (0.001)")
    parser.add_argument("--margin", type=float, default=0.03,
                        help="metres: clearances above it are not computed (0.03)")
    parser.add_argument("--most", type=int, default=5, help="how many of the nearest pairs are printed (5)")
    options = parser.parse_args()
    try:
        if options.self_test:
            return 0 if self_test() else 1
        if not options.script or not (options.result or options.run):
            parser.error("a script and a document are needed, or --run")
        return 0 if check_document(options) else 1
    except (Unreadable, OSError, ElementTree.ParseError) as fault:
        print(f"check_arm_path.py: {fault}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())

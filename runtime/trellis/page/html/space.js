// SPDX-License-Identifier: GPL-3.0-or-later
// The viewer of problems in space: draws triangles with a depth buffer of its own on a plain canvas, so that the page
// looks alike in every browser and prints. Seen from far away (orthographic), as the figures. report.js draws paths and
// samples above it, and asks which of them an obstacle hides.
const space3 = (() => {
'use strict';

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/// Rotates v by the unit quaternion x, y, z, w.
function rotated(q, v) {
  const t = cross(q, v).map(c => 2 * c);
  return add(add(v, t.map(c => c * q[3])), cross(q, t));
}

/// The angle of the turn between two unit quaternions.
function angle(a, b) {
  const cos = Math.abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]);
  return 2 * Math.acos(Math.min(1, cos));
}

/// The quaternion at share t of the shortest turn from a to b, at constant speed.
function slerp(a, b, t) {
  const cos = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3], sign = cos < 0 ? -1 : 1;
  const half = Math.acos(Math.min(1, Math.abs(cos))), sin = Math.sin(half);
  const [s, e] = sin < 1e-6 ? [1 - t, t] : [Math.sin((1 - t) * half) / sin, Math.sin(t * half) / sin];
  return unit(a.map((c, i) => s * c + sign * e * b[i]));
}
const unit = q => { const n = Math.hypot(...q); return n > 0 ? q.map(c => c / n) : [0, 0, 0, 1]; };

/// A point of a body in the world.
const placed = (pose, v) => add(rotated(pose.rotation, v), pose.position);

/// The quaternion a * b.
const times = (a, b) => [
  a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
  a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3], a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]];

/// Two directions across an axis, as the planner chooses them.
function across(axis) {
  const other = Math.abs(axis[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0], along = dot(other, axis);
  const first = other.map((c, k) => c - along * axis[k]), u = first.map(c => c / Math.hypot(...first));
  return [u, cross(axis, u)];
}

/// The poses of all bodies of a robot of links and joints (forward kinematics): each comes after its parent.
function bodyPoses(robot, q) {
  const turn = (axis, angle) => [...axis.map(c => c * Math.sin(angle / 2)), Math.cos(angle / 2)];
  const of = pose => ({ position: pose.slice(0, 3), rotation: pose.slice(3) });
  const joined = (a, b) => ({ position: placed(a, b.position), rotation: times(a.rotation, b.rotation) });
  const poses = [of(robot.base)];
  for (let i = 1; i < robot.bodies.length; i++) {
    const body = robot.bodies[i], value = body.multiplier * q[body.column] + body.offset;
    const joint = { position: [0, 0, 0], rotation: [0, 0, 0, 1] };
    if (body.kind === 'prismatic') joint.position = body.axis.map(c => c * value);
    else if (body.kind === 'planar') {
      const [u, v] = across(body.axis);
      joint.position = u.map((c, k) => c * q[body.column] + v[k] * q[body.column + 1]);
      joint.rotation = turn(body.axis, q[body.column + 2]);
    } else if (body.kind === 'sliding in a plane') {
      const [u, v] = across(body.axis);
      joint.position = u.map((c, k) => c * q[body.column] + v[k] * q[body.column + 1]);
    } else if (body.kind === 'floating' || body.kind === 'sliding') {
      joint.position = q.slice(body.column, body.column + 3);
      if (body.kind === 'floating') joint.rotation = unit(q.slice(body.column + 3, body.column + 7));
    } else joint.rotation = turn(body.axis, value);
    poses.push(joined(joined(poses[body.parent], of(body.origin)), joint));
  }
  return poses;
}

/// Unpacks the surfaces of a world or a robot, with the functions of report.js that read bytes and numbers.
function surfaces(raw, bytes, numbers) {
  const floats = new Float32Array(bytes(raw.vertices).buffer), parts = numbers(raw.parts);
  const triangles = numbers(raw.triangles), edges = numbers(raw.edges), out = [];
  let v = 0, t = 0, e = 0;
  for (let i = 0; i + 3 < parts.length; i += 4) {
    const [nv, nt, ne, closed] = parts.slice(i, i + 4);
    const part = { vertices: floats.subarray(v, v += 3 * nv), triangles: triangles.slice(t, t += 3 * nt), edges: edges.slice(e, e += 2 * ne), closed: !!closed };
    part.lo = [Infinity, Infinity, Infinity];
    part.hi = [-Infinity, -Infinity, -Infinity];
    for (let k = 0; k < part.vertices.length; k++) {
      part.lo[k % 3] = Math.min(part.lo[k % 3], part.vertices[k]);
      part.hi[k % 3] = Math.max(part.hi[k % 3], part.vertices[k]);
    }
    out.push(part);
  }
  return out;
}

/// The edges of a closed part where triangles that face the camera meet those that do not: the outline of what is round.
function outline(part, rotation, to) {
  if (!part.closed) return [];
  if (!part.sides) {
    const open = new Map();  // directed edges, with their triangle
    part.sides = [];
    const v = i => part.vertices.subarray(3 * i, 3 * i + 3);
    part.normals = [];
    for (let i = 0; i < part.triangles.length; i += 3) {
      const [a, b, c] = part.triangles.slice(i, i + 3), [p, q, r] = [v(a), v(b), v(c)];
      part.normals.push(cross([q[0] - p[0], q[1] - p[1], q[2] - p[2]], [r[0] - p[0], r[1] - p[1], r[2] - p[2]]));
      for (const [from, on] of [[a, b], [b, c], [c, a]]) {
        const other = open.get(on + ' ' + from);
        if (other === undefined) open.set(from + ' ' + on, i / 3); else part.sides.push([from, on, i / 3, other]);
      }
    }
  }
  const facing = part.normals.map(n => dot(rotated(rotation, n), to) > 0);
  return part.sides.filter(([, , s, t]) => facing[s] !== facing[t]);
}

/// The directions of a view: towards the camera, to the right and upwards. Angles in degrees.
function camera(azimuth, elevation) {
  const a = azimuth * Math.PI / 180, e = elevation * Math.PI / 180;
  const to = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)], right = [-Math.sin(a), Math.cos(a), 0];
  return { to, right, up: cross(to, right) };
}

/// The share of a side of the bounds that a part covers along an axis.
const share = (part, b, axis) => (Math.min(part.hi[axis], b[axis + 3]) - Math.max(part.lo[axis], b[axis])) / (b[axis + 3] - b[axis]);
const longest = b => Math.max(b[3] - b[0], b[4] - b[1], b[5] - b[2]);

/// Whether a part closes the view into the bounds, as a ceiling does (as in draw/spatial.cpp).
function closesView(part, b, to) {
  const inside = 0.05 * longest(b);
  for (let axis = 0; axis < 3; axis++) {
    const beyond = to[axis] > 0.05 ? part.lo[axis] >= b[axis + 3] - inside : to[axis] < -0.05 ? part.hi[axis] <= b[axis] + inside : false;
    if (beyond && [0, 1, 2].every(other => other === axis || share(part, b, other) >= 0.6)) return true;
  }
  return false;
}
const encloses = (part, b) => [0, 1, 2].every(axis => share(part, b, axis) >= 0.6);

const shades = 32;

/// Draws solids into an image, and keeps the depth of each of its pixels.
class Picture {
  /// \param view  {to, right, up, X, Y, depth}: X and Y map the coordinates along right and up to pixels of the page
  constructor(width, height, ratio) {
    this.ratio = ratio;
    this.width = Math.max(1, Math.round(width * ratio));
    this.height = Math.max(1, Math.round(height * ratio));
    this.canvas = document.createElement('canvas');
    this.canvas.width = this.width;
    this.canvas.height = this.height;
    this.pen = this.canvas.getContext('2d');
    this.image = new ImageData(this.width, this.height);
    this.colours = new Uint32Array(this.image.data.buffer);
    this.depths = new Float32Array(this.width * this.height).fill(-Infinity);
  }

  /// Sets all pixels of a triangle of [x, y, depth] that nothing nearer covers.
  triangle(a, b, c, colour) {
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    if (area === 0) return;
    if (area < 0) { [b, c] = [c, b]; area = -area; }
    const x0 = Math.max(0, Math.ceil(Math.min(a[0], b[0], c[0]) - 0.5)), x1 = Math.min(this.width - 1, Math.floor(Math.max(a[0], b[0], c[0]) - 0.5));
    const y0 = Math.max(0, Math.ceil(Math.min(a[1], b[1], c[1]) - 0.5)), y1 = Math.min(this.height - 1, Math.floor(Math.max(a[1], b[1], c[1]) - 0.5));
    // The shares of b and c in a pixel change evenly along a row.
    const ub = (c[1] - a[1]) / area, vb = -(c[0] - a[0]) / area, uc = -(b[1] - a[1]) / area, vc = (b[0] - a[0]) / area;
    const dz = ub * (b[2] - a[2]) + uc * (c[2] - a[2]);
    for (let y = y0; y <= y1; y++) {
      const py = y + 0.5 - a[1], px = x0 + 0.5 - a[0];
      let sb = ub * px + vb * py, sc = uc * px + vc * py, z = a[2] + sb * (b[2] - a[2]) + sc * (c[2] - a[2]);
      let at = y * this.width + x0;
      for (let x = x0; x <= x1; x++, at++, sb += ub, sc += uc, z += dz) {
        if (sb < -1e-9 || sc < -1e-9 || sb + sc > 1 + 1e-9 || z <= this.depths[at]) continue;
        this.depths[at] = z;
        this.colours[at] = colour;
      }
    }
  }

  /// Sets the pixels of a line of [x, y, depth] that nothing nearer by more than `bias` covers.
  line(a, b, colour, bias) {
    const steps = Math.ceil(Math.max(Math.abs(b[0] - a[0]), Math.abs(b[1] - a[1])));
    if (!(steps < 1e5)) return;
    for (let i = 0; i <= steps; i++) {
      const t = steps ? i / steps : 0, x = Math.floor(a[0] + t * (b[0] - a[0])), y = Math.floor(a[1] + t * (b[1] - a[1]));
      if (x < 0 || y < 0 || x >= this.width || y >= this.height) continue;
      const at = y * this.width + x;
      if (a[2] + t * (b[2] - a[2]) + bias >= this.depths[at]) this.colours[at] = colour;
    }
  }

  /// Draws a surface in a colour [r, g, b], and its edges in another.
  /// \param place  maps a vertex x, y, z to [x, y, depth] in pixels of the image
  surface(part, frame, place, colour, edge, options) {
    const n = part.vertices.length / 3, points = new Array(n), world = new Array(n);
    for (let i = 0; i < n; i++) {
      const v = [part.vertices[3 * i], part.vertices[3 * i + 1], part.vertices[3 * i + 2]];
      world[i] = options.pose ? add(rotated(options.pose.rotation, v), options.pose.position) : v;
      points[i] = place(world[i]);
    }
    const { to, right, up } = frame.camera, b = frame.b, opened = options.obstacle && encloses(part, b), rim = axis => 0.03 * (b[axis + 3] - b[axis]);
    const light = [0, 1, 2].map(k => -0.35 * right[k] + 0.55 * up[k] + 0.75 * to[k]);
    // Whether a triangle lies at a side of the bounds that faces the camera, along this side.
    const before = (i, normal) => [0, 1, 2].some(axis => Math.abs(to[axis]) > 0.05 && Math.abs(normal[axis]) > 0.95 * Math.hypot(...normal) &&
        [0, 1, 2].every(k => atSide(world[part.triangles[i + k]], axis)));
    const atSide = (v, axis) => to[axis] > 0 ? v[axis] >= b[axis + 3] - rim(axis) : v[axis] <= b[axis] + rim(axis);
    for (let i = 0; i < part.triangles.length; i += 3) {
      const [p, q, r] = [world[part.triangles[i]], world[part.triangles[i + 1]], world[part.triangles[i + 2]]];
      let normal = cross([q[0] - p[0], q[1] - p[1], q[2] - p[2]], [r[0] - p[0], r[1] - p[1], r[2] - p[2]]);
      const length = Math.hypot(...normal), facing = dot(normal, to) / length;
      if (!(length > 0) || part.closed && !opened && facing <= 0) continue;
      if (opened && before(i, normal)) continue;
      const bright = Math.round(shades * Math.max(0, dot(normal, light) / length * (facing < 0 ? -1 : 1))) / shades;
      const factor = options.dark + (1 - options.dark) * bright * 1.25;
      const [cr, cg, cb] = colour.map(c => Math.min(255, Math.round(c * factor)));
      this.triangle(points[part.triangles[i]], points[part.triangles[i + 1]], points[part.triangles[i + 2]], 0xff000000 | cb << 16 | cg << 8 | cr);
    }
    if (!edge) return;
    const ink = 0xff000000 | edge[2] << 16 | edge[1] << 8 | edge[0];
    for (let i = 0; i < part.edges.length; i += 2) {
      const [p, q] = [world[part.edges[i]], world[part.edges[i + 1]]];
      const atRim = v => [0, 1, 2].some(axis => Math.abs(to[axis]) > 0.05 && atSide(v, axis));
      if (opened && atRim(p) && atRim(q)) continue;
      this.line(points[part.edges[i]], points[part.edges[i + 1]], ink, options.bias);
    }
  }

  finish() {
    this.pen.putImageData(this.image, 0, 0);
    return this;
  }
  /// The depth at a point of the page; -Infinity where nothing is.
  depthAt(x, y) {
    const i = Math.floor(x * this.ratio), j = Math.floor(y * this.ratio);
    return i < 0 || j < 0 || i >= this.width || j >= this.height ? -Infinity : this.depths[j * this.width + i];
  }
}

/// Multiples of 1, 2 or 5 times a power of ten between lo and hi.
function ticks(lo, hi, most) {
  const power = Math.pow(10, Math.floor(Math.log10((hi - lo) / most)));
  const step = [1, 2, 5, 10].map(k => k * power).find(s => (hi - lo) / s <= most * (1 + 1e-9));
  const out = [];
  for (let i = Math.ceil(lo / step - 1e-9); i * step <= hi + 1e-9 * step; i++) out.push(i * step);
  return { at: out, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

/// The corners of bounds, by bits: 1 for the upper x, 2 for y, 4 for z.
const corner = (b, bits) => [b[bits & 1 ? 3 : 0], b[bits & 2 ? 4 : 1], b[bits & 4 ? 5 : 2]];

/// The edges of the bounds: those before the scene (at the nearest corner), or the others.
function boxEdges(b, to, before) {
  let nearest = 0;
  for (let i = 1; i < 8; i++) if (dot(corner(b, i), to) > dot(corner(b, nearest), to)) nearest = i;
  const out = [];
  for (let i = 0; i < 8; i++) for (const bit of [1, 2, 4]) {
    if (!(i & bit) && (i === nearest || (i | bit) === nearest) === before) out.push([corner(b, i), corner(b, i | bit)]);
  }
  return out;
}

/// The edge at the rim of the picture that bears the numbers of an axis: [from, to].
function axisEdge(b, axis, frame) {
  let best = null, least = Infinity;
  const above = frame.camera.to[2] >= 0;
  for (let i = 0; i < 8; i++) {
    if (i & 1 << axis || axis < 2 && !(i & 4) !== above) continue;
    const ends = [corner(b, i), corner(b, i | 1 << axis)], [x, y] = frame.project(...[0, 1, 2].map(k => (ends[0][k] + ends[1][k]) / 2));
    const rim = axis === 2 ? x : -y;
    if (rim < least - 1e-6) { least = rim; best = ends; }
  }
  return best;
}

return { rotated, placed, bodyPoses, angle, slerp, unit, surfaces, outline, camera, closesView, Picture, ticks, boxEdges, axisEdge, corner };
})();

// SPDX-License-Identifier: GPL-3.0-or-later
// The page's script: shows one run at a time, from its records. No network, no storage; names that come from
// users only ever become text. The attributes of #viewer contain the current state.
(() => {
'use strict';

const $ = id => document.getElementById(id);
const viewer = $('viewer');
window.addEventListener('error', e => { viewer.dataset.error = e.message; });

const read = id => { const e = $(id); return e ? JSON.parse(e.textContent) : null; };
const data = read('data');

/// make('p', {className: 'x', onclick: f}, 'text', node, ...)
const make = (tag, fields, ...children) => {
  const e = Object.assign(document.createElement(tag), fields || {});
  e.append(...children);
  return e;
};

// The records -----------------------------------------------------------------------------------------------------

const bytes = text => Uint8Array.from(atob(text || ''), c => c.charCodeAt(0));

/// Whole numbers, seven bits to a byte, the lowest first.
const numbers = text => {
  const from = bytes(text), out = [];
  for (let i = 0; i < from.length;) {
    let value = 0, unit = 1, b;
    do { b = from[i++]; value += (b & 127) * unit; unit *= 128; } while (b > 127);
    out.push(value);
  }
  return out;
};
/// Maps 0, 1, 2, 3, ... to 0, -1, 1, -2, ...
const signed = n => n % 2 ? -(n + 1) / 2 : n / 2;

/// Rows of 16-bit shares of the axes' extents.
const rows = (text, axes) => {
  const from = bytes(text), d = axes.length, out = new Float64Array(from.length / 2);
  for (let i = 0; i < out.length; i++) {
    const axis = axes[i % d];
    out[i] = axis.lo + (axis.hi - axis.lo) * (from[2 * i] + 256 * from[2 * i + 1]) / 65535;
  }
  return { d, values: out, size: d ? out.length / d : 0, row: i => out.subarray(i * d, i * d + d) };
};

const fates = ['rejected', 'advanced', 'reached'];
const stations = {
  reached: 'reached: a node was added at the proposal itself',
  advanced: 'advanced: a node was added towards it',
  invalid: 'rejected: no node; the proposal itself is invalid',
  trapped: 'rejected: no node, though the proposal is valid; the way to it was blocked, or a node is there',
  rejected: 'rejected: no node',
};
const short = {
  reached: 'reached', advanced: 'advanced towards', invalid: 'rejected, invalid', trapped: 'rejected, though valid',
  rejected: 'rejected',
};

/// What `of` is for one robot of a team.
function traceOf(of, raw) {
  const trace = Object.create(of);
  trace.member = raw.robot;
  [trace.x, trace.y, trace.z] = raw.position;
  trace.tip = !!raw.tip;
  if (raw.tip) trace.robot = Object.assign(Object.create(of.robot), { tip: raw.tip });
  return trace;
}

function unpackLevel(raw, number) {
  const axes = raw.axes.map(([name, lo, hi, periodic, weight]) => ({ name, lo, hi, periodic: !!periodic, weight }));
  const level = { number, raw, axes, name: raw.name, nodes: rows(raw.nodes, axes), proposals: rows(raw.proposals, axes) };
  const n = level.nodes.size, p = level.proposals.size;
  level.robot = data.robots[raw.robot] || null;
  level.own = q => q.subarray(raw.first || 0);  // of the robot, without how far others are along their paths
  // Of a robot of links and joints in space the tip has a position.
  level.tip = raw.position.length < 2 && !!level.robot && !!level.robot.bodies && !!level.robot.tip && axes.length >= level.robot.dimension;
  [level.x, level.y, level.z] = raw.position;
  level.rotations = raw.rotations || [];      // the first columns of unit quaternions
  level.parents = raw.parents === null ? null : numbers(raw.parents).map((delta, i) => i - signed(delta));
  const kinds = bytes(raw.fates);
  level.station = i => {
    const fate = fates[kinds[i] & 3], validity = kinds[i] >> 2;
    return fate !== 'rejected' || validity === 0 ? fate : validity === 1 ? 'trapped' : 'invalid';
  };
  level.fate = i => fates[kinds[i] & 3];
  level.invalid = i => kinds[i] >> 2 === 2;
  level.source = numbers(raw.source);
  level.near = numbers(raw.near).map(v => v - 1);
  level.added = new Int32Array(p).fill(-1);
  let last = 0;
  numbers(raw.added).forEach((v, i) => { if (v) level.added[i] = last += signed(v - 1); });
  level.edges = [];
  const ends = numbers(raw.edges);
  last = 0;
  for (let i = 0; i + 1 < ends.length; i += 2) {
    const a = last += signed(ends[i]);
    level.edges.push([a, a + signed(ends[i + 1])]);
  }
  level.classes = raw.classes ? bytes(raw.classes) : null;
  level.nodeTime = new Int32Array(n).fill(0);
  level.proposalTime = new Int32Array(p).fill(0);
  level.cause = new Int32Array(n).fill(-1);   // the proposal that each node came of
  level.direct = new Uint8Array(n);           // it was added for it, not after it
  level.paths = [];                           // {time, rows}: what its solves found
  level.spans = [];                           // {from, to, solve}
  // The level as seen by each robot that has a position in it: of a team with positions and a colour of its own.
  level.traces = (raw.traces || []).map(t => traceOf(level, t));
  if (!raw.traces && (raw.position.length >= 2 || level.tip)) level.traces = [level];
  level.drawn = level.traces.length > 0;
  return level;
}

/// Puts the levels' records into one order: a step for each proposal, with the nodes that came of it, or for each node
/// where a search draws no proposals.
function order(run) {
  const done = run.levels.map(() => ({ p: 0, n: 0, solves: 0 }));
  let time = 0;
  for (const [number, p1, n1, ended, path] of run.turns) {
    const level = run.levels[number], was = done[number], from = time;
    for (let j = was.p; j < p1; j++) {
      level.proposalTime[j] = from + 1 + j - was.p;
      const node = level.added[j];
      if (node >= was.n && node < n1) { level.cause[node] = j; level.direct[node] = 1; }
    }
    time += p1 - was.p;
    let cause = -1;
    for (let i = was.n; i < n1; i++) {
      if (level.direct[i]) cause = level.cause[i];
      if (cause >= 0) {
        level.cause[i] = cause;
        level.nodeTime[i] = level.proposalTime[cause];
      } else if (level.parents && level.proposals.size) {
        level.nodeTime[i] = from + 1;  // a root takes no step of its own, also in a turn without a proposal
      } else {
        level.nodeTime[i] = ++time;
      }
    }
    level.spans.push({ from, to: time, solve: was.solves });
    if (ended) {
      was.solves++;
      if (path) level.paths.push({ time, rows: rows(path, level.axes) });
    }
    was.p = p1;
    was.n = n1;
  }
  run.total = time;
  for (const level of run.levels) {
    level.nodeTime = level.nodeTime.map(t => Math.min(t, time));
    // A node without a turn appears at once.
    level.nodeOrder = level.nodeTime;
    level.edgeTime = level.edges.map(([a, b]) => Math.max(level.nodeTime[a], level.nodeTime[b]));
    const roots = [];
    if (level.parents) level.parents.forEach((parent, i) => { if (parent === i) roots.push(i); });
    // Two roots in a row are the two trees of one search.
    level.plants = roots.filter((r, i) => i === 0 || roots[i - 1] !== r - 1);
  }
}

const cache = new Map();
function loadRun(id) {
  if (id < 0) return null;
  if (cache.has(id)) return cache.get(id);
  const raw = read('run-' + id);
  if (!raw) return null;
  const run = { id, raw, levels: raw.levels.map(unpackLevel), turns: raw.turns };
  run.path = run.levels.length && raw.path ? rows(raw.path, run.levels[0].axes) : null;
  order(run);
  // The levels that each source of h stands for: those that guide a level, in the order of its sources.
  for (const level of run.levels) {
    const guides = run.levels.filter(l => l.raw.parent === level.number);
    level.guides = level.raw.sources.map((name, i) => {
      const at = i < 3 ? -1 : guides.findIndex(l => l.name === name);
      return at < 0 ? null : guides.splice(at, 1)[0];
    });
  }
  if (cache.size > 8) cache.delete(cache.keys().next().value);
  cache.set(id, run);
  return run;
}

/// How many of the ascending times are at most `time`.
const until = (times, time) => {
  let lo = 0, hi = times.length;
  while (lo < hi) { const mid = (lo + hi) >> 1; if (times[mid] <= time) lo = mid + 1; else hi = mid; }
  return lo;
};

// The state ---------------------------------------------------------------------------------------------------------

const state = { scene: 0, method: 0, seed: 0, beside: -1, at: 0, along: null, select: null, layers: null, colour: 'fate', show: 'density', view: null };
let run = null, other = null, hover = null, playing = false, driving = false, grip = null, zoom = { k: 1, x: 0, y: 0 };
const roles = ['tree', 'expansion', 'path'];

const cell = () => data.cells[state.scene][state.method];
/// By default all layers of the root, and the trees and paths of the levels that guide it. In space proposals would cover
/// the scene, and so would those of many robots, of whose levels the root is shown.
const defaultLayers = () => {
  const on = new Set();
  for (const level of run ? run.levels : []) {
    if (team() && level.number > 0) break;
    on.add(level.number + ':tree').add(level.number + ':path');
    if (level.number === 0 && !spatial() && !team()) on.add('0:expansion');
  }
  return on;
};
const layers = () => state.layers || defaultLayers();
const shown = (level, role) => level.drawn && layers().has(level.number + ':' + role);

const view = () => {
  const times = run ? run.levels.map(l => ({ n: until(l.nodeOrder, state.at), p: until(l.proposalTime, state.at) })) : [];
  return times;
};

/// The last step of the runs that are shown.
const last = () => Math.max(run ? run.total : 0, other ? other.total : 0);

/// A run that found a path and is in this file: [scene, method, seed]. Of one scene and of one method where these are given,
/// else of the best method; the first run of all where there is none.
function solvedRun(scene, method) {
  const scenes = scene >= 0 ? [scene] : data.problems.map((p, i) => i);
  const methods = method >= 0 ? [method] : [...new Set([data.best, ...data.strategies.keys()])];
  for (const s of scenes) {
    for (const m of methods) {
      const seed = data.cells[s][m].runs.findIndex(r => r.solved && r.id >= 0);
      if (seed >= 0) return [s, m, seed];
    }
  }
  return [scenes[0], methods[0], 0];
}

function readHash() {
  const given = new URLSearchParams(location.hash.slice(1));
  const index = (list, name) => list.indexOf(name);
  const methods = data.strategies.map(s => s.name), seed = index(data.seeds.map(String), given.get('seed'));
  const [scene, method, solved] = solvedRun(index(data.problems.map(p => p.name), given.get('scene')), index(methods, given.get('method')));
  state.scene = scene;
  state.method = method;
  state.seed = seed >= 0 ? seed : solved;
  state.beside = given.has('beside') ? index(methods, given.get('beside')) : -1;
  state.show = given.get('show') === 'samples' ? 'samples' : 'density';
  state.layers = given.has('layers') ? new Set(given.get('layers').split(',').filter(Boolean)) : null;
  state.colour = given.get('colour') === 'source' ? 'source' : 'fate';
  const turn = /^(-?\d+),(-?\d+)$/.exec(given.get('view') || '');
  state.view = turn ? [Number(turn[1]), Math.max(-90, Math.min(90, Number(turn[2])))] : null;
  const at = given.get('at'), select = given.get('select'), along = given.get('along');
  if (['at', 'along', 'select', 'layers', 'beside', 'colour', 'show', 'view'].some(name => given.has(name))) $('fold-runs').open = true;
  load(false);
  state.along = along !== null && /^\d+$/.test(along) ? Math.min(1000, Number(along)) : null;
  if (run) {
    if (at !== null && /^\d+$/.test(at)) state.at = Math.min(last(), Number(at));
    state.select = null;
    if (select) setSelect(parseSelect(select), false);
  }
}

function writeHash() {
  const out = new URLSearchParams();
  out.set('scene', data.problems[state.scene].name);
  out.set('method', data.strategies[state.method].name);
  out.set('seed', data.seeds[state.seed]);
  if (state.beside >= 0) out.set('beside', data.strategies[state.beside].name);
  if (run && state.at < last()) out.set('at', state.at);
  if (state.along !== null) out.set('along', state.along);
  if (state.select) out.set('select', selectText());
  if (state.layers) out.set('layers', [...state.layers].join(','));
  if (state.colour !== 'fate') out.set('colour', state.colour);
  if (state.show !== 'density') out.set('show', state.show);
  if (state.view && spatial()) out.set('view', state.view.map(Math.round).join(','));
  const hash = '#' + out.toString().replace(/%3A/g, ':').replace(/%2C/g, ',');
  if (hash === location.hash) return;
  try { history.replaceState(null, '', hash); } catch (e) { /* some browsers keep a file's address as it is */ }
}

const selectText = () => state.select ? [state.select.level, state.select.role, state.select.index].join(':') : '';
function parseSelect(text) {
  const [level, role, index] = text.split(':');
  return { level: Number(level), role, index: Number(index) };
}
/// Selects a sample, or none where there is no such one; shows its layer, and the replay continues to it.
function setSelect(s, draw = true) {
  const level = s && run && run.levels[s.level];
  const list = level && (s.role === 'tree' ? level.nodes : s.role === 'expansion' ? level.proposals : null);
  if (!list || !(s.index >= 0 && s.index < list.size)) s = null;
  state.select = s;
  if (s) {
    const time = (s.role === 'tree' ? level.nodeTime : level.proposalTime)[s.index];
    if (state.at < time) state.at = time;
    if (level.drawn && !shown(level, s.role)) state.layers = new Set(layers()).add(s.level + ':' + s.role);
  }
  if (draw) refresh();
}

// Drawing -------------------------------------------------------------------------------------------------------------

const firstCanvas = $('canvas');
/// The drawing target: the canvas of the run, or that of the run beside it.
let canvas = firstCanvas, pen = canvas.getContext('2d'), plot = $('plot');
let colours = {}, frame = null;

function readColours() {
  const style = getComputedStyle(document.documentElement);
  const get = name => style.getPropertyValue('--' + name).trim();
  colours = { levels: [0, 1, 2, 3].map(i => get('level-' + i)) };
  for (const name of ['paper', 'ink', 'muted', 'line', 'free', 'obstacle', 'obstacle-edge', 'ends', 'accent',
                      'reached', 'advanced', 'invalid', 'trapped', 'rejected']) colours[name] = get(name);
  colours.sources = ['muted', 'trapped', 'advanced', 'reached', 'invalid'].map(name => colours[name])
      .concat(colours.levels.slice(1));
}
/// Of a robot of a team its own.
const levelColour = level => team() && level.member !== undefined ? team()[level.member].colour : colours.levels[level.number % 4];
/// In lists a level of one robot of a team has the robot's colour.
const listColour = level => levelColour(level.traces.length === 1 ? level.traces[0] : level);
const team = () => data.problems[state.scene].team;
/// Beyond four levels the lines are dashed.
const levelDash = level => [[], [5, 3], [1.5, 2.5]][Math.floor(level.number / 4) % 3];
const sourceColour = i => colours.sources[i % colours.sources.length];

/// Whether the scene is one of space: the page then contains space.js, and bounds are x, y, z of two corners.
const spatial = () => data.problems[state.scene].world !== undefined;

/// The visible part of the plane: the world, or without a world the bounds of the root's positions.
function bounds() {
  const problem = data.problems[state.scene];
  if (problem.bounds) return problem.bounds;
  const root = run && run.levels[0];
  if (!root || !root.drawn) return null;
  return [root.axes[root.x].lo, root.axes[root.y].lo, root.axes[root.x].hi, root.axes[root.y].hi];
}

function fitCanvas() {
  const b = bounds();
  plot.classList.toggle('empty', !b);
  canvas.hidden = !b;
  canvas.classList.toggle('space', spatial());
  if (!b) return null;
  const width = plot.clientWidth, most = Math.max(240, 0.74 * window.innerHeight);
  const aspect = spatial() ? 0.8 : (b[3] - b[1]) / (b[2] - b[0]);
  const height = Math.max(160, Math.min(most, width * aspect));
  const ratio = window.devicePixelRatio || 1;
  const w = Math.round(width * ratio), h = Math.round(height * ratio);
  if (canvas.width !== w || canvas.height !== h) {
    canvas.width = w;
    canvas.height = h;
    canvas.style.height = height + 'px';
  }
  if (spatial()) return spaceFrame(b, ratio, width, height);
  // A page that is not laid out yet has no width; radii must not be negative.
  const pad = 8, inside = length => Math.max(1, length - 2 * pad);
  const scale = Math.min(inside(width) / (b[2] - b[0]), inside(height) / (b[3] - b[1])) * zoom.k;
  const cx = (b[0] + b[2]) / 2 + zoom.x, cy = (b[1] + b[3]) / 2 + zoom.y;
  const at = (q, level) => [frame.X(q[level.x]), frame.Y(q[level.y]), 0];
  return { b, ratio, width, height, scale, at, hides: () => false, X: x => width / 2 + (x - cx) * scale, Y: y => height / 2 - (y - cy) * scale,
           back: (px, py) => [cx + (px - width / 2) / scale, cy - (py - height / 2) / scale] };
}

const viewNow = () => state.view || data.problems[state.scene].view;

/// The frame of a scene of space: its scale is that at which the default view fits.
function spaceFrame(b, ratio, width, height) {
  const camera = space3.camera(...viewNow()), first = space3.camera(...data.problems[state.scene].view);
  const dot = (a, p) => a[0] * p[0] + a[1] * p[1] + a[2] * p[2];
  const size = axis => { const all = [0, 1, 2, 3, 4, 5, 6, 7].map(i => dot(axis, space3.corner(b, i))); return Math.max(...all) - Math.min(...all); };
  const pad = 36, inside = length => Math.max(1, length - 2 * pad), middle = [0, 1, 2].map(k => (b[k] + b[k + 3]) / 2);
  const scale = Math.min(inside(width) / size(first.right), inside(height) / size(first.up)) * zoom.k;
  const cx = dot(camera.right, middle) + zoom.x, cy = dot(camera.up, middle) + zoom.y;
  const diagonal = Math.hypot(b[3] - b[0], b[4] - b[1], b[5] - b[2]);
  const space = { b, ratio, width, height, scale, camera, space: true, picture: null, bias: 0.004 * diagonal,
    project: (x, y, z) => [width / 2 + (dot(camera.right, [x, y, z]) - cx) * scale, height / 2 - (dot(camera.up, [x, y, z]) - cy) * scale, dot(camera.to, [x, y, z])],
    at: (q, level) => level.tip ? space.project(...tipOf(level.robot, q)) : space.project(q[level.x], q[level.y], q[level.z]),
    hides: ([x, y, depth]) => space.picture !== null && space.picture.depthAt(x, y) > depth + space.bias,
    back: (px, py) => [cx + (px - width / 2) / scale, cy - (py - height / 2) / scale] };
  return space;
}

/// The triangles of a world or a robot of space.
const partsOf = raw => raw.parts3 || (raw.parts3 = space3.surfaces(raw, bytes, numbers));
/// The pose of each part of a robot of space: of links and joints by forward kinematics.
const posesOf = (robot, q) => robot.bodies ? space3.bodyPoses(robot, q) : partsOf(robot.surfaces).map((_, i) => poseOf(q, ...(robot.columns ? robot.columns[i] : [0, robot.rotates])));
const tipOf = (robot, q) => { const [body, ...point] = robot.tip; return space3.placed(space3.bodyPoses(robot, q)[body], point); };
const poseOf = (q, k, rotates) => ({ position: [q[k], q[k + 1], q[k + 2]], rotation: rotates ? space3.unit([q[k + 3], q[k + 4], q[k + 5], q[k + 6]]) : [0, 0, 0, 1] });

/// The colour of the robot of a team that a body belongs to; null of a robot alone.
function memberColour(problem, robot, body) {
  if (!team() || robot !== data.robots[problem.robot] || !robot.bodies && !robot.columns) return null;
  const column = robot.columns ? robot.columns[body][0] : robot.bodies[body].column, member = team().find(m => m.axes.includes(column));
  return member ? member.colour : null;
}

/// Draws the solids of a scene of space into its depth buffer: obstacles, and robots as [robot, q, colour]. Keeps the
/// picture while nothing of it changes.
function drawSolids(problem, robots) {
  const moving = grip !== null || driving, sharp = moving ? frame.ratio : Math.max(2, frame.ratio);
  const key = JSON.stringify([state.scene, viewNow(), zoom, frame.width, frame.height, sharp, colours.obstacle, robots.map(([, q, colour]) => [[...q], colour])]);
  if (!canvas.solids || canvas.solids.key !== key) {
    const picture = new space3.Picture(frame.width, frame.height, sharp);
    const place = p => { const [x, y, depth] = frame.project(...p); return [x * sharp, y * sharp, depth]; };
    const base = rgb(colours.obstacle), edge = rgb(colours['obstacle-edge']);
    for (const part of partsOf(data.worlds[problem.world].surfaces)) {
      if (!space3.closesView(part, frame.b, frame.camera.to)) picture.surface(part, frame, place, base, edge, { obstacle: true, dark: 0.72, bias: frame.bias });
    }
    for (const [robot, q, colour] of robots) {
      const poses = posesOf(robot, q);
      partsOf(robot.surfaces).forEach((part, i) => picture.surface(part, frame, place, rgb(colour === colours.ends ? colour : memberColour(problem, robot, i) || colour), null, { pose: poses[i], dark: 0.6, bias: frame.bias }));
    }
    canvas.solids = { key, picture: picture.finish() };
  }
  frame.picture = canvas.solids.picture;
  pen.imageSmoothingEnabled = true;
  pen.drawImage(frame.picture.canvas, 0, 0, frame.width, frame.height);
}

/// Strokes lines given as [from, to] in coordinates of space: what an obstacle hides is faint.
function strokeSpace(lines, alpha) {
  const seen = new Path2D(), hidden = new Path2D();
  for (const [from, to] of lines) {
    const a = frame.project(...from), b = frame.project(...to);
    addLine(a, b, seen, hidden);
  }
  pen.globalAlpha = alpha;
  pen.stroke(seen);
  pen.globalAlpha = 0.25 * alpha;
  pen.stroke(hidden);
  pen.globalAlpha = 1;
}

/// Adds a line between points of the picture to one of two paths, in pieces of some pixels.
function addLine(a, b, seen, hidden) {
  const pieces = frame.space ? Math.max(1, Math.min(400, Math.ceil(Math.hypot(b[0] - a[0], b[1] - a[1]) / 6))) : 1;
  const at = t => [0, 1, 2].map(k => a[k] + t * (b[k] - a[k]));
  let path = null;
  for (let i = 0; i < pieces; i++) {
    const from = at(i / pieces), to = at((i + 1) / pieces), into = frame.hides(at((i + 0.5) / pieces)) ? hidden : seen;
    if (into !== path) into.moveTo(from[0], from[1]);
    into.lineTo(to[0], to[1]);
    path = into;
  }
}

/// The edges of a robot of space.
function drawRobot3(robot, q, options) {
  const parts = partsOf(robot.surfaces);
  if (!parts.length) return false;
  const poses = posesOf(robot, q), lines = [];
  for (const [n, part] of parts.entries()) {
    const pose = poses[n], at = i => space3.placed(pose, part.vertices.subarray(3 * i, 3 * i + 3));
    for (let i = 0; i < part.edges.length; i += 2) lines.push([at(part.edges[i]), at(part.edges[i + 1])]);
    for (const [a, b] of space3.outline(part, pose.rotation, frame.camera.to)) lines.push([at(a), at(b)]);
  }
  pen.strokeStyle = options.stroke;
  pen.lineWidth = options.width || 1.25;
  strokeSpace(lines, options.alpha || 1);
  return true;
}

/// The bounds, and metres along their edges.
function drawBox(before) {
  pen.strokeStyle = colours['obstacle-edge'];
  pen.lineWidth = before ? 0.7 : 1;
  pen.globalAlpha = before ? 0.5 : 0.9;
  pen.beginPath();
  for (const [a, b] of space3.boxEdges(frame.b, frame.camera.to, before)) {
    pen.moveTo(...frame.project(...a).slice(0, 2));
    pen.lineTo(...frame.project(...b).slice(0, 2));
  }
  pen.stroke();
  pen.globalAlpha = 1;
  if (before) return;
  pen.font = '11px system-ui, sans-serif';
  pen.fillStyle = colours.muted;
  pen.lineWidth = 1;
  const [mx, my] = frame.project(...[0, 1, 2].map(k => (frame.b[k] + frame.b[k + 3]) / 2)), labelled = [];
  for (let axis = 0; axis < 3; axis++) {
    const [from, to] = space3.axisEdge(frame.b, axis, frame), a = frame.project(...from), b = frame.project(...to);
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
    if (length < 30) continue;
    let out = [(b[1] - a[1]) / length, (a[0] - b[0]) / length];
    const half = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
    if (out[0] * (half[0] - mx) + out[1] * (half[1] - my) < 0) out = out.map(c => -c);
    pen.textAlign = out[0] < -0.3 ? 'right' : out[0] > 0.3 ? 'left' : 'center';
    pen.textBaseline = out[1] > 0.3 ? 'top' : out[1] < -0.3 ? 'bottom' : 'middle';
    const { at, digits } = space3.ticks(from[axis], to[axis], Math.max(2, Math.min(8, Math.floor(length / 45))));
    const place = value => { const t = (value - from[axis]) / (to[axis] - from[axis]); return [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]; };
    // At a corner two axes would write over each other.
    const free = at.filter(value => { const p = place(value); return !labelled.some(q => Math.hypot(p[0] - q[0], p[1] - q[1]) < 14); });
    free.forEach((value, i) => {
      const [x, y] = place(value);
      labelled.push([x, y]);
      pen.beginPath(); pen.moveTo(x, y); pen.lineTo(x + 4 * out[0], y + 4 * out[1]); pen.stroke();
      pen.fillText(value.toFixed(digits).replace(/^-/, '−') + (i === free.length - 1 ? ' m ' + 'xyz'[axis] : ''), x + 6 * out[0], y + 6 * out[1]);
    });
  }
  pen.textAlign = 'left';
}

/// Turns the view by some degrees.
function turnBy(azimuth, elevation) {
  if (!spatial()) return;
  const [a, e] = viewNow();
  state.view = [((a + azimuth + 540) % 360) - 180, Math.max(-90, Math.min(90, e + elevation))];
  viewer.dataset.view = state.view.map(Math.round).join(',');
  draw();
}

function shapePath(shape, place) {
  const at = place || ((x, y) => [x, y]);
  if (shape.length === 3) {
    const [x, y] = at(shape[0], shape[1]), r = shape[2] * frame.scale;
    pen.moveTo(frame.X(x) + r, frame.Y(y));
    pen.arc(frame.X(x), frame.Y(y), r, 0, 2 * Math.PI);
    return;
  }
  for (let i = 0; i < shape.length; i += 2) {
    const [x, y] = at(shape[i], shape[i + 1]);
    if (i === 0) pen.moveTo(frame.X(x), frame.Y(y)); else pen.lineTo(frame.X(x), frame.Y(y));
  }
  pen.closePath();
}

/// The poses of a robot's bodies, as computed by Robot::place.
function poses(robot, q) {
  const out = [];
  for (const body of robot.bodies) {
    const [rx, ry] = robot.translates ? [q[0], q[1]] : body.position >= 0 ? [q[body.position], q[body.position + 1]] : robot.base;
    const above = body.parent < 0 ? { x: rx, y: ry, c: 1, s: 0 } : out[body.parent];
    const [jx, jy] = body.joint;
    const pose = { x: above.x + above.c * jx - above.s * jy, y: above.y + above.s * jx + above.c * jy, c: above.c, s: above.s };
    if (body.axis >= 0) {
      const c = Math.cos(q[body.axis]), s = Math.sin(q[body.axis]);
      if (body.absolute || body.parent < 0) { pose.c = c; pose.s = s; }
      else { pose.c = above.c * c - above.s * s; pose.s = above.s * c + above.c * s; }
    }
    out.push(pose);
  }
  return out;
}

function drawRobot(robot, q, options) {
  if (!robot || q.length < robot.dimension) return false;
  if (frame.space) return drawRobot3(robot, q, options);
  const at = poses(robot, q), members = new Set(robot.bodies.map(body => body.robot));
  let extent = 0;
  for (const member of members) {
    pen.beginPath();
    robot.bodies.forEach((body, i) => {
      if (body.robot !== member) return;
      for (const part of body.parts) {
        extent = Math.max(extent, part.length === 3 ? part[2] : 1);
        shapePath(part, (x, y) => [at[i].x + at[i].c * x - at[i].s * y, at[i].y + at[i].s * x + at[i].c * y]);
      }
    });
    if (extent === 0) return false;  // a point
    const own = team() && member !== undefined ? team()[member].colour : null;
    if (options.fill) { pen.globalAlpha = options.fillAlpha || 0.25; pen.fillStyle = own || options.fill; pen.fill(); }
    pen.globalAlpha = options.alpha || 1;
    pen.strokeStyle = own || options.stroke;
    pen.lineWidth = options.width || 1.25;
    pen.stroke();
    pen.globalAlpha = 1;
  }
  return true;
}

function marker(kind, x, y, r) {
  if (kind === 'reached') { pen.moveTo(x + r, y); pen.arc(x, y, r, 0, 2 * Math.PI); }
  else if (kind === 'advanced') { pen.moveTo(x + r, y); pen.arc(x, y, r, 0, 2 * Math.PI); }
  else if (kind === 'trapped') { pen.moveTo(x, y - r * 1.25); pen.lineTo(x + r * 1.25, y); pen.lineTo(x, y + r * 1.25); pen.lineTo(x - r * 1.25, y); pen.closePath(); }
  else { pen.moveTo(x - r, y - r); pen.lineTo(x + r, y + r); pen.moveTo(x - r, y + r); pen.lineTo(x + r, y - r); }
}

/// The lines of a path: those that are seen, and those behind obstacles.
function polyline(path, level) {
  const seen = new Path2D(), hidden = new Path2D();
  for (let i = 1; i < path.size; i++) addLine(frame.at(path.row(i - 1), level), frame.at(path.row(i), level), seen, hidden);
  return [seen, hidden];
}

function drawTree(level, n) {
  const at = i => frame.at(level.nodes.row(i), level);
  const middle = (a, b) => [0, 1, 2].map(k => (a[k] + b[k]) / 2);
  const stroke = (ends, alpha) => {
    const seen = new Path2D(), hidden = new Path2D();
    for (const [i, j] of ends) {
      const a = at(i), b = at(j), path = frame.hides(middle(a, b)) ? hidden : seen;
      path.moveTo(a[0], a[1]);
      path.lineTo(b[0], b[1]);
    }
    pen.globalAlpha = alpha;
    pen.stroke(seen);
    pen.globalAlpha = 0.25 * alpha;
    pen.stroke(hidden);
  };
  // Abandoned trees are fainter.
  const plant = level.plants.filter(r => r < n).pop() || 0;
  const colour = levelColour(level);
  const many = n > 4000, dense = level.edges.length > 2 * level.nodes.size;
  for (const [from, to, alpha] of [[0, plant, 0.22], [plant, n, 1]]) {
    if (from >= to) continue;
    pen.strokeStyle = pen.fillStyle = colour;
    pen.lineWidth = many ? 0.6 : 0.9;
    pen.setLineDash(levelDash(level));
    const ends = [];
    if (level.parents) {
      for (let i = from; i < to; i++) {
        const up = level.parents[i];
        // A rewired node may have a parent that the replay has not reached.
        if (up !== i && up < n) ends.push([up, i]);
      }
    }
    stroke(ends, alpha * (many ? 0.7 : 0.85));
    pen.setLineDash([]);
    const seen = new Path2D(), hidden = new Path2D();
    // The points along a graph's edges are no new nodes.
    const r = level.edges.length && !dense ? 0.6 : many || dense ? 1.1 : 1.7;
    for (let i = from; i < to; i++) {
      const p = at(i), path = frame.hides(p) ? hidden : seen;
      path.moveTo(p[0] + r, p[1]);
      path.arc(p[0], p[1], r, 0, 7);
    }
    pen.globalAlpha = alpha;
    pen.fill(seen);
    pen.globalAlpha = 0.25 * alpha;
    pen.fill(hidden);
  }
  if (level.edges.length) {
    pen.strokeStyle = colour;
    pen.lineWidth = dense ? 0.6 : 1.2;
    pen.setLineDash(levelDash(level));
    stroke(level.edges.filter((ends, i) => level.edgeTime[i] <= state.at), dense ? Math.max(0.07, Math.min(0.5, 200 / level.edges.length)) : 0.85);
    pen.setLineDash([]);
  }
  pen.globalAlpha = 1;
}

/// How densely a level's first p proposals lie, where they have a position: the logarithm of their number about each
/// point of the picture, so that both the goal, which is drawn again and again, and thinly covered parts are seen.
function drawDensity(level, p) {
  const step = 5, w = Math.ceil(frame.width / step) + 1, h = Math.ceil(frame.height / step) + 1;
  let grid = new Float32Array(w * h);
  for (let i = 0; i < p; i++) {
    const [x, y] = frame.at(level.proposals.row(i), level).map(c => c / step);
    const cx = Math.floor(x), cy = Math.floor(y), fx = x - cx, fy = y - cy;
    if (cx < 0 || cy < 0 || cx + 1 >= w || cy + 1 >= h) continue;
    const at = cy * w + cx;
    grid[at] += (1 - fx) * (1 - fy);
    grid[at + 1] += fx * (1 - fy);
    grid[at + w] += (1 - fx) * fy;
    grid[at + w + 1] += fx * fy;
  }
  // A binomial kernel, some 8 pixels wide.
  for (let pass = 0; pass < 2; pass++) {
    for (const by of [1, w]) {
      const out = new Float32Array(w * h);
      for (let y = 1; y + 1 < h; y++) {
        for (let x = 1; x + 1 < w; x++) {
          const at = y * w + x;
          out[at] = 0.25 * grid[at - by] + 0.5 * grid[at] + 0.25 * grid[at + by];
        }
      }
      grid = out;
    }
  }
  let most = 0, sum = 0, filled = 0;
  for (const v of grid) if (v > 0) { most = Math.max(most, v); sum += v; filled++; }
  if (!filled) return;
  const unit = 0.5 * sum / filled, top = Math.log1p(most / unit);
  const image = new ImageData(w, h), [r, g, b] = rgb(levelColour(level));
  for (let i = 0; i < grid.length; i++) {
    image.data[4 * i] = r;
    image.data[4 * i + 1] = g;
    image.data[4 * i + 2] = b;
    image.data[4 * i + 3] = grid[i] > 0 ? 215 * Math.log1p(grid[i] / unit) / top : 0;
  }
  const small = make('canvas', { width: w, height: h });
  small.getContext('2d').putImageData(image, 0, 0);
  pen.imageSmoothingEnabled = true;
  pen.drawImage(small, -step / 2, -step / 2, w * step, h * step);
}

/// The parts of a colour of the style sheet, "#rrggbb".
const rgb = colour => [1, 3, 5].map(i => parseInt(colour.slice(i, i + 2), 16));

function drawProposals(level, p) {
  if (state.show === 'density') { drawDensity(level, p); return; }
  if (state.show === 'points') { drawPoints(level, p); return; }
  const groups = new Map();
  for (let i = 0; i < p; i++) {
    const kind = level.station(i);
    const key = (state.colour === 'source' ? kind + ':' + level.source[i] : kind) + (frame.hides(frame.at(level.proposals.row(i), level)) ? ':hidden' : '');
    if (!groups.has(key)) groups.set(key, []);
    groups.get(key).push(i);
  }
  const r = p > 4000 ? 1.6 : 2.6;
  for (const [key, list] of groups) {
    const hidden = key.endsWith(':hidden'), [kind, source] = key.replace(/:hidden$/, '').split(':');
    pen.beginPath();
    for (const i of list) {
      const [x, y] = frame.at(level.proposals.row(i), level);
      marker(kind, x, y, r);
    }
    pen.strokeStyle = pen.fillStyle = source === undefined ? colours[kind] : sourceColour(Number(source));
    pen.lineWidth = 1.2;
    pen.globalAlpha = hidden ? 0.2 : 0.9;
    if (kind === 'reached') pen.fill(); else pen.stroke();
  }
  pen.globalAlpha = 1;
}

/// Proposals as faint points, below the tree.
function drawPoints(level, p) {
  const side = p > 20000 ? 0.7 : 1.1, every = Math.max(1, Math.floor(p / 60000));
  pen.fillStyle = levelColour(level);
  pen.globalAlpha = p > 5000 ? 0.25 : 0.4;
  for (let i = 0; i < p; i += every) {
    const at = frame.at(level.proposals.row(i), level);
    if (!frame.hides(at)) pen.fillRect(at[0] - side / 2, at[1] - side / 2, side, side);
  }
  pen.globalAlpha = 1;
}

function drawPath(level, path, width) {
  const [seen, hidden] = polyline(path, level);
  pen.lineJoin = pen.lineCap = 'round';
  pen.strokeStyle = colours.free;
  pen.lineWidth = width + 2.5;
  pen.globalAlpha = 0.8;
  pen.stroke(seen);
  pen.strokeStyle = levelColour(level);
  pen.lineWidth = width;
  pen.setLineDash(levelDash(level));
  pen.globalAlpha = 0.35;
  pen.stroke(hidden);
  pen.globalAlpha = 1;
  pen.stroke(seen);
  pen.setLineDash([]);
}

/// The path of a level as it stands now; the root's, in the end, as it was reported.
function pathNow(level) {
  if (level.number === 0 && state.at >= run.total && run.path) return run.path;
  const found = level.paths.filter(p => p.time <= state.at).pop();
  return found ? found.rows : null;
}

function drawSelected() {
  const s = state.select;
  if (!s) return;
  const level = run.levels[s.level];
  const q = sampleRow(s);
  for (const trace of level.traces) drawSelectedTrace(s, trace, q);
  drawRobot(level.robot, level.own(q), { stroke: colours.ink, fill: levelColour(level), fillAlpha: 0.35, width: 1.6 });
}

/// The motions that lead to a selected sample, of one robot.
function drawSelectedTrace(s, level, q) {
  const point = row => frame.at(row, level).slice(0, 2);
  const [x, y] = point(q);
  let node = s.role === 'tree' ? s.index : level.near[s.index];
  pen.strokeStyle = colours.ink;
  pen.lineWidth = 2;
  if (s.role === 'expansion' && node >= 0) {
    const [nx, ny] = point(level.nodes.row(node));
    pen.setLineDash([3, 3]);
    pen.beginPath(); pen.moveTo(nx, ny); pen.lineTo(x, y); pen.stroke();
    pen.setLineDash([]);
  }
  if (level.parents && node >= 0) {
    pen.beginPath();
    pen.moveTo(...point(level.nodes.row(node)));
    for (let steps = 0; level.parents[node] !== node && steps < 1e6; steps++) {
      node = level.parents[node];
      pen.lineTo(...point(level.nodes.row(node)));
    }
    pen.stroke();
  }
  pen.beginPath();
  pen.arc(x, y, 6.5, 0, 2 * Math.PI);
  pen.strokeStyle = colours.paper; pen.lineWidth = 4; pen.stroke();
  pen.strokeStyle = colours.ink; pen.lineWidth = 2; pen.stroke();
}

function drawNewest() {
  if (!run || state.at === 0 || state.at >= run.total) return;
  for (const level of run.levels.flatMap(l => l.traces)) {
    const p = until(level.proposalTime, state.at) - 1;
    if (p < 0 || level.proposalTime[p] !== state.at) continue;
    const [x, y] = frame.at(level.proposals.row(p), level);
    pen.strokeStyle = levelColour(level);
    pen.lineWidth = 1.5;
    if (level.near[p] >= 0) {
      const from = level.nodes.row(level.near[p]);
      pen.setLineDash([3, 3]);
      pen.beginPath(); pen.moveTo(...frame.at(from, level).slice(0, 2)); pen.lineTo(x, y); pen.stroke();
      pen.setLineDash([]);
    }
    pen.beginPath(); pen.arc(x, y, 5.5, 0, 2 * Math.PI); pen.stroke();
  }
}

/// The outline of the obstacles' union: none between obstacles that touch. Drawn again over what lies on the obstacles.
function drawOutline(problem) {
  if (!canvas.width || !canvas.height) return;
  const own = document.createElement('canvas'), main = pen;
  [own.width, own.height] = [canvas.width, canvas.height];
  pen = own.getContext('2d');
  pen.setTransform(frame.ratio, 0, 0, frame.ratio, 0, 0);
  pen.beginPath();
  for (const shape of problem.obstacles) shapePath(shape);
  pen.strokeStyle = colours['obstacle-edge'];
  pen.lineWidth = 2;
  pen.stroke();
  pen.globalCompositeOperation = 'destination-out';
  pen.fill();
  pen = main;
  pen.save();
  pen.setTransform(1, 0, 0, 1, 0, 0);
  pen.drawImage(own, 0, 0);
  pen.restore();
}

/// Draws within the bounds of the plane.
function inPlane(b, body) {
  pen.save();
  pen.beginPath();
  pen.rect(frame.X(b[0]) - 1, frame.Y(b[3]) - 1, (b[2] - b[0]) * frame.scale + 2, (b[3] - b[1]) * frame.scale + 2);
  pen.clip();
  body();
  pen.restore();
}

/// The free plane and its obstacles.
function drawPlane(problem, b) {
  pen.fillStyle = colours.free;
  pen.fillRect(frame.X(b[0]), frame.Y(b[3]), (b[2] - b[0]) * frame.scale, (b[3] - b[1]) * frame.scale);
  inPlane(b, () => {
    pen.beginPath();
    for (const shape of problem.obstacles) shapePath(shape);
    pen.fillStyle = colours.obstacle;
    pen.fill();
    drawOutline(problem);
  });
  pen.strokeStyle = colours['obstacle-edge'];
  pen.lineWidth = 1;
  pen.strokeRect(frame.X(b[0]), frame.Y(b[3]), (b[2] - b[0]) * frame.scale, (b[3] - b[1]) * frame.scale);
}

/// The robots of space that are drawn as solids: at the start, at the place on the path, and at the selected sample.
function solidRobots(problem, robot) {
  const list = robot ? [[robot, problem.start, colours.ends]] : [], root = run && run.levels[0];
  if (robot && state.along !== null && run && run.path && root) list.push([robot, onPath(run.path, root, state.along / 1000), levelColour(root)]);
  if (state.select && run) {
    const level = run.levels[state.select.level];
    if (level.robot) list.push([level.robot, sampleRow(state.select), levelColour(level)]);
  }
  return list.filter(([one, q]) => q.length >= one.dimension);
}

function drawRun() {
  frame = fitCanvas();
  if (!frame) return;
  pen.setTransform(frame.ratio, 0, 0, frame.ratio, 0, 0);
  pen.lineCap = 'butt';
  pen.lineJoin = 'miter';
  pen.clearRect(0, 0, frame.width, frame.height);
  const problem = data.problems[state.scene], b = frame.b;
  const robot = data.robots[problem.robot] || null;
  if (frame.space) {
    drawBox(false);
    drawSolids(problem, solidRobots(problem, robot));
    drawBox(true);
  } else {
    drawPlane(problem, b);
  }

  const now = view();
  if (run) {
    const deepest = [...run.levels].reverse();
    const each = (role, f) => { for (const level of deepest) if (shown(level, role)) for (const trace of level.traces) f(trace); };
    const drawTrees = () => each('tree', trace => drawTree(trace, now[trace.number].n));
    const drawAllProposals = () => each('expansion', trace => drawProposals(trace, now[trace.number].p));
    // Draw samples above the trees that they created, and a density below them.
    if (state.show === 'samples') { drawTrees(); drawAllProposals(); } else { drawAllProposals(); if (!frame.space) inPlane(b, () => drawOutline(problem)); drawTrees(); }
    for (const level of deepest) {
      const path = shown(level, 'path') && pathNow(level);
      if (!path || !path.size) continue;
      for (const trace of level.traces) drawPath(trace, path, level.number === 0 ? 2.6 : 1.8);
      if (level.number === 0 && !team()) {
        const every = Math.max(1, Math.floor(path.size / (frame.space ? 12 : 40)));
        if (state.along === null) for (let i = 0; i < path.size; i += every) drawRobot(robot, path.row(i), { stroke: levelColour(level), alpha: 0.4, width: 1 });
      }
    }
    const root = run.levels[0];
    if (root && !root.drawn && state.at >= run.total && run.path && state.along === null) {
      for (let i = 0; i < run.path.size; i++) drawRobot(robot, run.path.row(i), { stroke: levelColour(root), alpha: 0.5 });
    }
  }
  pen.font = '600 12px system-ui, sans-serif';
  pen.textBaseline = 'bottom';
  // As in the figures: the start is filled, a goal is an outline.
  const goals = problem.goals.map((q, i) => [q, problem.goals.length > 1 ? 'goal ' + (i + 1) : 'goal', null]);
  for (const [q, name, fill] of [...goals, [problem.start, 'start', colours.ends]]) {
    if (team() && (!frame.space || robot && robot.columns)) { drawTeamEnd(problem, robot, q, fill); continue; }
    const tip = frame.space && robot && robot.bodies;
    if (!drawRobot(robot, q, { stroke: colours.ends, fill, fillAlpha: 0.55, width: 1.6 }) && problem.position.length < 2) continue;
    const [x, y] = tip ? frame.project(...tipOf(robot, q)) : problem.position.length >= 2 ? frame.at(q, { x: problem.position[0], y: problem.position[1], z: problem.position[2] })
                                                : [frame.X(robot ? robot.base[0] : 0), frame.Y(robot ? robot.base[1] : 0)];
    if (problem.position.length < 2 && !fill && !tip) continue;
    pen.beginPath(); pen.arc(x, y, 3, 0, 7);
    pen.fillStyle = fill || colours.free; pen.fill();
    pen.strokeStyle = colours.ends; pen.lineWidth = 1.5; pen.stroke();
    const label = problem.position.length < 2 && !tip ? 'base' : name;
    const reach = robot && !tip ? Math.max(6, Math.min(40, robot.radius * frame.scale)) : 6;
    const tx = Math.min(frame.width - 36, Math.max(4, x - 12)), ty = y - reach - 2 < 16 ? y + reach + 18 : y - reach - 2;
    pen.lineWidth = 3; pen.strokeStyle = colours.free; pen.lineJoin = 'round'; pen.strokeText(label, tx, ty);
    pen.fillStyle = colours.ends; pen.fillText(label, tx, ty);
  }
  if (run) { drawDriven(robot); drawNewest(); drawSelected(); }
}

/// A team at the start, filled, or at a goal, an outline.
function drawTeamEnd(problem, robot, q, fill) {
  drawRobot(robot, q, { stroke: colours.ends, fill, fillAlpha: state.along === null ? 0.75 : 0.2, width: 1.8 });
  if (fill && state.along === null) drawNumbers(problem, q);
}

/// The numbers of the robots of a team where they are.
function drawNumbers(problem, q) {
  pen.font = '600 11px system-ui, sans-serif';
  pen.textAlign = 'center';
  pen.textBaseline = 'middle';
  for (const trace of problem.traces.map(t => traceOf({}, t))) {
    const [x, y] = frame.at(q, trace), text = String(team()[trace.member].number);
    pen.lineWidth = 2; pen.strokeStyle = levelColour(trace); pen.lineJoin = 'round'; pen.strokeText(text, x, y);
    pen.fillStyle = '#ffffff'; pen.fillText(text, x, y);
  }
  pen.textAlign = 'left';
  pen.textBaseline = 'bottom';
}

/// The robot at its place on the path: the configuration at a share of the path's length in the root's metric.
function drawDriven(robot) {
  const root = run.levels[0];
  if (state.along === null || !run.path || !root) return;
  const q = onPath(run.path, root, state.along / 1000);
  const solid = drawRobot(robot, q, { stroke: colours.ink, fill: levelColour(root), fillAlpha: 0.75, width: 1.8 });
  if (team() && (!frame.space || robot && robot.columns)) drawNumbers(data.problems[state.scene], q);
  if (solid || root.traces[0] !== root) return;
  pen.beginPath();
  pen.arc(...frame.at(q, root).slice(0, 2), 6, 0, 7);
  pen.fillStyle = levelColour(root);
  pen.fill();
  pen.strokeStyle = colours.ink;
  pen.lineWidth = 1.8;
  pen.stroke();
}

/// b - a, within half a period on a periodic axis.
const difference = (axis, a, b) => {
  const period = axis.hi - axis.lo;
  return axis.periodic ? b - a - period * Math.round((b - a) / period) : b - a;
};

/// The time of a straight motion: its length in a level's metric; in the whole team's, that of the robot with the
/// longest motion.
function duration(level, a, b) {
  if (!team() || level.number !== 0) return distance(level, a, b);
  return Math.max(...team().map(({ axes }) => distance(level, a, b, axes)));
}

/// The length of a straight motion in a level's metric, of some of its axes.
function distance(level, a, b, axes = level.axes.map((_, j) => j)) {
  let sum = 0;
  level.axes.forEach((axis, j) => {
    if (!axes.includes(j)) return;
    const first = level.rotations.find(r => j >= r && j < r + 4);
    if (first === undefined) sum += (axis.weight * difference(axis, a[j], b[j])) ** 2;
    else if (first === j) sum += (axis.weight * space3.angle(space3.unit([...a.slice(j, j + 4)]), space3.unit([...b.slice(j, j + 4)]))) ** 2;
  });
  return Math.sqrt(sum);
}

function onPath(path, level, share) {
  const lengths = [0];
  for (let i = 1; i < path.size; i++) lengths.push(lengths[i - 1] + duration(level, path.row(i - 1), path.row(i)));
  const at = share * lengths[path.size - 1], end = Math.min(path.size - 1, Math.max(1, until(lengths, at)));
  if (path.size < 2) return path.row(0);
  const piece = lengths[end] - lengths[end - 1];
  return between(level, path.row(end - 1), path.row(end), piece > 0 ? Math.min(1, (at - lengths[end - 1]) / piece) : 0);
}

/// A configuration on the straight motion from a to b.
function between(level, a, b, t) {
  const q = level.axes.map((axis, j) => a[j] + t * difference(axis, a[j], b[j]));
  for (const r of level.rotations) {
    q.splice(r, 4, ...space3.slerp(space3.unit([...a.slice(r, r + 4)]), space3.unit([...b.slice(r, r + 4)]), t));
  }
  return q;
}

/// Draws the run beside: what draws goes by the run, the canvas and its frame, and nothing of it is selected.
function drawBeside() {
  const plotBeside = $('plot-beside'), two = state.beside >= 0;
  document.querySelector('.plots').classList.toggle('two', two);
  plotBeside.hidden = !two;
  if (!two) return;
  const kept = [run, canvas, pen, plot, frame, state.select];
  [run, canvas, plot, state.select] = [other, $('canvas-beside'), plotBeside, null];
  pen = canvas.getContext('2d');
  try {
    drawRun();
  } finally {
    [run, canvas, pen, plot, frame, state.select] = kept;
  }
}

/// Draws a panel for each level with positions, the guide on the left and the root on the right: its tree, its
/// proposals as faint points, and its path. What draws goes by the canvas and its frame.
function drawPanels() {
  const box = $('panels');
  box.replaceChildren();
  if (!run) return;
  const kept = [canvas, pen, plot, frame, zoom, { ...state }];
  const levels = [...run.levels].reverse().filter(level => level.drawn && (level.nodes.size || level.proposals.size || level.paths.length));
  // All before the first is drawn, so that they have their widths.
  const pictures = levels.map((level, i) => {
    const raw = level.raw, searches = raw.solves > 1 ? raw.solves + ' searches' : '';
    const facts = [raw.space.replace('R^2', 'R²').replace('R^3', 'R³'), count(raw.all[1], 'node'), count(raw.all[0], 'proposal'), searches];
    const picture = make('canvas', { title: 'inspect the samples of this level' });
    picture.setAttribute('role', 'img');
    picture.setAttribute('aria-label', 'the search of ' + level.name + ' in the scene');
    picture.onclick = () => { state.layers = new Set(roles.map(role => level.number + ':' + role)); openRuns(); refresh(); };
    box.append(make('figure', null, make('figcaption', null, make('b', { textContent: (i ? '>> ' : '') + (level.number === 0 ? raw.planner : level.name) }), make('small', { textContent: facts.filter(f => f).join(', ') })), picture));
    return picture;
  });
  levels.forEach((level, i) => {
    [canvas, pen, plot, zoom] = [pictures[i], pictures[i].getContext('2d'), pictures[i].parentElement, { k: 1, x: 0, y: 0 }];
    Object.assign(state, { layers: new Set(roles.map(role => level.number + ':' + role)), show: 'points', select: null, along: null, at: run.total, view: null });
    try {
      drawRun();
    } finally {
      [canvas, pen, plot, frame, zoom] = kept;
      Object.assign(state, kept[5]);
    }
  });
}

/// Of a team whose path has times: when each robot moves, and the smallest distance between two.
function drawSchedule() {
  const to = $('schedule'), entry = cell().runs[state.seed], root = run && run.levels[0], robot = root && root.robot;
  const at = entry && entry.at, path = run && run.path;
  to.replaceChildren();
  if (!team() || !at || !path || !robot || path.size !== at.length || !(at[at.length - 1] > 0)) return;
  const members = team(), row = i => path.row(i);
  const lanes = members.map(({ number, colour, axes }) => ({ name: 'robot ' + number, colour,
    speeds: at.slice(1).map((t, i) => t > at[i] ? distance(root, row(i), row(i + 1), axes) / (t - at[i]) : 0) }));
  const moments = [...Array(241).keys()].map(i => i * at[at.length - 1] / 240).concat(at).sort((a, b) => a - b);
  const gaps = moments.map(t => {
    const i = Math.min(at.length - 1, Math.max(1, until(at, t))), span = at[i] - at[i - 1];
    return [t, teams.gap(memberParts(robot, between(root, row(i - 1), row(i), span > 0 ? Math.min(1, (t - at[i - 1]) / span) : 0)))];
  });
  teams.schedule(to, at, lanes, gaps, Math.min(720, to.clientWidth));
}

/// The robot of a team that each body of a robot of space belongs to; -1: none.
function bodyMembers(robot) {
  if (robot.members3) return robot.members3;
  const of = column => team().findIndex(m => m.axes.includes(column));
  if (robot.columns) return (robot.members3 = robot.columns.map(([column]) => of(column)));
  const found = robot.bodies.map(body => of(body.column));
  robot.bodies.forEach((body, i) => { if (found[i] < 0 && body.parent >= 0) found[i] = found[body.parent]; });
  // A fixed base belongs to the robot that it carries.
  for (let i = found.length - 1; i > 0; i--) {
    const above = robot.bodies[i].parent, own = robot.bodies.filter((_, k) => k > 0 && robot.bodies[k].parent === above).length === 1;
    if (above >= 0 && found[above] < 0 && own) found[above] = found[i];
  }
  return (robot.members3 = found);
}

/// The convex parts of a team's robots at a configuration.
function memberParts(robot, q) {
  if (robot.kind === 'planar' || !robot.surfaces) {
    const at = poses(robot, q);
    return robot.bodies.flatMap((body, i) => body.parts.map(part => {
      const points = [], disc = part.length === 3;
      for (let k = 0; k + 1 < part.length; k += 2) points.push([at[i].x + at[i].c * part[k] - at[i].s * part[k + 1], at[i].y + at[i].s * part[k] + at[i].c * part[k + 1], 0]);
      return { member: body.robot, points, radius: disc ? part[2] : 0 };
    }));
  }
  const at = posesOf(robot, q), members = bodyMembers(robot);
  return partsOf(robot.surfaces).flatMap((part, i) => {
    if (members[i] < 0 || !part.vertices.length) return [];
    part.pieces = part.pieces || teams.pieces(part.vertices, part.triangles);
    return part.pieces.map(piece => ({ member: members[i], points: piece.map(p => space3.placed(at[i], p)), radius: 0 }));
  });
}

function openRuns() {
  if ($('fold-runs').open) return;
  $('fold-runs').open = true;
  $('fold-runs').scrollIntoView({ block: 'start' });
}

/// The picture of the run is drawn where it is seen.
function draw() {
  if (!$('fold-runs').open) return;
  drawBeside();
  drawRun();
}

// Words ----------------------------------------------------------------------------------------------------------------

const sampleRow = s => (s.role === 'tree' ? run.levels[s.level].nodes : run.levels[s.level].proposals).row(s.index);
const count = (n, word) => n + ' ' + word + (n === 1 ? '' : 's');

/// The number of decimals that the 16 bits of a coordinate represent.
function coordinate(axis, value) {
  const digits = Math.max(0, Math.min(6, Math.floor(-Math.log10((axis.hi - axis.lo) / 65535))));
  const text = value.toFixed(digits).replace(/^-(0(\.0+)?)$/, '$1').replace('-', '−');
  return axis.periodic ? text + ' rad (' + (value * 180 / Math.PI).toFixed(0).replace('-', '−') + '°)' : text;
}

/// A rotation as an angle about an axis.
function turnText(q) {
  const sign = q[3] < 0 ? -1 : 1, sin = Math.hypot(q[0], q[1], q[2]), degrees = 2 * Math.atan2(sin, Math.abs(q[3])) * 180 / Math.PI;
  const axis = [0, 1, 2].map(k => (sin > 1e-6 ? sign * q[k] / sin : 0).toFixed(2).replace(/^-(0\.00)$/, '$1').replace('-', '−'));
  return degrees.toFixed(0) + '°' + (sin > 1e-6 ? ' about (' + axis.join(', ') + ')' : '');
}

const levelTitle = level => 'level ' + level.number + ' · ' + level.name;

function stationOf(level, s) {
  const proposal = s.role === 'expansion' ? s.index : level.cause[s.index];
  return proposal < 0 ? '' : level.station(proposal);
}

function tipText(s) {
  const level = run.levels[s.level];
  if (s.role === 'tree') return level.name + ' · node ' + s.index;
  return level.name + ' · proposal ' + s.index + ' · ' + short[level.station(s.index)];
}

function showSample() {
  const box = $('sample');
  box.replaceChildren();
  const set = fields => { for (const [name, value] of Object.entries(fields)) { if (value === '' || value === null || value === undefined) delete viewer.dataset[name]; else viewer.dataset[name] = value; } };
  const none = { select: '', fate: '', station: '', source: '', near: '', sampleLevel: '', cause: '' };
  if (!run) { set(none); return; }
  const s = state.select;
  if (!s) {
    set(none);
    box.append(make('p', { className: 'muted', textContent: 'Click a node or a proposal in the picture to see where it came from; or ' }));
    const form = make('div', { className: 'ways' });
    for (const level of run.levels) {
      if (level.nodes.size) form.append(make('button', { type: 'button', textContent: 'first node of ' + level.name, onclick: () => setSelect({ level: level.number, role: 'tree', index: 0 }) }));
      else if (level.proposals.size) form.append(make('button', { type: 'button', textContent: 'first proposal of ' + level.name, onclick: () => setSelect({ level: level.number, role: 'expansion', index: 0 }) }));
    }
    box.append(form);
    return;
  }
  const level = run.levels[s.level], q = sampleRow(s);
  const proposal = s.role === 'expansion' ? s.index : level.cause[s.index];
  const list = make('dl');
  const line = (term, ...what) => list.append(make('dt', { textContent: term }), make('dd', null, ...what));
  const go = (text, target) => make('button', { type: 'button', className: 'link', textContent: text, onclick: () => setSelect(target) });
  const node = index => go('node ' + index, { level: s.level, role: 'tree', index });
  line('sample', (s.role === 'tree' ? 'node ' : 'proposal ') + s.index + ' of ' + (s.role === 'tree' ? level.nodes : level.proposals).size);
  line('level', make('span', { className: 'swatch', style: 'background:' + listColour(level) }), levelTitle(level), ', ' + level.raw.space + ', ' + level.raw.planner);
  let source = '';
  if (proposal >= 0) {
    source = level.raw.sources[level.source[proposal]] || '';
    const guide = level.guides[level.source[proposal]];
    if (s.role === 'tree') line('came of', go('proposal ' + proposal, { level: s.level, role: 'expansion', index: proposal }), level.direct[s.index] ? '' : ', in growing on after it');
    if (source) line('h that drew it', source + (guide ? ' (level ' + guide.number + ')' : ''));
  } else if (s.role === 'tree') {
    const root = level.parents && level.parents[s.index] === s.index;
    line('came of', root ? 'a tree’s root: planted when a solve began' : level.proposals.size ? 'no proposal: the start, or the goal' : 'the graph that is searched: this level draws no proposals');
  }
  if (s.role === 'expansion') {
    line('became of it', stations[level.station(s.index)] + (level.fate(s.index) === 'advanced' && level.invalid(s.index) ? '; the proposal itself is invalid' : ''));
    if (level.added[s.index] >= 0) line('added', node(level.added[s.index]));
    if (level.near[s.index] >= 0) line('grew from', node(level.near[s.index]));
  } else {
    if (level.parents && level.parents[s.index] !== s.index) line('parent', node(level.parents[s.index]));
    if (level.classes) line('in the roadmap', data.classes[level.classes[s.index]] || '');
  }
  level.axes.forEach((axis, i) => {
    const first = level.rotations.find(r => i >= r && i < r + 4);
    if (first === undefined) line(axis.name, coordinate(axis, q[i]));
    else if (first === i) line(axis.name.replace(/\.x$/, ''), turnText(space3.unit([...q.slice(i, i + 4)])));
  });
  const time = (s.role === 'tree' ? level.nodeTime : level.proposalTime)[s.index];
  line('step', String(time) + ' of ' + run.total);
  box.append(list);
  const ways = make('div', { className: 'ways' });
  const step = by => ({ level: s.level, role: s.role, index: s.index + by });
  const button = (text, onclick, disabled) => ways.append(make('button', { type: 'button', textContent: text, onclick, disabled: !!disabled }));
  button('‹ before', () => setSelect(step(-1)), s.index === 0);
  button('after ›', () => setSelect(step(1)), s.index + 1 >= (s.role === 'tree' ? level.nodes : level.proposals).size);
  button('replay to here', () => { state.at = time; refresh(); });
  button('let go', () => setSelect(null));
  box.append(ways);
  set({ select: selectText(), fate: proposal >= 0 ? level.fate(proposal) : '', station: stationOf(level, s), source, near: proposal >= 0 ? level.near[proposal] : '', sampleLevel: level.name, cause: proposal >= 0 ? proposal : '' });
}

// The panels -------------------------------------------------------------------------------------------------------------

/// The share of a long search that this file contains.
function heldText(level) {
  const [proposals, nodes] = level.raw.all, held = [];
  if (level.proposals.size < proposals) held.push(level.proposals.size + ' of ' + count(proposals, 'proposal'));
  if (level.nodes.size < nodes) held.push(level.nodes.size + ' of ' + count(nodes, 'node'));
  return held.length ? '; this file holds ' + held.join(', ') : '';
}

let levelCells = [];

function showLevels() {
  const table = $('levels');
  table.replaceChildren();
  levelCells = [];
  if (!run) return;
  const head = make('tr', null, make('th', { scope: 'col', textContent: '' }));
  for (const name of ['tree', 'proposals', 'path']) head.append(make('th', { scope: 'col', textContent: name }));
  table.append(make('thead', null, head));
  const body = make('tbody');
  for (const level of run.levels) {
    const row = make('tr'), name = make('td', { className: 'name' });
    name.style.paddingLeft = (0.3 + 0.8 * level.raw.depth) + 'em';
    name.append(make('span', { className: 'swatch', style: 'background:' + listColour(level) }), level.name,
                make('small', { title: level.drawn ? '' : 'no position', textContent: level.raw.space + ', ' + level.raw.planner + (level.raw.solves > 1 ? ', ' + level.raw.solves + ' solves' : '') + (level.drawn ? '' : '; not drawn: no position') + heldText(level) }));
    row.append(name);
    const cells = { row };
    for (const role of roles) {
      const has = role === 'tree' ? level.nodes.size : role === 'expansion' ? level.proposals.size : level.paths.length + (level.number === 0 && run.path ? 1 : 0);
      const td = make('td');
      const text = make('span');
      cells[role] = text;
      if (has && level.drawn) {
        const box = make('input', { type: 'checkbox', checked: shown(level, role) });
        box.setAttribute('aria-label', level.name + ': ' + (role === 'expansion' ? 'proposals' : role));
        box.dataset.layer = level.number + ':' + role;
        box.onchange = () => {
          const on = new Set(layers());
          if (box.checked) on.add(box.dataset.layer); else on.delete(box.dataset.layer);
          state.layers = on;
          refresh();
        };
        td.append(make('label', null, text, box));
      } else {
        td.append(text);
      }
      row.append(td);
    }
    levelCells.push(cells);
    body.append(row);
  }
  table.append(body);
}

function updateLevels(now) {
  if (!run) return;
  run.levels.forEach((level, i) => {
    const cells = levelCells[i];
    if (!cells) return;
    const part = (n, of) => of ? (n < of ? n + '/' + of : String(of)) : '–';
    cells.tree.textContent = part(now[i].n, level.nodes.size);
    cells.expansion.textContent = part(now[i].p, level.proposals.size);
    cells.path.textContent = pathNow(level) ? '' : level.paths.length ? '…' : '–';
    cells.row.classList.toggle('working', state.at > 0 && state.at < run.total && level.spans.some(s => s.from < state.at && state.at <= s.to));
    for (const box of cells.row.querySelectorAll('input')) box.checked = layers().has(box.dataset.layer);
  });
}

function icon(kind, colour) {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', '0 0 14 14');
  svg.setAttribute('aria-hidden', 'true');
  const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
  path.setAttribute('d', { reached: 'M3 7a4 4 0 1 0 8 0a4 4 0 1 0 -8 0', advanced: 'M3 7a4 4 0 1 0 8 0a4 4 0 1 0 -8 0', trapped: 'M7 2L12 7L7 12L2 7Z' }[kind] || 'M3 3L11 11M3 11L11 3');
  path.setAttribute('fill', kind === 'reached' ? colour : 'none');
  path.setAttribute('stroke', colour);
  path.setAttribute('stroke-width', '1.8');
  svg.append(path);
  return svg;
}

function showLegend(now) {
  const list = $('legend');
  list.replaceChildren();
  if (!run) return;
  const seen = new Map();
  run.levels.forEach((level, i) => {
    if (!shown(level, 'expansion')) return;
    for (let p = 0; p < now[i].p; p++) {
      const key = state.colour === 'fate' ? level.station(p) : String(level.source[p]) + ' ' + (level.raw.sources[level.source[p]] || '?');
      seen.set(key, (seen.get(key) || 0) + 1);
    }
  });
  if (!seen.size) { list.append(make('li', { className: 'muted', textContent: run.levels.some(l => shown(l, 'expansion')) ? 'none yet' : 'none shown: tick “proposals” of a level' })); return; }
  const keys = state.colour === 'fate' ? Object.keys(stations).filter(k => seen.has(k)) : [...seen.keys()].sort((a, b) => parseInt(a, 10) - parseInt(b, 10));
  for (const key of keys) {
    const at = key.indexOf(' ');
    const mark = state.colour === 'fate' ? icon(key, colours[key]) : icon('reached', sourceColour(parseInt(key, 10)));
    list.append(make('li', null, mark, make('span', { textContent: state.colour === 'fate' ? stations[key] : key.slice(at + 1) }), make('b', { textContent: seen.get(key) })));
  }
  if (state.show === 'density') list.append(make('li', { className: 'muted', textContent: 'The picture shows their density: the darker, the more of them, in logarithms.' }));
  else if (state.colour === 'source') list.append(make('li', { className: 'muted', textContent: 'shapes: ● reached, ○ advanced, ◇ rejected though valid, × rejected' }));
}

function showNow(now) {
  const slider = $('at');
  slider.max = last();
  slider.disabled = last() === 0;
  slider.value = state.at;
  if (!run) { $('now').textContent = ''; return; }
  let text = 'step ' + state.at + ' of ' + last();
  for (const level of run.levels) {
    const span = level.spans.find(s => s.from < state.at && state.at <= s.to);
    if (span && state.at < run.total) text += ' · at work: ' + levelTitle(level) + (level.raw.solves > 1 ? ', solve ' + (span.solve + 1) + ' of ' + level.raw.solves : '');
  }
  if (state.at >= run.total) text += state.at < last() ? ' · the run on the left is over' : ' · over';
  $('now').textContent = text;
  slider.setAttribute('aria-valuetext', text);
  viewer.dataset.at = state.at;
  viewer.dataset.total = run.total;
  viewer.dataset.nodes = now.map(t => t.n).join(',');
  viewer.dataset.proposals = now.map(t => t.p).join(',');
}

/// Everything that depends on the step, the selection and the layers.
function refresh(light) {
  const now = view();
  draw();
  updateLevels(now);
  showNow(now);
  if (!light || run && run.total < 20000) showLegend(now);
  if (!light) { showSample(); writeHash(); }
  viewer.dataset.layers = [...layers()].sort().join(',');
  viewer.dataset.show = state.show;
  viewer.dataset.along = state.along === null ? '' : state.along;
  $('along').value = state.along === null ? 0 : state.along;
  $('along').disabled = $('drive').disabled = !(run && run.path) && !(other && other.path);
}

/// Everything that depends on the scene, the method and the seed.
function load(fresh = true) {
  stop();
  const c = cell();
  const entry = c.runs[state.seed] || { id: -1, text: 'no such run' };
  run = loadRun(entry.id);
  hover = null;
  $('tip').hidden = true;
  if (fresh) { state.select = null; state.layers = null; state.along = null; }
  const beside = state.beside >= 0 ? data.cells[state.scene][state.beside].runs[state.seed] : null;
  other = beside ? loadRun(beside.id) : null;
  $('message-beside').textContent = beside && !other ? 'The samples of this run are not in this file.' : '';
  $('message-beside').hidden = !$('message-beside').textContent;
  $('caption-beside').textContent = beside ? data.strategies[state.beside].name + ': ' + beside.text : '';
  viewer.dataset.beside = beside ? data.strategies[state.beside].name : '';
  state.at = last();
  zoom = { k: 1, x: 0, y: 0 };
  $('scene').value = state.scene;
  $('method').value = state.method;
  $('seed').value = state.seed;
  $('beside').value = state.beside;
  $('colour').value = state.colour;
  $('show').value = state.show;
  $('text').textContent = data.strategies[state.method].text;
  $('outcome').textContent = entry.text;
  $('panels-heading').textContent = data.strategies[state.method].name + ', seed ' + data.seeds[state.seed];
  const message = $('message');
  const root = run && run.levels[0];
  message.textContent = !run ? 'The samples of this run are not in this file.'
    : root && !root.drawn ? 'The space ' + root.raw.space + ' has no position: its samples are listed, not drawn.' : '';
  message.hidden = !message.textContent;
  $('simplified').textContent = spatial() ? data.worlds[data.problems[state.scene].world].note : '';
  $('simplified').hidden = !$('simplified').textContent;
  if (!run) for (const name of ['at', 'total', 'nodes', 'proposals']) delete viewer.dataset[name];
  viewer.dataset.scene = data.problems[state.scene].name;
  viewer.dataset.method = data.strategies[state.method].name;
  viewer.dataset.seed = data.seeds[state.seed];
  viewer.dataset.outcome = entry.text;
  for (const row of document.querySelectorAll('#summary tr[data-cell]')) row.classList.toggle('chosen', row.dataset.cell === state.scene + '-' + state.method);
  const total = last(), speeds = [2, 10, 50, 200, 1000, 5000];
  $('speed').value = speeds.find(s => s * 12 >= total) || 5000;
  readColours();
  showLevels();
  showWorth();
  drawPanels();
  drawSchedule();
  if (fresh) refresh();
}

function showWorth() {
  const where = state.scene + '-' + state.method, worth = $('worth');
  worth.replaceChildren();
  const table = $('levels-' + where);
  if (table) worth.append(table.content.cloneNode(true));
  showCosts();
}

/// Draws the costs of the scene's runs, as wide as the page shows them.
function showCosts() {
  const strategies = read('costs-' + state.scene) || [], to = $('compared');
  $('fold-costs').hidden = !strategies.length;
  if (!strategies.length || !$('fold-costs').open) return;
  const whole = to.clientWidth, each = whole > 900 ? (whole - 32) / 2 : whole;
  charts.costs(to, strategies, Number($('cost').value), Math.floor(each) - 16);
}

// Tables ------------------------------------------------------------------------------------------------------------------

/// Makes the headings of a table sort its rows: once ascending, then descending, then as they were. Rows stay in their
/// group, and what is no number comes last.
function makeSortable(table) {
  const columns = [];  // the lowest heading over each column
  [...table.tHead.rows].forEach((row, r) => {
    let column = 0;
    for (const th of row.cells) {
      while (columns[column] && columns[column].until > r) column++;
      for (let i = 0; i < th.colSpan; i++) columns[column + i] = { th, until: r + th.rowSpan, own: th.colSpan === 1 };
      column += th.colSpan;
    }
  });
  const groups = [];  // {head, rows}
  for (const row of table.tBodies[0].rows) {
    if (row.classList.contains('group')) groups.push({ head: row, rows: [] });
    else { if (!groups.length) groups.push({ head: null, rows: [] }); groups[groups.length - 1].rows.push(row); }
  }
  const value = (row, column) => {
    const text = row.cells[column].textContent.trim();
    return column === 0 ? text : text.startsWith('inf') ? Infinity : parseFloat(text.replace('−', '-'));
  };
  // Cells without a figure come last in either direction; the cost of what is unsolved is infinite, and equal to itself.
  const compare = (a, b, sign) => {
    if (typeof a === 'string') return sign * a.localeCompare(b);
    if (isNaN(a) || isNaN(b)) return isNaN(a) - isNaN(b);
    return a === b ? 0 : sign * (a < b ? -1 : 1);
  };
  columns.forEach(({ th, own }, column) => {
    if (!own) return;
    const button = make('button', { type: 'button', className: 'sort', title: 'sort by this column' }, ...th.childNodes);
    th.append(button);
    button.onclick = () => {
      const next = { none: 'ascending', ascending: 'descending', descending: 'none' }[th.getAttribute('aria-sort') || 'none'];
      for (const { th: any } of columns) any.removeAttribute('aria-sort');
      if (next !== 'none') th.setAttribute('aria-sort', next);
      for (const group of groups) {
        const rows = [...group.rows];
        const sign = next === 'ascending' ? 1 : -1;
        if (next !== 'none') rows.sort((a, b) => compare(value(a, column), value(b, column), sign));
        for (const row of rows) table.tBodies[0].append(row);
      }
      // Groups in their order: each head before its rows.
      for (const group of groups) if (group.head) {
        const rows = [...table.tBodies[0].rows].filter(row => group.rows.includes(row));
        table.tBodies[0].append(group.head, ...rows);
      }
    };
  });
}

// Replay ------------------------------------------------------------------------------------------------------------------

let clock = null;
/// Seconds that the robot takes for its path, for every length of the path.
const secondsAlong = 6;
function driveOn(time) {
  if (!driving) return;
  if (clock === null) clock = { time, at: state.along };
  state.along = Math.min(1000, Math.round(clock.at + (time - clock.time) / secondsAlong));
  refresh(true);
  if (state.along >= 1000) { stop(); refresh(); return; }
  requestAnimationFrame(driveOn);
}
function drive() {
  if (!(run && run.path) && !(other && other.path)) return;
  if (driving) { stop(); refresh(); return; }
  stop();
  if (state.along === null || state.along >= 1000) state.along = 0;
  state.at = last();
  driving = true;
  $('drive').textContent = '❚❚';
  requestAnimationFrame(driveOn);
}
function tick(time) {
  if (!playing) return;
  if (clock === null) clock = { time, at: state.at };
  const at = Math.min(last(), Math.floor(clock.at + (time - clock.time) / 1000 * Number($('speed').value)));
  if (at !== state.at) { state.at = at; refresh(true); }
  if (at >= last()) { stop(); refresh(); return; }
  requestAnimationFrame(tick);
}
function stop() {
  playing = driving = false;
  clock = null;
  $('drive').textContent = '▶';
  $('play').textContent = '▶';
  $('play').setAttribute('aria-label', 'play');
}
function play() {
  if (last() === 0) return;
  if (playing) { stop(); refresh(); return; }
  stop();
  state.along = null;
  if (state.at >= last()) state.at = 0;
  playing = true;
  $('play').textContent = '❚❚';
  $('play').setAttribute('aria-label', 'pause');
  requestAnimationFrame(tick);
}
function goTo(at) {
  if (!run) return;
  stop();
  state.along = null;
  state.at = Math.max(0, Math.min(last(), at));
  refresh();
}

// Hands ---------------------------------------------------------------------------------------------------------------------

/// The sample drawn nearest to a point of the canvas, within reach of a finger.
function pick(px, py) {
  if (!run || !frame) return null;
  let best = null, least = 12 * 12;
  const now = view();
  for (const level of run.levels) {
    for (const role of ['expansion', 'tree']) {
      if (!shown(level, role)) continue;
      const list = role === 'tree' ? level.nodes : level.proposals, n = role === 'tree' ? now[level.number].n : now[level.number].p;
      for (const trace of level.traces) {
        for (let i = 0; i < n; i++) {
          const [x, y] = frame.at(list.row(i), trace), d = (x - px) ** 2 + (y - py) ** 2;
          if (d < least) { least = d; best = { level: level.number, role, index: i }; }
        }
      }
    }
  }
  return best;
}

/// Fingers or buttons on the picture, by pointer.
const hands = new Map();
const gripAt = e => ({ x: e.offsetX, y: e.offsetY, zx: zoom.x, zy: zoom.y, view: viewNow(), moved: false });
firstCanvas.addEventListener('pointerdown', e => {
  if (!frame) return;
  hands.set(e.pointerId, [e.offsetX, e.offsetY]);
  grip = gripAt(e);
  if (frame.space && e.isTrusted) firstCanvas.setPointerCapture(e.pointerId);
});
/// Two fingers on a scene of space: their distance zooms, their middle moves the picture.
function pinch(e) {
  const before = [...hands.values()];
  hands.set(e.pointerId, [e.offsetX, e.offsetY]);
  const after = [...hands.values()], middle = pair => [(pair[0][0] + pair[1][0]) / 2, (pair[0][1] + pair[1][1]) / 2];
  const apart = pair => Math.max(1, Math.hypot(pair[0][0] - pair[1][0], pair[0][1] - pair[1][1]));
  const [ax, ay] = middle(before), [bx, by] = middle(after);
  zoom.x -= (bx - ax) / frame.scale;
  zoom.y += (by - ay) / frame.scale;
  grip.moved = true;
  zoomBy(apart(after) / apart(before), bx, by);
}
firstCanvas.addEventListener('pointermove', e => {
  if (grip && frame && frame.space && hands.size === 2 && hands.has(e.pointerId)) { pinch(e); return; }
  if (grip && frame && (e.buttons & 7)) {
    const dx = e.offsetX - grip.x, dy = e.offsetY - grip.y;
    if (Math.hypot(dx, dy) > 4) grip.moved = true;
    if (grip.moved && frame.space && !e.shiftKey && (e.buttons & 1)) {
      state.view = grip.view;
      turnBy(-0.4 * dx, 0.4 * dy);
      return;
    }
    if (grip.moved && (zoom.k > 1 || frame.space)) {
      zoom.x = grip.zx - dx / frame.scale;
      zoom.y = grip.zy + dy / frame.scale;
      draw();
      return;
    }
  }
  const tip = $('tip');
  hover = pick(e.offsetX, e.offsetY);
  tip.hidden = !hover;
  if (!hover) return;
  tip.textContent = tipText(hover);
  const x = Math.min(e.offsetX + 14, $('plot').clientWidth - tip.offsetWidth - 4);
  tip.style.left = Math.max(2, x) + 'px';
  tip.style.top = (e.offsetY > 34 ? e.offsetY - 30 : e.offsetY + 18) + 'px';
});
firstCanvas.addEventListener('pointerleave', () => { $('tip').hidden = true; hover = null; });
firstCanvas.addEventListener('pointerup', e => {
  hands.delete(e.pointerId);
  const clicked = grip && !grip.moved;
  grip = null;
  if (clicked) { stop(); setSelect(pick(e.offsetX, e.offsetY)); }
  else if (frame && frame.space) { draw(); writeHash(); }
});
firstCanvas.addEventListener('pointercancel', e => { hands.delete(e.pointerId); grip = null; draw(); });
firstCanvas.addEventListener('wheel', e => {
  if (!e.ctrlKey && !e.metaKey) return;
  e.preventDefault();
  zoomBy(e.deltaY < 0 ? 1.25 : 0.8, e.offsetX, e.offsetY);
}, { passive: false });

function zoomBy(factor, px, py) {
  if (!frame) return;
  const at = px === undefined ? null : frame.back(px, py);
  zoom.k = Math.min(64, Math.max(frame.space ? 0.5 : 1, zoom.k * factor));
  if (zoom.k === 1 && !frame.space) zoom = { k: 1, x: 0, y: 0 };
  else if (at) {
    frame = fitCanvas();
    const [x, y] = frame.back(px, py);
    zoom.x += at[0] - x;
    zoom.y += at[1] - y;
  }
  draw();
}
const fit = () => { zoom = { k: 1, x: 0, y: 0 }; state.view = null; delete viewer.dataset.view; draw(); writeHash(); };

document.addEventListener('keydown', e => {
  if (e.altKey || e.ctrlKey || e.metaKey) return;
  const on = e.target.tagName, typing = on === 'SELECT' || on === 'INPUT' && e.target.type !== 'range';
  const ranging = on === 'INPUT' && e.target.type === 'range';
  if (typing || (on === 'BUTTON' && (e.key === ' ' || e.key === 'Enter'))) return;
  if (ranging && e.key.startsWith('Arrow') && !e.shiftKey) return;
  const by = e.shiftKey ? 10 : 1, s = state.select;
  const keys = {
    ' ': play, ArrowLeft: () => goTo(state.at - by), ArrowRight: () => goTo(state.at + by), Home: () => goTo(0),
    End: () => run && goTo(last()), Escape: () => { state.along = null; setSelect(null); }, d: drive, '+': () => zoomBy(1.5), '-': () => zoomBy(1 / 1.5), 0: fit,
    j: () => turnBy(-10, 0), l: () => turnBy(10, 0), i: () => turnBy(0, 10), k: () => turnBy(0, -10),
    '[': () => s && s.index > 0 && setSelect({ ...s, index: s.index - 1 }),
    ']': () => s && s.index + 1 < (s.role === 'tree' ? run.levels[s.level].nodes : run.levels[s.level].proposals).size && setSelect({ ...s, index: s.index + 1 }),
  };
  // Home and End scroll the page unless the picture has the focus.
  if ((e.key === 'Home' || e.key === 'End') && document.activeElement !== firstCanvas && !ranging) return;
  const action = keys[e.key];
  if (!action || 'ijkl'.includes(e.key) && !spatial()) return;
  e.preventDefault();
  action();
});

const choose = (field, value) => { if (field === 'scene') state.view = null; state[field] = Number(value); load(); };
$('scene').onchange = e => choose('scene', e.target.value);
$('method').onchange = e => choose('method', e.target.value);
$('seed').onchange = e => choose('seed', e.target.value);
$('seed-back').onclick = () => choose('seed', (state.seed + data.seeds.length - 1) % data.seeds.length);
$('seed-on').onclick = () => choose('seed', (state.seed + 1) % data.seeds.length);
$('beside').onchange = e => choose('beside', e.target.value);
$('show').onchange = e => { state.show = e.target.value; refresh(); };
$('drive').onclick = drive;
$('along').oninput = e => { stop(); state.along = Number(e.target.value); state.at = last(); refresh(true); };
$('along').onchange = () => refresh();
$('colour').onchange = e => { state.colour = e.target.value; refresh(); };
$('play').onclick = play;
$('at').oninput = e => { stop(); state.at = Number(e.target.value); refresh(true); };
$('at').onchange = e => goTo(Number(e.target.value));
$('zoom-in').onclick = () => zoomBy(1.5);
$('zoom-out').onclick = () => zoomBy(1 / 1.5);
$('zoom-fit').onclick = fit;
for (const button of document.querySelectorAll('button[data-cell]')) {
  button.onclick = () => {
    [state.scene, state.method] = button.dataset.cell.split('-').map(Number);
    load();
    $('panels-section').scrollIntoView({ block: 'start' });
  };
}
$('to-runs').onclick = () => { openRuns(); refresh(); play(); };
$('fold-runs').ontoggle = () => refresh();
$('fold-costs').ontoggle = $('cost').onchange = () => showCosts();
window.addEventListener('resize', showCosts);
window.addEventListener('hashchange', () => { readHash(); refresh(); });
window.addEventListener('resize', () => { drawPanels(); drawSchedule(); draw(); });
for (const query of ['(prefers-color-scheme: dark)', 'print']) {
  matchMedia(query).addEventListener('change', () => { readColours(); showLevels(); drawPanels(); drawSchedule(); refresh(); });
}

makeSortable($('summary'));
data.problems.forEach((p, i) => $('scene').append(make('option', { value: i, textContent: p.name })));
$('beside').append(make('option', { value: -1, textContent: 'nothing' }));
data.strategies.forEach((s, i) => $('beside').append(make('option', { value: i, textContent: s.name })));
data.strategies.forEach((s, i) => $('method').append(make('option', { value: i, textContent: s.name })));
data.seeds.forEach((s, i) => $('seed').append(make('option', { value: i, textContent: s })));
for (const speed of [2, 10, 50, 200, 1000, 5000]) $('speed').append(make('option', { value: speed, textContent: speed + '/s' }));
if (data.problems.some(p => p.world !== undefined)) {
  $('keys').append(' In scenes of space drag turns the view, with shift or two fingers it moves; j, l, i and k turn it, and 0 restores it. What an obstacle hides is drawn faintly.');
}
// A page of stored results has no samples to draw.
const bare = !data.cells.some(row => row.some(c => c.runs.some(r => r.id >= 0)));
if (bare) for (const part of [$('fold-runs'), $('to-runs'), $('panels')]) part.hidden = true;
if (data.problems.length && data.strategies.length && data.seeds.length) {
  readHash();
  refresh();
}
viewer.dataset.ready = '1';
})();

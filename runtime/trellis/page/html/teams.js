// SPDX-License-Identifier: GPL-3.0-or-later
// The schedule of a team: when each robot moves and how fast, and the smallest distance between two. After charts.js and
// before report.js, which gives it the robots' parts at each moment.
const teams = (() => {
'use strict';

const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/// The shares of points in the point nearest to the origin of the flat that they span; null where they span less.
function affine(points) {
  const n = points.length - 1, edges = points.slice(1).map(p => minus(p, points[0]));
  const rows = edges.map(e => [...edges.map(f => dot(e, f)), -dot(e, points[0])]);
  for (let i = 0; i < n; i++) {
    const best = rows.slice(i).reduce((k, row, j) => Math.abs(row[i]) > Math.abs(rows[k][i]) ? i + j : k, i);
    [rows[i], rows[best]] = [rows[best], rows[i]];
    if (!(Math.abs(rows[i][i]) > 1e-14)) return null;
    for (let j = 0; j < n; j++) {
      if (j === i) continue;
      const by = rows[j][i] / rows[i][i];
      rows[j] = rows[j].map((x, k) => x - by * rows[i][k]);
    }
  }
  const shares = rows.map((row, i) => row[n] / row[i]);
  return [1 - shares.reduce((a, b) => a + b, 0), ...shares];
}

/// The point nearest to the origin of a simplex, and the corners that it needs.
function nearest(simplex) {
  let least = Infinity, found = null;
  for (let set = 1; set < 1 << simplex.length; set++) {
    const corners = simplex.filter((_, i) => set >> i & 1), shares = affine(corners);
    if (!shares || shares.some(s => s < -1e-12)) continue;
    const point = [0, 1, 2].map(k => corners.reduce((sum, c, i) => sum + shares[i] * c[k], 0)), size = dot(point, point);
    if (size < least * (1 - 1e-12)) [least, found] = [size, { point, corners }];
  }
  return found;
}

const farthest = (points, d) => {
  let most = -Infinity, found = null;
  for (const p of points) { const at = dot(p, d); if (at > most) [most, found] = [at, p]; }
  return found;
};

/// The distance of the convex hulls of points, 0 where they meet (Gilbert, Johnson, Keerthi).
function distance(a, b) {
  let v = minus(a[0], b[0]), simplex = [v];
  for (let i = 0; i < 40; i++) {
    const square = dot(v, v), w = minus(farthest(a, v.map(c => -c)), farthest(b, v));
    if (square < 1e-18 || square - dot(v, w) <= 1e-9 * square) break;
    const next = nearest([...simplex, w]);
    if (!next) break;
    [v, simplex] = [next.point, next.corners];
    if (simplex.length === 4) return 0;
  }
  return Math.hypot(...v);
}

/// The smallest distance between two robots. \param parts  {member, points, radius}: hulls of points, grown by a radius
function gap(parts) {
  const balls = parts.map(({ points, radius }) => {
    const middle = [0, 1, 2].map(k => points.reduce((sum, p) => sum + p[k], 0) / points.length);
    return { middle, reach: radius + Math.max(...points.map(p => Math.hypot(...minus(p, middle)))) };
  });
  const pairs = [];
  parts.forEach((a, i) => parts.forEach((b, j) => {
    if (i >= j || a.member === b.member) return;
    pairs.push([Math.hypot(...minus(balls[i].middle, balls[j].middle)) - balls[i].reach - balls[j].reach, a, b]);
  }));
  let least = Infinity;
  // The nearest first: those that cannot come closer are not computed.
  for (const [bound, a, b] of pairs.sort((x, y) => x[0] - y[0])) {
    if (bound >= least) break;
    least = Math.min(least, Math.max(0, distance(a.points, b.points) - a.radius - b.radius));
  }
  return least;
}

/// Splits the triangles of a surface into its connected pieces. Returns lists of vertices.
function pieces(vertices, triangles) {
  const of = [...Array(vertices.length / 3).keys()];
  const first = i => { while (of[i] !== i) i = of[i] = of[of[i]]; return i; };
  triangles.forEach((corner, i) => { of[first(corner)] = first(triangles[i - i % 3]); });
  const found = new Map();
  of.forEach((_, i) => {
    const key = first(i);
    if (!found.has(key)) found.set(key, []);
    found.get(key).push([...vertices.slice(3 * i, 3 * i + 3)]);
  });
  return [...found.values()];
}

// The chart -------------------------------------------------------------------------------------------------------------

const { svg, text } = charts;
const digits = (x, n = 2) => String(+x.toPrecision(n));

/// Ticks of a linear axis from 0 on.
function ticks(end, most) {
  const least = end / most, power = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 5, 10].map(k => k * power).find(s => s >= least * 0.999);
  return Array.from({ length: Math.floor(end / step * 1.0001) + 1 }, (_, i) => i * step);
}

/// \param at  s, of each configuration of the path
/// \param lanes  the robots: {name, colour, speeds: of each piece of the path}
/// \param gaps  [s, m]: the smallest distance between two robots at several moments
function schedule(to, at, lanes, gaps, width) {
  const end = at[at.length - 1], left = 62, right = 82, row = 26, low = 44, middle = row * lanes.length + 8;
  const x = t => left + (width - left - right) * t / end;
  const top = Math.max(...lanes.flatMap(l => l.speeds)), height = middle + low + 34;
  const [least, when] = gaps.reduce((a, [t, d]) => d < a[0] ? [d, t] : a, [Infinity, 0]);
  const picture = svg('svg', { width, height, role: 'img', 'aria-label': `the speed of each robot over time; the smallest distance between two is ${digits(least)} m` });
  for (const tick of ticks(end, Math.max(2, Math.min(8, (width - left - right) / 55)))) {
    picture.append(svg('line', { x1: x(tick), x2: x(tick), y1: 2, y2: middle + low + 3, class: 'grid' }),
                   text(x(tick), middle + low + 17, digits(tick, 4), { 'text-anchor': 'middle', class: 'muted' }));
  }
  picture.append(text(left, middle + low + 32, 'time, s'));
  lanes.forEach(({ name, colour, speeds }, i) => {
    const base = row * (i + 1) - 3, moves = speeds.map(s => s > 0.02 * top), last = moves.lastIndexOf(true);
    const stop = last < 0 ? 0 : at[last + 1];
    const waits = speeds.reduce((sum, _, k) => sum + (moves[k] || k > last ? 0 : at[k + 1] - at[k]), 0);
    let d = `M${x(0)} ${base}`;
    speeds.forEach((s, k) => { const y = (base - (row - 7) * s / top).toFixed(1); d += `L${x(at[k]).toFixed(1)} ${y}L${x(at[k + 1]).toFixed(1)} ${y}`; });
    picture.append(svg('path', { d: d + `L${x(end)} ${base}Z`, style: `fill:${colour}` }),
                   svg('line', { x1: x(0), x2: x(stop), y1: base, y2: base, style: `stroke:${colour}` }),
                   text(left - 8, base - 4, name, { 'text-anchor': 'end' }));
    const says = waits > 0.005 * end ? `waits ${digits(waits)} s` : stop < 0.99 * end ? `until ${digits(stop, 3)} s` : '';
    picture.append(text(width - right + 8, base - 4, says, { class: 'muted' }));
  });
  const most = Math.max(...gaps.map(([, d]) => d)), y = d => middle + low - low * d / Math.max(most, 1e-9);
  const line = gaps.map(([t, d]) => `${x(t).toFixed(1)} ${y(d).toFixed(1)}`).join('L');
  picture.append(svg('path', { d: `M${x(0)} ${y(0)}L${line}L${x(end)} ${y(0)}Z`, class: 'faint' }),
                 svg('path', { d: 'M' + line, class: 'line' }),
                 svg('circle', { cx: x(when), cy: y(least), r: 3.5, class: 'dot' }),
                 text(left - 8, middle + low / 2, 'smallest', { 'text-anchor': 'end' }),
                 text(left - 8, middle + low / 2 + 14, 'gap', { 'text-anchor': 'end' }),
                 text(width - right + 8, middle + low / 2, `${digits(least)} m`),
                 text(width - right + 8, middle + low / 2 + 14, `at ${digits(when, 3)} s`, { class: 'muted' }));
  const e = document.createElement('figure'), caption = document.createElement('figcaption');
  caption.textContent = `Who moves when, as high as it is fast, and the smallest distance between two robots: all arrive within ${digits(end, 3)} s`;
  e.append(caption, picture);
  to.replaceChildren(e);
}

return { gap, pieces, schedule };
})();

// SPDX-License-Identifier: GPL-3.0-or-later
// The charts of costs: the cost of every run, and how many runs found a path by a cost. Plain SVG, as wide as its place,
// with the page's colours.
const charts = (() => {
'use strict';

const svg = (tag, fields, ...children) => {
  const e = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(fields || {})) e.setAttribute(name, value);
  e.append(...children);
  return e;
};
const text = (x, y, words, fields) => svg('text', { x, y, ...fields }, words);

/// "51,823", "0.14".
const number = x => x >= 100 ? Math.round(x).toLocaleString('en-US') : String(+x.toPrecision(2));

/// A logarithmic axis from pixel `from` to pixel `to` that has all costs above 0, and its ticks: at least three.
function logAxis(costs, from, to) {
  const known = costs.filter(c => c > 0 && isFinite(c));
  let lo = known.length ? Math.min(...known) : 1, hi = known.length ? Math.max(...known) : 10;
  lo /= 1.15;
  hi *= 1.15;
  const at = c => from + (to - from) * Math.log(Math.max(c, lo) / lo) / Math.log(hi / lo);
  const ticks = steps => {
    const out = [];
    for (let e = Math.floor(Math.log10(lo)); e <= Math.log10(hi); e++) {
      for (const s of steps) if (s * 10 ** e >= lo && s * 10 ** e <= hi) out.push(s * 10 ** e);
    }
    return out;
  };
  const room = Math.max(3, Math.floor((to - from) / 60));
  const all = [[1], [1, 3], [1, 2, 5], [1, 1.5, 2, 3, 5, 7]].map(ticks);
  const fitting = all.filter(t => t.length >= 3 && t.length <= room);
  return { at, ticks: fitting.pop() || all.find(t => t.length >= 3) || all[3] };
}

function drawAxis(to, axis, y, height, label, middle) {
  for (const tick of axis.ticks) {
    const x = axis.at(tick);
    to.append(svg('line', { x1: x, x2: x, y1: y - height, y2: y + 4, class: 'grid' }),
              text(x, y + 16, number(tick), { 'text-anchor': 'middle', class: 'muted' }));
  }
  to.append(text(middle, y + 32, label, { 'text-anchor': 'middle' }));
}

const median = sorted => {
  const n = sorted.length, half = n >> 1;
  return n % 2 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
};

/// A row for each strategy: a dot for each run, a bar at the median, and how many were solved. Runs without a path cost
/// infinitely much: they are hollow, at what they spent.
function every(strategies, cost, label, width) {
  const named = Math.min(180, Math.max(...strategies.map(s => 7 * s.name.length)) + 10), counted = 52, row = 26;
  const axis = logAxis(strategies.flatMap(s => s.runs.map(r => r[cost])), named, width - counted);
  const height = row * strategies.length + 4;
  const picture = svg('svg', { width, height: height + 40, role: 'img', 'aria-label': `${label}: a dot for each run` });
  drawAxis(picture, axis, height, height, label, (named + width - counted) / 2);
  strategies.forEach((s, i) => {
    const y = row * (i + 0.5) + 2;
    const name = svg('text', { x: named - 10, y: y + 4, 'text-anchor': 'end' }, s.name);
    if (7 * s.name.length > named - 10) {
      name.setAttribute('textLength', named - 12);
      name.setAttribute('lengthAdjust', 'spacingAndGlyphs');
    }
    picture.append(name);
    s.runs.forEach((run, k) => {
      // Dots of equal costs stand beside each other.
      const up = ((k * 7) % 5 - 2) * 3;
      picture.append(svg('circle', { cx: axis.at(run[cost]), cy: y + up, r: 3, style: run[2] ? `fill:${s.colour}` : `fill:none;stroke:${s.colour}`, opacity: 0.55 },
                         svg('title', {}, `${s.name}, seed ${run[3]}: ${number(run[cost])}${run[2] ? '' : ', no path'}`)));
    });
    const sorted = s.runs.map(r => r[2] ? r[cost] : Infinity).sort((a, b) => a - b);
    if (sorted.length && isFinite(median(sorted))) {
      const x = axis.at(median(sorted));
      picture.append(svg('line', { x1: x, x2: x, y1: y - 10, y2: y + 10, style: `stroke:${s.colour}`, 'stroke-width': 3 },
                         svg('title', {}, `median ${number(median(sorted))}`)));
    }
    picture.append(text(width, y + 4, `${s.runs.filter(r => r[2]).length}/${s.runs.length}`, { 'text-anchor': 'end', class: 'muted' }));
  });
  return picture;
}

/// Steps: the share of a strategy's runs that found a path by a cost.
function success(strategies, cost, label, width) {
  const left = 48, height = 190, top = 8, bottom = top + height;
  const axis = logAxis(strategies.flatMap(s => s.runs.map(r => r[cost])), left, width - 8);
  const picture = svg('svg', { width, height: bottom + 40, role: 'img', 'aria-label': `share of the runs with a path, over ${label}` });
  drawAxis(picture, axis, bottom, height, label, (left + width) / 2);
  for (const share of [0, 50, 100]) {
    const y = bottom - height * share / 100;
    picture.append(svg('line', { x1: left, x2: width - 8, y1: y, y2: y, class: 'grid' }),
                   text(left - 8, y + 4, `${share} %`, { 'text-anchor': 'end', class: 'muted' }));
  }
  strategies.forEach((s, i) => {
    const costs = s.runs.filter(r => r[2]).map(r => r[cost]).sort((a, b) => a - b);
    let d = `M${left} ${bottom}`;
    costs.forEach((c, k) => { d += `H${axis.at(c).toFixed(1)}V${(bottom - height * (k + 1) / s.runs.length).toFixed(1)}`; });
    d += `H${width - 8}`;
    picture.append(svg('path', { d, style: `fill:none;stroke:${s.colour}`, 'stroke-width': 2, 'stroke-dasharray': ['none', '8 3', '2 2', '8 3 2 3'][i % 4] },
                       svg('title', {}, s.name)));
  });
  return picture;
}

/// Draws both charts of a problem into `to`. \param all  strategies: {name, colour, runs: [checks, ms or null, solved, seed]}
function costs(to, all, cost, width) {
  // A document may lack the times of its runs.
  const strategies = all.map(s => ({ ...s, runs: s.runs.filter(r => r[cost] !== null) })).filter(s => s.runs.length);
  if (!strategies.length) {
    to.replaceChildren('The document has no times.');
    return;
  }
  const label = cost === 0 ? 'validity checks, all levels' : 'CPU time, ms';
  const key = document.createElement('p');
  key.className = 'key';
  strategies.forEach((s, i) => {
    const line = svg('svg', { width: 30, height: 10 }, svg('line', { x1: 0, x2: 30, y1: 5, y2: 5, style: `stroke:${s.colour}`, 'stroke-width': 2, 'stroke-dasharray': ['none', '8 3', '2 2', '8 3 2 3'][i % 4] }));
    const entry = document.createElement('span');
    entry.append(line, ' ' + s.name);
    key.append(entry);
  });
  const figure = (title, ...parts) => {
    const e = document.createElement('figure'), caption = document.createElement('figcaption');
    caption.textContent = title;
    e.append(caption, ...parts);
    return e;
  };
  to.replaceChildren(figure('Every run: a bar is the median, a hollow dot a run without a path', every(strategies, cost, label, width)),
                     figure('Runs with a path by this cost', success(strategies, cost, label, width), key));
}

return { costs, svg, text };
})();

# SPDX-License-Identifier: MIT-0
"""Figures of paths: how their length falls over the cost, and where along them samples lie."""
from __future__ import annotations

import math
from typing import Any, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from matplotlib.ticker import FixedFormatter, FixedLocator

from . import _style
from ._costs import Problem, Strategies, chosen_problems, columns_of, title
from ._document import Document, Error, Interval, Results, check_cost, number, read
from ._statistics import mean_interval, median_interval
from ._style import COLUMN, FAINT, GREY, INK, PAGE, SMALL, Entry, Margins

# Length --------------------------------------------------------------------------------------------------------------

_LENGTH_LABELS = {"validity_checks": "validity checks, all levels", "cpu_s": "CPU time, ms"}
_PLACES = 200


class LengthCurve(NamedTuple):
    """The median length of the shortest paths known by a cost, over the runs: infinite until half of them have one."""

    at: List[float]
    length: List[Interval]
    spent: float
    improves: bool


def _spent(improvement: Mapping[str, Any], cost: str) -> float:
    return number(improvement["checks" if cost == "validity_checks" else cost])


def length_curve(results: Results, problem: str, strategy: str, cost: str = "validity_checks") -> LengthCurve:
    """The curve of a strategy on a problem, at 200 places at most."""
    runs = [run for run in results.runs(problem, strategy) if not math.isnan(number(run[cost]))]
    paths = [[(_spent(one, cost), float(one["length"])) for one in run["improvements"]] for run in runs]
    places = sorted({at for its in paths for at, _ in its})
    if len(places) > _PLACES:
        places = [places[i * (len(places) - 1) // (_PLACES - 1)] for i in range(_PLACES)]
    lengths = []
    for place in places:
        known = [[length for at, length in its if at <= place] for its in paths]
        lengths.append(median_interval([its[-1] if its else math.inf for its in known]))
    return LengthCurve(places, lengths, max((number(run[cost]) for run in runs), default=0.0),
                       any(len(its) > 1 for its in paths))


def anytime(results: Results, problem: Optional[str] = None) -> List[str]:
    """The strategies with a run that improved its path."""
    return [name for name in results.strategies
            if any(len(run.get("improvements") or []) > 1 for run in results.runs(problem, name))]


Steps = List[Tuple[float, Interval]]


def _known(curve: LengthCurve) -> Steps:
    """The part of a curve where half of the runs have a path."""
    return [(at, one) for at, one in zip(curve.at, curve.length) if math.isfinite(one.value)]


def _length_range(curves: Sequence[Tuple[str, LengthCurve]]) -> Tuple[float, float]:
    """The ends of the axis of lengths."""
    lengths = [one.value for _, curve in curves for _, one in _known(curve)] or [0.0, 1.0]
    if len(curves) <= 2:
        lengths += [end for _, curve in curves for _, one in _known(curve) if math.isfinite(one.hi)
                    for end in (one.lo, one.hi) if math.isfinite(end)]
    pad = 0.06 * max(max(lengths) - min(lengths), 0.02 * max(lengths), 1e-9)
    return min(lengths) - pad, max(lengths) + pad


def _length_texts(lo: float, hi: float) -> List[str]:
    return [f"{tick:.6g}" for tick in _style.round_ticks(lo, hi)]


def _length_panel(ax: Any, results: Results, curves: Sequence[Tuple[str, LengthCurve]], unit: float) -> None:
    spent = max(curve.spent for _, curve in curves) * unit
    lo, hi = _style.span([spent, *(at * unit for _, curve in curves for at, _ in _known(curve))], 1.15, 4)
    _style.log_axis(ax, lo, max(hi, spent))
    for name, curve in reversed(curves):
        steps = _known(curve)
        if not steps:
            continue
        look = _style.look(results, name)
        at = [place * unit for place, _ in steps] + [spent]
        median = [one.value for _, one in steps]
        ax.step(at, median + median[-1:], where="post", color=look.colour, linestyle=look.dash, linewidth=1.3,
                zorder=3 if look.dash == "-" else 3.5, solid_joinstyle="miter")
        if len(curves) <= 2:
            ends = [(one.lo, one.hi) if math.isfinite(one.hi) else (math.nan, math.nan) for _, one in steps]
            ends.append(ends[-1])
            ax.fill_between(at, [low for low, _ in ends], [high for _, high in ends], step="post", color=look.colour,
                            alpha=0.13, linewidth=0, zorder=1)
    least, most = _length_range(curves)
    ax.set_ylim(least, most)
    ax.yaxis.set_major_locator(FixedLocator(_style.round_ticks(least, most)))
    ax.yaxis.set_major_formatter(FixedFormatter(_length_texts(least, most)))
    ax.grid(axis="y", color=FAINT, linewidth=0.5)


def length(document: Document, *, problem: Problem = None, strategies: Strategies = None,
           cost: str = "validity_checks", ax: Any = None) -> Any:
    """How fast do paths get shorter? The length of the shortest path known by a number of checks, before shortcutting:
    the median over the runs, one without a path infinite. A curve begins where half of the runs have a path. With two
    strategies at most, bands: the 95 % interval by order statistics.

    problem:    one or several names of problems, a panel each (default all; more than 12: the first 12).
    strategies: names of strategies (default all that improve a path, as rrt_star does).
    cost:       "validity_checks", or "cpu_s", drawn in milliseconds.
    ax:         axes to draw in, one for each panel (default those of a new figure, 86 x 52 mm for one panel, else
                178 mm wide).

    Returns the axes: one, or an array of several. Raises `Error` for an unknown name, for another number of axes, and
    where no strategy improves a path.
    """
    check_cost(cost, tuple(_LENGTH_LABELS))
    results = read(document)
    names = results.chosen(strategies)
    if strategies is None:
        improving = anytime(results)
        names = [name for name in names if name in improving]
    problems = [one for one in results.panels(problem) if any(results.runs(one, name) for name in names)]
    if problem is None:
        problems = [one for one in problems if anytime(results, one)][:12]
    if not names or not problems:
        raise Error(f"{results.file}: no strategy improves its path, as rrt_star does")
    panels = [[(name, length_curve(results, one, name, cost)) for name in names if results.runs(one, name)]
              for one in problems]
    count, columns = len(problems), columns_of(len(problems))
    width = COLUMN if count == 1 else PAGE
    entries = [Entry(name, _style.look(results, name)) for name in names]
    with _style.styled():
        axes = _style.given(ax, count, "length")
        own = axes is None
        texts = _style.width_of([text for panel in panels for text in _length_texts(*_length_range(panel))])
        left = texts + 6.5
        margins = Margins(left=left, right=4, bottom=8.4, wide=texts + 5, high=9,
                          top=_style.key_height(entries, width - left - 3, True) + (6.5 if count > 1 else 3))
        if axes is None:
            rows = math.ceil(count / columns)
            each = (37.0 if rows == 1 else 31.0) if rows < 3 else 24.0
            high = rows * each + margins.top + margins.bottom + margins.high * (rows - 1)
            axes = _style.place("length", width, high, count, columns, margins)
            _style.key(axes[0].figure, entries, left, width - left - 3, True)
        for i, one in enumerate(axes):
            _length_panel(one, results, panels[i], 1000.0 if cost == "cpu_s" else 1.0)
            if own and count > 1:
                one.set_title(_style.cut(title(results, problems[i]), _style.size_of(one)[0] + 3), pad=4.5)
            elif not own:
                _style.inner_key(one, entries, True)
            if not own or i % columns == 0:
                one.set_ylabel("length of the path, m", fontsize=_style.SIZE, color=INK)
        _style.below(axes, _LENGTH_LABELS[cost], own, margins)
    return _style.returned(axes)


# Profile -------------------------------------------------------------------------------------------------------------

_ROLES = (("tree", "nodes"), ("expansion", "proposals"))


class Profile(NamedTuple):
    """Shares of samples in parts of equal length along the path, start to goal, and those of the target."""

    strategy: str
    role: str
    samples: List[Interval]
    target: List[float]
    bottleneck: Optional[Mapping[str, Any]]


def _spread(shares: Sequence[float], count: int) -> List[float]:
    """Distributes shares in parts over `count` parts of the same whole."""
    out = [0.0] * count
    scale = count / len(shares)
    for i, share in enumerate(shares):
        lo, hi = i * scale, (i + 1) * scale
        for j in range(int(lo), count):
            if j >= hi:
                break
            out[j] += share * max(0.0, min(hi, j + 1.0) - max(lo, float(j))) / (hi - lo)
    return out


def profile_of(results: Results, problem: str, strategy: str, role: str) -> Optional[Profile]:
    """The mean over the runs of a strategy, each along its own path; None where the document has none."""
    found = []
    for run in results.runs(problem, strategy):
        row = results.scores(run, role)
        if row.get("along.target") and row.get("along.samples"):
            # Shares in ten thousandths.
            found.append(([x / 1e4 for x in row["along.samples"]], [x / 1e4 for x in row["along.target"]]))
    if not found:
        return None
    counts = sorted(len(target) for _, target in found)
    middle = (counts[len(counts) // 2] + counts[(len(counts) - 1) // 2]) // 2
    samples = np.array([_spread(shares, middle) for shares, _ in found])
    target = np.array([_spread(shares, middle) for _, shares in found]).mean(0)
    row = results.pooled(problem, strategy).get(role, {})
    bottleneck = {key[len("bottleneck."):]: value for key, value in row.items()
                  if key.startswith("bottleneck.") and value is not None}
    return Profile(strategy, role, [mean_interval(list(part)) for part in samples.T], [float(x) for x in target],
                   bottleneck or None)


def profiles(results: Results, problem: str, names: Sequence[str]) -> List[Profile]:
    """Of each strategy the nodes, then the proposals."""
    found = [profile_of(results, problem, name, role) for name in names for role, _ in _ROLES]
    return [one for one in found if one is not None]


def profiled(results: Results) -> List[str]:
    """The problems with samples along a path."""
    return [problem for problem in results.problems if profiles(results, problem, results.strategies)]


def _thinnest(one: Profile, room: float) -> Tuple[float, str]:
    """The place of the bottleneck, as a share of the path, and what is said of it; NaN and "" where there is none."""
    entry = one.bottleneck or {}
    at, whole, nats = (number(entry.get(key)) for key in ("at", "length", "nats"))
    if math.isnan(nats) or math.isnan(at) or not whole > 0:
        return math.nan, ""
    lo, hi = number(entry.get("lo")), number(entry.get("hi"))
    signed = [_style.signed(x).replace("inf", "∞") for x in (nats, lo, hi)]
    text = f"thinnest at {_style.digits(at, 3)} m: {signed[0]}"
    longer = f"{text} [{signed[1]}, {signed[2]}]"
    for full in ([] if math.isnan(lo) or math.isnan(hi) else [f"{longer} nats", longer]) + [f"{text} nats"]:
        if _style.width_of([full], SMALL) <= room:
            return at / whole, full
    return at / whole, text


def _profile_panel(ax: Any, results: Results, one: Profile, top: float) -> None:
    count = len(one.target)
    edges = np.linspace(0, 100, count + 1)
    colour = _style.look(results, one.strategy).colour

    def steps(values: Sequence[float]) -> "np.ndarray[Any, Any]":
        return np.append(values, values[-1]) * count

    ax.step(edges, steps(one.target), where="post", color=INK, linewidth=0.7, linestyle=(0, (2, 1.5)), zorder=2.5)
    ax.step(edges, steps([part.value for part in one.samples]), where="post", color=colour, linewidth=1.3, zorder=3)
    if not any(math.isnan(part.lo) for part in one.samples):
        ax.fill_between(edges, steps([part.lo for part in one.samples]), steps([part.hi for part in one.samples]),
                        step="post", color=colour, alpha=0.16, linewidth=0, zorder=2)
    for middle, part in zip((edges[1:] + edges[:-1]) / 2, one.samples):
        if part.value * count > top:
            ax.plot(middle, top, "^", markersize=3.4, markeredgewidth=0, color=colour, clip_on=False, zorder=4)
    room = _style.size_of(ax)[0]
    place, words = _thinnest(one, room + 2)
    if words:
        ax.plot(min(max(100 * place, 0), 100), 0, "^", markersize=4.2, markeredgewidth=0, color=INK, clip_on=False,
                zorder=5)
    ax.set_xlim(0, 100)
    ax.set_ylim(0, top)
    ax.set_yticks([tick for tick in _style.round_ticks(0, top, 4) if tick < top])
    ax.set_xticks([0, 50, 100])
    role = dict(_ROLES)[one.role]
    name = _style.cut(one.strategy, room - _style.width_of([f": {role}"]) - 0.5)
    ax.set_title(f"{name}: {role}", pad=10.5 if words else 3)
    if words:
        _style.above(ax, 0, _style.cut(words, room + 2, SMALL), dy=0.9, color=GREY)


def profile(document: Document, *, problem: Optional[str] = None, strategies: Strategies = None, ax: Any = None) -> Any:
    """Where along the path do the samples lie? The share of the robot's own samples that lie about each part of the
    path, divided by the mean of all parts: steps, the mean over the runs with its 95 % interval; dashed: the target. A
    triangle marks the bottleneck, the place where the samples of all seeds together are rarest beside uniform ones,
    with its nats. Panels for nodes and proposals of each strategy. An arrow: more than four times the mean.

    problem:    the name of a problem (default the first with scores).
    strategies: names of strategies (default all with scores).
    ax:         axes to draw in, one for each panel (default those of a new figure, 178 mm wide).

    Returns the axes, an array. Raises `Error` for an unknown name, for another number of axes, and where the document
    has no samples along a path, as of `measure = false`, of a sweep, or of several documents.
    """
    results = read(document)
    known = profiled(results) if problem is None else results.panels(problem)
    panels = profiles(results, known[0], results.chosen(strategies)) if known else []
    if not panels:
        raise Error(f"{results.file}: no run has scores along its path; run it with a measure")
    every = [share * len(one.target) for one in panels for share in
             [*one.target, *(part.value for part in one.samples),
              *(part.hi for part in one.samples if math.isfinite(part.hi))]]
    top = min(1.08 * max(every), 4.2)
    names = list(dict.fromkeys(one.strategy for one in panels))
    cells = [2 * names.index(one.strategy) + (one.role == "expansion") for one in panels]
    alone = len(panels) == 1
    columns = 1 if alone else 2 if len(names) <= 4 else 4
    count = 1 if alone else 2 * len(names)
    rows = math.ceil(count / columns)
    width = COLUMN if alone else PAGE
    margins = Margins(left=11, right=4, top=8.5, bottom=8.4, wide=6 if columns == 4 else 9, high=12)
    with _style.styled():
        axes = _style.given(ax, len(panels), "profile")
        own = axes is None
        if axes is None:
            each = max(8.0, min(20.0 if rows < 3 else 14.0, (_style.HIGHEST - 17 - 12 * (rows - 1)) / rows))
            height = rows * each + margins.top + margins.bottom + margins.high * (rows - 1)
            placed = _style.place("profile", width, height, count, columns, margins)
            axes = placed if alone else [placed[cell] for cell in cells]
            for one in placed:
                if one not in axes:  # a roadmap that proposes nothing
                    one.figure.delaxes(one)
        last = {cell % columns: cell for cell in sorted(cells)}
        for one, panel, cell in zip(axes, panels, cells):
            _profile_panel(one, results, panel, top)
            if own and not alone and last[cell % columns] != cell:
                one.set_xticklabels([])
            if not own or alone or cell % columns == 0:
                label = "samples ÷ mean" if _style.size_of(one)[1] > 17 else "÷ mean"
                one.set_ylabel(label, fontsize=_style.SIZE, color=INK)
            else:
                one.set_yticklabels([])
        _style.below(axes, f"{known[0]}: share of the path, % (dashed: the target)", own, margins)
    return _style.returned(axes)

# SPDX-License-Identifier: MIT-0
"""Figures of nats and of options: what each level adds, which nats predict the checks, costs over an option."""
from __future__ import annotations

import math
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from matplotlib.ticker import FixedFormatter, FixedLocator

from . import _style
from ._costs import Problem, Strategies, title
from ._document import Document, Error, Interval, Results, number, read
from ._statistics import Curve, GroupCorrelation, correlation_difference, group_correlation, split_levels, sweeps
from ._style import COLUMN, FAINT, GREY, INK, LESS, MORE, PAGE, SMALL, Entry, Margins

# Waterfall -----------------------------------------------------------------------------------------------------------

_ROLES = (("tree", "nodes"), ("expansion", "proposals"))


class _Step(NamedTuple):
    label: str
    before: Interval
    after: Interval
    added: Interval
    total: bool


def _steps(entry: Mapping[str, Any], role: str) -> List[_Step]:
    """A row of each level, the guides first, then the sum; none where no level has a value."""
    found = []
    levels = entry["levels"]
    steps = entry.get("waterfall", {}).get(role, [])
    counts: Dict[int, int] = {}
    for step in steps:
        counts[step["level"]] = counts.get(step["level"], 0) + 1
    planner = levels[0]["planner"] if levels else ""
    for step in steps:
        label = str(levels[step["level"]]["name"] if step["level"] else planner)
        if counts[step["level"]] > 1 and step["from"] != "uniform":
            label += f" after {levels[step['from']]['name']}"
        before, after = Interval.of(step["gain_before"]), Interval.of(step["gain_after"])
        found.append(_Step(label, before, after, Interval.of(step["added"]), False))
    if found and steps[-1]["level"] == 0:
        after = found[-1].after
        found.append(_Step("all levels", Interval(0, 0, 0), after, after, True))
    return found if any(not math.isnan(step.added.value) for step in found) else []


def _range_text(interval: Interval) -> str:
    if math.isnan(interval.value):
        return "–"
    ends = (round(interval.lo, 2), round(interval.hi, 2))
    if ends[0] == ends[1]:
        return _style.signed(interval.value)
    return f"{_style.signed(interval.lo)} … {_style.signed(interval.hi)}"


class _Waterfall(NamedTuple):
    strategy: str
    role: str
    steps: List[_Step]


def _waterfalls(results: Results, problem: Optional[str], names: Sequence[str]) -> List[_Waterfall]:
    found = []
    for name in names:
        entry = results.summary(problem, name)
        if entry is None or len(entry["levels"]) < 2:
            continue
        for role, words in _ROLES:
            steps = _steps(entry, role)
            if steps:
                found.append(_Waterfall(name, words, steps))
    return found


def _waterfall_panel(ax: Any, one: _Waterfall, labels: Sequence[str], lo: float, hi: float) -> None:
    _style.linear_axis(ax, lo, hi)
    _style.rows_axis(ax, labels)
    ax.axvline(0, color=INK, linewidth=0.7, zorder=1)
    previous: Optional[Tuple[int, float]] = None
    for y, step in enumerate(one.steps):
        added = step.added.value
        _style.words(ax, 1, y, _range_text(step.added), 2.2, ha="left", color=GREY if math.isnan(added) else INK)
        if math.isnan(added):
            previous = None
            continue
        colour = GREY if step.total else LESS if added >= 0 else MORE
        ends = sorted((step.before.value, step.after.value))
        ax.barh(y, ends[1] - ends[0], left=ends[0], height=0.56, color=colour, alpha=0.35 if step.total else 0.55,
                linewidth=0, zorder=2)
        ax.plot([step.after.value] * 2, [y - 0.28, y + 0.28], color=colour, linewidth=1.6, solid_capstyle="butt",
                zorder=4)
        ax.plot([step.after.lo, step.after.hi], [y, y], color=colour, linewidth=0.9, solid_capstyle="butt", zorder=3)
        if previous is not None and not step.total:
            ax.plot([step.before.value] * 2, [previous[0] + 0.28, y - 0.28], color=GREY, linewidth=0.5, zorder=1)
        previous = (y, step.after.value)


def waterfall(document: Document, *, problem: Optional[str] = None, strategies: Strategies = None,
              ax: Any = None) -> Any:
    """What does each level add? The nats above uniform sampling of each level's samples, lifted to the root: a bar from
    those of the level that guides it to its own, green where it adds, orange where it loses, and a line for the
    interval that the samples support; at the right the nats that the level adds, between all values of the two
    intervals. A panel for the nodes and one for the proposals of each strategy with guides.

    problem:    the name of a problem (default the only one, else all problems together).
    strategies: names of strategies (default all with guides).
    ax:         axes to draw in, one for each panel (default those of a new figure, 86 mm wide, or 178 mm with the
                proposals beside the nodes).

    Returns the axes: one, or an array. Raises `Error` for an unknown name, for another number of axes, and where no
    level has an interval.
    """
    results = read(document)
    where = None if problem is None else results.panels(problem)[0]
    panels = _waterfalls(results, where, results.chosen(strategies))
    if not panels:
        raise Error(f"{results.file}: no level with a guide has nats above uniform")
    values = [x for one in panels for step in one.steps for x in (step.after.lo, step.after.hi, step.after.value)
              if not math.isnan(x)] + [0.0]
    lo, hi = min(values), max(values)
    pad = 0.06 * max(hi - lo, 0.5)
    lo, hi = lo - pad, hi + pad
    beside = len(panels) > 1 and {one.role for one in panels} == {"nodes", "proposals"}
    texts = _style.width_of([_range_text(step.added) for one in panels for step in one.steps], SMALL)
    width = PAGE if beside else COLUMN
    with _style.styled():
        axes = _style.given(ax, len(panels), "waterfall")
        own = axes is None
        labels = [[_style.cut(_style.short_guide(step.label), 34) for step in one.steps] for one in panels]
        left = _style.width_of([label for its in labels for label in its]) + 3
        if axes is None:
            axes = _waterfall_axes(panels, left, texts, width, beside)
        for one, panel, its in zip(axes, panels, labels):
            _waterfall_panel(one, panel, its, lo, hi)
            one.set_title(f"{panel.strategy}: {panel.role}")
            if not own or not any(other.role == panel.role for other in panels[panels.index(panel) + 1:]):
                one.set_xlabel("nats above uniform", fontsize=_style.SIZE, color=INK)
            _style.above(one, 1, "adds", 2.2, ha="left")
    return _style.returned(axes)


def _waterfall_axes(panels: Sequence[_Waterfall], left: float, texts: float, width: float, beside: bool) -> List[Any]:
    """Axes whose height follows the number of rows of each strategy, nodes left, proposals right."""
    names = list(dict.fromkeys(one.strategy for one in panels))
    rows = {name: max(len(one.steps) for one in panels if one.strategy == name) for name in names}
    top, bottom, right, gap = 5.6, 8.4, texts + 3.2, 5.0 + 5.6
    stacks = {name: 1 if beside else sum(1 for one in panels if one.strategy == name) for name in names}
    count = sum(stacks.values())
    free = _style.HIGHEST - top - bottom - gap * (count - 1)
    row = max(2.4, min(4.2, free / sum(rows[name] * stacks[name] for name in names)))
    height = row * sum(rows[name] * stacks[name] for name in names) + top + bottom + gap * (count - 1)
    figure = _style.sheet("waterfall", width, height)
    each = (width - (2 if beside else 1) * (left + right)) / (2 if beside else 1)
    axes: List[Any] = []
    y = height - top
    for name in names:
        mine = [one for one in panels if one.strategy == name]
        for one in mine:
            x = left + (each + left + right if beside and one.role == "proposals" else 0)
            high = row * len(one.steps)
            axes.append(figure.add_axes([x / width, (y - high) / height, each / width, high / height],
                                        label=f"waterfall {len(axes)}"))
            if not beside:
                y -= high + gap
        if beside:
            y -= row * rows[name] + gap
    return axes


# Correlation ---------------------------------------------------------------------------------------------------------

Nats = Tuple[float, float, float, float]
PREDICTORS = ("hitting", "mass", "spread", "SE")
PAIRS = ((0, 1), (0, 3), (1, 2), (1, 3), (2, 3))
_LEAST_STRATEGIES, _LEAST_PROBLEMS = 3, 2


class Dot(NamedTuple):
    """A strategy with guides on a problem."""

    problem: str
    strategy: str
    nats: Nats  # by each predictor; NaN: no hitting
    ratio: float


class Correlation(NamedTuple):
    """Whether strategies whose samples have more nats above uniform cost fewer validity checks."""

    dots: List[Dot]
    rho: List[GroupCorrelation]  # of each predictor
    differences: List[Interval]  # of PAIRS


def _mean_nats(results: Results, problem: str, strategy: str, role: str, paths: str) -> Optional[Nats]:
    """The mean over the runs of all documents, of their roots."""
    mean: Optional[Nats] = None
    runs = 0
    for part in results.parts or [results]:
        nats = _nats(part, problem, strategy, role, paths)
        if nats is None:
            continue
        here = int((part.summary(problem, strategy) or {})["means"][role][paths]["runs"])
        runs += here
        mean = nats if mean is None else (mean[0] + (nats[0] - mean[0]) * here / runs,
                                          mean[1] + (nats[1] - mean[1]) * here / runs,
                                          mean[2] + (nats[2] - mean[2]) * here / runs,
                                          mean[3] + (nats[3] - mean[3]) * here / runs)
    return mean


def _nats(results: Results, problem: str, strategy: str, role: str, paths: str) -> Optional[Nats]:
    entry = results.summary(problem, strategy) or {}
    mean = ((entry.get("means") or {}).get(role) or {}).get(paths)
    if not mean:
        return None
    uniform, above = number(mean["D_uniform"]), number(mean["above_uniform"])
    mass, spread = (number(mean["SE_parts"][part]) for part in ("mass", "spread"))
    # Of all seeds together on the paths of other seeds, else the mean over the runs.
    hitting = number(mean["hitting"]["nats"])
    if paths == "cross":
        of_all = number(results.pooled(problem, strategy).get(role, {}).get("hitting.nats"))
        hitting = hitting if math.isnan(of_all) else of_all
    nats = (hitting, uniform - mass, -spread, above)
    return nats if all(math.isfinite(x) for x in nats[1:]) else None


def correlate(results: Results, proposals: bool = False) -> Optional[Correlation]:
    """Correlates nats above uniform of the root's samples with the ratios of checks, over the strategies with guides.
    None for fewer than two problems with three of them."""
    role = "expansion" if proposals else "tree"
    groups: List[List[Dot]] = []
    for problem in results.problems:
        found: Dict[str, Dict[str, Nats]] = {"cross": {}, "self": {}}
        for name in results.others + ([results.baseline] if results.baseline else []):
            for paths, its in found.items():
                nats = _mean_nats(results, problem, name, role, paths)
                if nats is not None:
                    its[name] = nats
        chosen = found["cross"] or found["self"]
        dots = []
        for name in sorted(chosen, key=results.place):
            ratio = results.ratio(problem, name).value
            if len(split_levels(results.spec(name)["text"])) >= 2 and not math.isnan(ratio):
                dots.append(Dot(problem, name, chosen[name], ratio))
        if len(dots) >= _LEAST_STRATEGIES:
            groups.append(dots)
    if len(groups) < _LEAST_PROBLEMS:
        return None
    rho = [group_correlation([([dot.nats[k] for dot in dots], [dot.ratio for dot in dots]) for dots in groups])
           for k in range(len(PREDICTORS))]
    differences = [correlation_difference(rho[a], rho[b]) for a, b in PAIRS]
    return Correlation([dot for dots in groups for dot in dots], rho, differences)


def rho_text(rho: Interval) -> str:
    if math.isnan(rho.value):
        return "–"
    if math.isnan(rho.lo):
        return _style.signed(rho.value)
    return f"{_style.signed(rho.value)} [{_style.signed(rho.lo)}, {_style.signed(rho.hi)}]"




def correlation(document: Document, *, proposals: bool = False, ax: Any = None) -> Any:
    """Which nats predict the checks? A dot for each strategy with guides on each problem: over the nats above uniform
    of the root's samples, by hitting, by mass, by spread and both, the validity checks divided by the baseline's on the
    same seed, the median. Titles have Spearman's rank correlation within problems, with a bootstrap's 95 % interval
    over them (from six problems on): at -1 more nats mean fewer checks on each problem. Arrows: the ratio is infinite,
    or 0.

    proposals: whether the nats are those of the root's proposals (default False: of its nodes).
    ax:        four axes to draw in (default those of a new figure, 178 mm wide).

    Returns an array of four axes. Raises `Error` for another number of axes, and where fewer than two problems have
    three scored strategies with guides.
    """
    results = read(document)
    found = correlate(results, proposals)
    if found is None:
        raise Error(f"{results.file}: a correlation needs two problems with three scored strategies with guides each")
    names = [name for name in results.others if any(dot.strategy == name for dot in found.dots)]
    entries = [Entry(name, _style.look(results, name)) for name in names]
    ratios = [dot.ratio for dot in found.dots]
    lo, hi = _style.span(ratios + [1.0], 1.35, 8)
    with _style.styled():
        axes = _style.given(ax, len(PREDICTORS), "correlation")
        own = axes is None
        margins = Margins(left=14, right=3, bottom=8.4, wide=5,
                          top=_style.key_height(entries, PAGE - 17, False) + 9.7)
        if axes is None:
            height = 46 + margins.top + margins.bottom
            axes = _style.place("correlation", PAGE, height, len(PREDICTORS), len(PREDICTORS), margins)
            _style.key(axes[0].figure, entries, 14, PAGE - 17, False)
        for k, one in enumerate(axes):
            for name in names:
                look = _style.look(results, name)
                dots = [dot for dot in found.dots if dot.strategy == name]
                inside = [dot for dot in dots if 0 < dot.ratio < math.inf]
                one.plot([dot.nats[k] for dot in inside], [dot.ratio for dot in inside], look.mark, markersize=3.8,
                         markeredgewidth=0.4, markeredgecolor="white", color=look.colour, zorder=3, clip_on=False)
                for dot in dots:
                    if dot not in inside:
                        beyond = dot.ratio > 0
                        one.plot(dot.nats[k], hi if beyond else lo, "^" if beyond else "v", markersize=4,
                                 markeredgewidth=0, color=look.colour, zorder=3, clip_on=False)
            _ratio_y_axis(one, lo, hi, k == 0 or not own)
            nats = [dot.nats[k] for dot in found.dots if not math.isnan(dot.nats[k])] or [0.0]
            pad = 0.07 * max(max(nats) - min(nats), 0.1)
            _style.linear_axis(one, min(nats) - pad, max(nats) + pad)
            one.set_title(f"{PREDICTORS[k]}\nρ = {rho_text(found.rho[k].rho)}")
        axes[0].set_ylabel(f"checks ÷ those of {_style.cut(results.baseline, 20)}", fontsize=_style.SIZE, color=INK)
        role = "proposals" if proposals else "nodes"
        _style.below(axes, f"nats above uniform of the root's {role}", own, margins)
    return _style.returned(axes)


def _ratio_y_axis(ax: Any, lo: float, hi: float, labelled: bool) -> None:
    """A logarithmic axis of ratios, upwards, with 1 marked."""
    ax.set_yscale("log")
    ax.set_ylim(lo, hi)
    ticks = _style.log_ticks(lo, hi, _style.size_of(ax)[1] * 2, _style.plain)
    ax.yaxis.set_major_locator(FixedLocator(ticks))
    ax.yaxis.set_major_formatter(FixedFormatter([_style.plain(tick) if labelled else "" for tick in ticks]))
    ax.yaxis.set_minor_locator(FixedLocator([]))
    ax.grid(axis="y", color=FAINT, linewidth=0.5)
    if lo < 1 < hi:
        ax.axhline(1, color=INK, linewidth=0.7, zorder=1)
        ax.axhspan(lo, 1, color=_style.TINT, alpha=0.05, linewidth=0, zorder=0)


# Options -------------------------------------------------------------------------------------------------------------


def options(results: Results) -> Dict[str, List[Curve]]:
    """The options in which three strategies or more differ alone, each with its curves."""
    return sweeps({name: results.spec(name).get("spec") for name in results.strategies})


def scales(document: Document, *, option: Optional[str] = None, problem: Problem = None, ax: Any = None) -> Any:
    """How do the costs depend on an option? Over the number of an option in which three strategies or more differ
    alone, such as the scale of `shrink`: the validity checks divided by the baseline's on the same seed, the median
    with its 95 % interval, one curve for each problem; below 1, tinted, it costs less. Without a baseline: the checks.
    An arrow: the value is infinite. The share of solved runs is written where it is not all.

    option:  which one, as "scale of shrink" (default the only one; of several the first).
    problem: one or several names of problems (default all; more than 7: all together).
    ax:      axes to draw in (default those of a new figure, 86 x 52 mm).

    Returns the axes. Raises `Error` for an unknown name, and where no three strategies differ in one number alone.
    """
    results = read(document)
    found = options(results)
    if not found:
        raise Error(f"{results.file}: no three strategies differ in one number of one option alone")
    if option is not None and option not in found:
        raise Error(f"{results.file}: there is no option '{option}'; there are: {', '.join(found)}")
    name = option or next(iter(found))
    problems: List[Optional[str]] = list(results.panels(problem))
    if problem is None and len(problems) > 7:
        problems = [None]
    lines = [(curve, one) for curve in found[name] for one in problems]
    names = [_line_name(results, found[name], curve, one) for curve, one in lines]
    entries = [Entry(each, _style.nth(i)) for i, each in enumerate(names)]
    keyed = len(entries) > 1 or len(results.problems) > 1
    with _style.styled():
        axes = _style.given(ax, 1, "scales")
        own = axes is None
        margins = Margins(left=13, right=3, bottom=8.4,
                          top=_style.key_height(entries, COLUMN - 4, False) + 2.5 if keyed else 3)
        if axes is None:
            axes = _style.place("scales", COLUMN, 40 + margins.top + margins.bottom, 1, 1, margins)
            if keyed:
                _style.key(axes[0].figure, entries, 2, COLUMN - 4, False)
        elif keyed:
            _style.inner_key(axes[0], entries, False)
        _scales_panel(axes[0], results, lines)
        axes[0].set_xlabel(name, fontsize=_style.SIZE, color=INK)
        beside = f"checks ÷ those of {_style.cut(results.baseline, 20)}" if results.baseline else "checks"
        axes[0].set_ylabel(beside, fontsize=_style.SIZE, color=INK)
    return axes[0]


def _line_name(results: Results, curves: Sequence[Curve], curve: Curve, problem: Optional[str]) -> str:
    name = title(results, problem)
    return name if len(curves) == 1 else f"{name}, {_style.cut(curve.strategies[0], 26)} …"


def _scales_panel(ax: Any, results: Results, lines: Sequence[Tuple[Curve, Optional[str]]]) -> None:
    def value(problem: Optional[str], strategy: str) -> Interval:
        if not results.baseline:
            return results.median(problem, strategy)
        return Interval(1.0, 1.0, 1.0) if strategy == results.baseline else results.ratio(problem, strategy)

    ends = []
    for curve, problem in lines:
        for strategy in curve.strategies:
            one = value(problem, strategy)
            ends += [one.value] + ([one.lo, one.hi] if one.bounded else [])
    lo, hi = _style.span(ends + ([1.0] if results.baseline else []), 1.3, 4)
    _ratio_y_axis(ax, lo, hi, True)
    places = sorted({x for curve, _ in lines for x in curve.values})
    wide = places[-1] - places[0]
    step = 0.012 * wide
    for i, (curve, problem) in enumerate(lines):
        look = _style.nth(i)
        shift = (i - (len(lines) - 1) / 2) * step
        x = [at + shift for at in curve.values]
        found = [value(problem, strategy) for strategy in curve.strategies]
        inside = [(at, one) for at, one in zip(x, found) if lo <= one.value <= hi]
        ax.plot([at for at, _ in inside], [one.value for _, one in inside], color=look.colour, linewidth=0.8, alpha=0.6,
                zorder=2)
        for at, one, strategy in zip(x, found, curve.strategies):
            if one.bounded:
                ax.plot([at, at], [max(one.lo, lo), min(one.hi, hi)], color=look.colour, linewidth=1.1, zorder=2,
                        solid_capstyle="butt")
                if one.hi > hi:
                    ax.plot(at, hi, "^", markersize=3.4, markeredgewidth=0, color=look.colour, clip_on=False)
            if lo <= one.value <= hi:
                ax.plot(at, one.value, look.mark, markersize=3.8, markeredgewidth=0.4, markeredgecolor="white",
                        color=look.colour, zorder=4)
            elif not math.isnan(one.value):
                ax.plot(at, hi if one.value > hi else lo, "^" if one.value > hi else "v", markersize=5,
                        markeredgewidth=0, color=look.colour, clip_on=False, zorder=4)
            solved, runs = results.solved(problem, strategy)
            if solved < runs and not math.isnan(one.value):
                y = min(max(one.value, lo), hi)
                ax.annotate(f"{solved}/{runs}", (at, y), xytext=(3, 2), textcoords="offset points", fontsize=SMALL,
                            color=look.colour, annotation_clip=False)
    gaps = [b - a for a, b in zip(places, places[1:])]
    few = len(places) <= 7 and min(gaps) > 0.09 * wide
    _style.linear_axis(ax, places[0] - 0.08 * wide, places[-1] + 0.08 * wide, places if few else None)

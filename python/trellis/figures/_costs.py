# SPDX-License-Identifier: MIT-0
"""Figures of costs: what each strategy costs, how likely a path is by a cost, and whether guidance pays."""
from __future__ import annotations

import math
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _style
from ._compare import Ratios, check_against, ratios_of
from ._document import Document, Error, Interval, Results, check_cost, number, read
from ._statistics import wilson
from ._style import COLUMN, FAINT, GREY, INK, PAGE, SMALL, Entry, Margins

_LABELS = {
    "validity_checks": "validity checks until the first path, all levels",
    "motion_checks": "motion checks, all levels",
    "time_s": "time until the end of a run, ms",
}
_SHORT = {"validity_checks": "validity checks", "motion_checks": "motion checks", "time_s": "milliseconds"}
Problem = Union[None, str, Sequence[str]]
Strategies = Optional[Sequence[str]]


def _unit(cost: str) -> float:
    """By which costs of the document are multiplied: times are drawn in milliseconds."""
    return 1000.0 if cost == "time_s" else 1.0


def title(results: Results, problem: Optional[str]) -> str:
    """A problem's name, or the number of all."""
    return f"all {len(results.problems)} problems" if problem is None else problem


def need_runs(results: Results, names: Sequence[str]) -> None:
    if not any(results.runs(None, name) for name in names):
        raise Error(f"{results.file}: there are no runs")


def columns_of(count: int) -> int:
    """The columns of so many panels."""
    return 1 if count == 1 else 2 if count in (2, 4) else 3


def chosen_problems(results: Results, problem: Problem, together: bool, most: int) -> List[Optional[str]]:
    """A panel for each problem that was asked for; one for all of them where they are more than `most`."""
    if together or (problem is None and len(results.problems) > most):
        return [None] if len(results.problems) > 1 else list(results.problems)
    return list(results.panels(problem))


# Costs ---------------------------------------------------------------------------------------------------------------


class _Row(NamedTuple):
    strategy: str
    values: "np.ndarray[Any, Any]"
    median: Interval
    number: str
    solved: str


def _rows(results: Results, problem: Optional[str], strategies: Sequence[str], cost: str) -> List[_Row]:
    rows = []
    for strategy in strategies:
        unit = _unit(cost)
        middle = results.median(problem, strategy, cost)
        middle = Interval(middle.value * unit, middle.lo * unit, middle.hi * unit)
        solved, runs = results.solved(problem, strategy)
        text = _style.digits(middle.value, 3) if cost == "time_s" else _style.counted(middle.value)
        values = results.costs(problem, strategy, cost) * unit
        rows.append(_Row(strategy, values, middle, text if runs else "", f"{solved}/{runs}" if runs else "no runs"))
    return rows


class _CostAxis(NamedTuple):
    """A logarithmic axis of costs, with a place for infinity at its right end where some costs are infinite."""

    lo: float
    hi: float
    infinity: float  # NaN: none is infinite

    def at(self, x: float) -> float:
        return self.infinity if math.isinf(x) and not math.isnan(self.infinity) else x


def _cost_axis(panels: Sequence[Sequence[_Row]]) -> _CostAxis:
    values: List[float] = []
    infinite = False
    for rows in panels:
        for row in rows:
            shown = list(row.values[~np.isnan(row.values)])
            if row.median.bounded:
                shown += [row.median.lo, row.median.hi]
            values += shown
            infinite = infinite or any(math.isinf(x) and x > 0 for x in shown)
    lo, hi = _style.span(values, 1.25, 8)
    if not infinite:
        return _CostAxis(lo, hi, math.nan)
    end = hi * (hi / lo) ** 0.14
    return _CostAxis(lo, end, hi * (end / hi) ** 0.5)


def _dots(count: int) -> "np.ndarray[Any, Any]":
    """Where the dots of runs lie about their row: beside each other, where the costs are equal."""
    return (np.arange(count) * 0.618034 % 1 - 0.5) * 0.44


def _costs_panel(ax: Any, rows: Sequence[_Row], results: Results, axis: _CostAxis, names: Sequence[str],
                 labelled: bool, columns: Tuple[float, float]) -> None:
    if not math.isnan(axis.infinity):
        _style.log_axis(ax, axis.lo, axis.hi, extra=(axis.infinity, "∞"))
    else:
        _style.log_axis(ax, axis.lo, axis.hi)
    _style.rows_axis(ax, names, labelled)
    for y, row in enumerate(rows):
        colour = _style.look(results, row.strategy).colour
        known = np.sort(row.values[~np.isnan(row.values)])
        at = np.array([axis.at(x) for x in known])
        ax.plot(at, y + _dots(len(at)), "o", markersize=2.0, markeredgewidth=0, color=colour,
                alpha=min(0.45, max(0.12, 12 / max(1, len(at)))), zorder=2)
        middle = row.median
        if middle.bounded:
            ends = [max(middle.lo, axis.lo), min(axis.at(middle.hi), axis.hi)]
            ax.plot(ends, [y, y], color=colour, linewidth=1.5, solid_capstyle="butt", zorder=3)
        if not math.isnan(middle.value):
            ax.plot([axis.at(middle.value)] * 2, [y - 0.32, y + 0.32], color=colour, linewidth=2.0,
                    solid_capstyle="butt", zorder=4)
        _style.words(ax, 1, y, row.number, columns[0], ha="right", color=colour)
        if columns[1] == columns[0]:
            continue
        incomplete = row.solved.split("/")[0] != row.solved.split("/")[-1]
        _style.words(ax, 1, y, row.solved, columns[1], ha="right", color=INK if incomplete else GREY)


def costs(document: Document, *, problem: Problem = None, strategies: Strategies = None,
          cost: str = "validity_checks", together: bool = False, ax: Any = None) -> Any:
    """What does each strategy cost? A row for each: a dot for each run, a tick for the median, a bar for its 95 %
    interval; at the right the median, and the numbers of solved runs and of runs. A run without a path costs infinitely
    much: its dot is at ∞.

    document:   what `read` takes.
    problem:    one or several names of problems, a panel each (default all; more than 12: all together in one panel).
    strategies: names of strategies (default all); their order is that of `Results.strategies`.
    cost:       "validity_checks" until the first path, "motion_checks", or "time_s", drawn in milliseconds.
    together:   whether the runs of all problems are in one panel (default False).
    ax:         axes to draw in, one for each panel (default those of a new figure, 86 mm wide for one panel, else
                178 mm).

    Returns the axes: one, or an array of several. Raises `Error` for an unknown name, and for another number of axes.
    """
    check_cost(cost, tuple(_LABELS))
    results = read(document)
    names = results.chosen(strategies)
    need_runs(results, names)
    problems = chosen_problems(results, problem, together, 12)
    panels = [_rows(results, one, names, cost) for one in problems]
    axis = _cost_axis(panels)
    count, columns = len(problems), columns_of(len(problems))
    width = COLUMN if count == 1 else PAGE
    first = 2 + _style.width_of(["median"] + [row.number for rows in panels for row in rows], SMALL)
    shares = {row.solved for rows in panels for row in rows}
    alike = count > 1 and len(shares) == 1 and len(set(next(iter(shares)).split("/"))) == 1
    second = first if alike else first + 1.8 + _style.width_of(["solved", *shares], SMALL)
    with _style.styled():
        axes = _style.given(ax, count, "costs")
        own = axes is None
        labels = [_style.cut(name, 0.3 * width if count == 1 else 0.2 * width) for name in names]
        margins = Margins(left=max(_style.width_of(labels) + 3, 9), right=second + 0.8, top=5.6, bottom=8.4,
                          wide=second + 3.5, high=7.5)
        if axes is None:
            rows = math.ceil(count / columns)
            spare = _style.HIGHEST - margins.top - margins.bottom - margins.high * (rows - 1)
            row = min(5.0, max(2.6, spare / rows / len(names)))
            height = rows * row * len(names) + margins.top + margins.bottom + margins.high * (rows - 1)
            axes = _style.place("costs", width, height, count, columns, margins)
        for i, one in enumerate(axes):
            _costs_panel(one, panels[i], results, axis, labels, not own or i % columns == 0, (first, second))
            heads = i < columns or not own
            free = _style.size_of(one)[0] + (first - _style.width_of(["median"], SMALL) - 1.5 if heads else first)
            one.set_title(_style.cut(title(results, problems[i]), free))
            if own and i + columns < count:
                one.set_xticklabels([])
            if heads:
                _style.above(one, 1, "median", first, ha="right")
                if not alike:
                    _style.above(one, 1, "solved", second, ha="right")
        runs = f" ({shares.pop().split('/')[0]} runs each, all solved)" if alike else ""
        _style.below(axes, _LABELS[cost] + runs, own, margins)
    return _style.returned(axes)


# Success -------------------------------------------------------------------------------------------------------------


def _first_paths(results: Results, problem: Optional[str], strategy: str, cost: str) -> "np.ndarray[Any, Any]":
    return np.sort(results.costs(problem, strategy, cost)) * _unit(cost)


def _success_panel(ax: Any, results: Results, problem: Optional[str], strategies: Sequence[str], cost: str) -> None:
    every = [x for strategy in strategies for x in _first_paths(results, problem, strategy, cost) if math.isfinite(x)]
    longest = max(results.spent(problem, strategy, cost) for strategy in strategies) * _unit(cost)
    lo, hi = _style.span(every, 1.3, 8)
    if longest > hi and longest > 0:
        hi = longest * 1.05
    _style.log_axis(ax, lo, hi)
    for strategy in reversed(strategies):
        look = _style.look(results, strategy)
        found = _first_paths(results, problem, strategy, cost)
        if len(found) == 0:
            continue
        solved = found[np.isfinite(found)]
        at = np.concatenate([[lo], solved, [hi]])
        reached = np.concatenate([[0], np.arange(1, len(solved) + 1), [len(solved)]])
        ax.step(at, reached / len(found), where="post", color=look.colour, linestyle=look.dash, linewidth=1.3,
                zorder=3 if look.dash == "-" else 3.5, solid_joinstyle="miter", clip_on=False)
        if len(strategies) <= 2:
            low, high = wilson(reached, len(found))
            ax.fill_between(at, low, high, step="post", color=look.colour, alpha=0.13, linewidth=0, zorder=1)
    ax.set_ylim(0, 1)
    ax.set_yticks([0, 0.5, 1])
    ax.grid(axis="y", color=FAINT, linewidth=0.5)


def success(document: Document, *, problem: Problem = None, strategies: Strategies = None,
            cost: str = "validity_checks", together: bool = False, ax: Any = None) -> Any:
    """How likely is a path by a number of checks? The share of the runs that found their first path by then, in steps,
    one dash for each strategy. With two strategies at most, bands: Wilson's 95 % interval of the share. A panel ends
    where the longest run ended.

    The arguments, what it returns and what it raises are those of `costs`; new figures are 86 x 52 mm for one panel,
    and 178 mm wide for several.
    """
    check_cost(cost, tuple(_LABELS))
    results = read(document)
    names = results.chosen(strategies)
    need_runs(results, names)
    problems = chosen_problems(results, problem, together, 12)
    count, columns = len(problems), columns_of(len(problems))
    width = COLUMN if count == 1 else PAGE
    entries = [Entry(name, _style.look(results, name)) for name in names]
    with _style.styled():
        axes = _style.given(ax, count, "success")
        own = axes is None
        margins = Margins(left=10.5, right=4, bottom=8.4, wide=6, high=9,
                          top=_style.key_height(entries, width - 14, True) + (6.5 if count > 1 else 3))
        if axes is None:
            rows = math.ceil(count / columns)
            each = (37.0 if rows == 1 else 31.0) if rows < 3 else 24.0
            height = rows * each + margins.top + margins.bottom + margins.high * (rows - 1)
            axes = _style.place("success", width, height, count, columns, margins)
            _style.key(axes[0].figure, entries, 10.5, width - 14, True)
        for i, one in enumerate(axes):
            _success_panel(one, results, problems[i], names, cost)
            one.set_yticklabels(["0", "50 %", "100 %"] if not own or i % columns == 0 else [])
            if own and count > 1:
                one.set_title(_style.cut(title(results, problems[i]), _style.size_of(one)[0] + 3), pad=4.5)
            elif not own:
                _style.inner_key(one, entries, True)
        _style.below(axes, f"share of runs solved by this number of {_SHORT[cost]}", own, margins)
    return _style.returned(axes)


# Forests -------------------------------------------------------------------------------------------------------------


class Forest(NamedTuple):
    """A row of a forest plot."""

    y: float
    ratio: Interval
    look: _style.Look
    shown: bool
    bracket: float = math.nan  # the other end of a median that is known between two values


def forest_axis(ax: Any, rows: Sequence[Forest], tinted: str, dots: Sequence[float] = ()) -> Tuple[float, float]:
    """Makes x the logarithmic axis of ratios, and returns its ends: it has all finite medians and dots, and intervals
    up to ten times beyond them. One half is tinted: "left" or "right" of 1."""
    medians = [x for x in [*(row.ratio.value for row in rows), *dots] if 0 < x < math.inf] + [1.0]
    ends = [end for row in rows if row.ratio.bounded for end in (row.ratio.lo, row.ratio.hi)]
    lo, hi = min(medians), max(medians)
    ends = [end for end in ends if lo / 10 <= end <= hi * 10]
    lo, hi = min([lo] + ends) / 1.25, max([hi] + ends) * 1.25
    lo, hi = min(lo, 0.45), max(hi, 2.2)
    _style.log_axis(ax, lo, hi, _style.plain)
    ax.axvspan(*((lo, 1) if tinted == "left" else (1, hi)), color=_style.TINT, alpha=0.05, linewidth=0, zorder=0)
    ax.axvline(1, color=INK, linewidth=0.7, zorder=1)
    return lo, hi


def draw_forest(ax: Any, rows: Sequence[Forest], lo: float, hi: float) -> None:
    """Intervals, with arrows where they leave the axis; medians, filled where a difference is shown."""
    for row in rows:
        ratio, colour = row.ratio, row.look.colour
        if ratio.bounded:
            ends = [min(max(ratio.lo, lo), hi), max(min(ratio.hi, hi), lo)]
            ax.plot(ends, [row.y, row.y], color=colour, linewidth=1.2, solid_capstyle="butt", zorder=2)
            for beyond, end, mark in ((ratio.lo < lo, lo, "<"), (ratio.hi > hi, hi, ">")):
                if beyond:
                    ax.plot(end, row.y, mark, markersize=3.4, markeredgewidth=0, color=colour, clip_on=False, zorder=3)
        if math.isnan(ratio.value):
            continue
        if lo <= ratio.value <= hi:
            at, mark = ratio.value, row.look.mark
        else:  # an infinite median, or 0: an arrow in place of the mark
            at, mark = (lo, "<") if ratio.value < lo else (hi, ">")
        ax.plot(at, row.y, mark, markersize=3.8 if mark == row.look.mark else 5, markeredgewidth=0.9,
                markeredgecolor=colour, markerfacecolor=colour if row.shown else "white", zorder=4, clip_on=False)


def _ratio_text(ratio: Interval) -> str:
    if math.isnan(ratio.value):
        return "–"
    if not ratio.bounded:
        return _style.digits(ratio.value)
    return f"{_style.digits(ratio.value)} [{_style.digits(ratio.lo)}, {_style.digits(ratio.hi)}]"


_GAP = 0.8  # between problems, in rows
_BESIDE = {
    "baseline": ("those of {}", "a baseline and another strategy"),
    "own_planner": ("those of its planner alone", "a strategy with guides and its planner without them"),
    "best_part": ("those of its better part", "a strategy with two guides and a part of it with one"),
}


def _ratio_rows(results: Results, found: Ratios, problems: Sequence[Optional[str]],
                names: Sequence[str]) -> List[List[Forest]]:
    return [
        [
            Forest(i * (len(names) + _GAP) + j, found.of(one, name), _style.look(results, name),
                   found.shown.get((one, name), False))
            for j, name in enumerate(names)
        ]
        for i, one in enumerate(problems)
    ]


def _problem_dots(results: Results, found: Ratios, problems: Sequence[Optional[str]],
                  names: Sequence[str]) -> List[Tuple[float, float, bool]]:
    """Where all problems are one row: of each problem its row, its median and whether the strategies were tuned on it.
    """
    if list(problems) != [None] or len(results.problems) < 2:
        return []
    tuned = {one["name"]: bool(one.get("tuned")) for one in results.document["experiment"]["problems"]}
    return [(float(j), found.of(one, name).value, tuned[one]) for j, name in enumerate(names)
            for one in results.problems if not math.isnan(found.of(one, name).value)]


def _draw_dots(ax: Any, results: Results, dots: Sequence[Tuple[float, float, bool]], names: Sequence[str], lo: float,
               hi: float) -> None:
    """A light dot for each problem, a ring for one that the strategies were tuned on; at the ends those beyond."""
    for j, name in enumerate(names):
        its = [(ratio, tuned) for row, ratio, tuned in dots if row == j]
        beside = _dots(len(its)) * 1.5
        colour = _style.look(results, name).colour
        for (ratio, tuned), shift in zip(its, beside):
            at, mark = (lo, "<") if ratio < lo else (hi, ">") if ratio > hi else (ratio, "o")
            ax.plot(at, j + shift, mark, markersize=2.6 if mark == "o" else 3.0, color=colour, alpha=0.4, zorder=1.5,
                    markerfacecolor="none" if tuned else colour, markeredgewidth=0.6 if tuned else 0, clip_on=False)


def _ratios_panel(ax: Any, results: Results, found: Ratios, problems: Sequence[Optional[str]], names: Sequence[str],
                  labels: Sequence[str], every: Sequence[Forest]) -> None:
    groups = _ratio_rows(results, found, problems, names)
    rows = [row for group in groups for row in group]
    dots = _problem_dots(results, found, problems, names)
    lo, hi = forest_axis(ax, every, "left", [ratio for _, ratio, _ in dots])
    ax.grid(axis="x", color=FAINT, linewidth=0.5)
    _draw_dots(ax, results, dots, names, lo, hi)
    draw_forest(ax, rows, lo, hi)
    for i in range(1, len(problems)):
        ax.axhline(i * (len(names) + _GAP) - 0.5 - _GAP / 2, color=FAINT, linewidth=0.5)
    ax.set_ylim(rows[-1].y + 0.7, -0.7)
    if len(problems) == 1:
        ax.set_yticks([row.y for row in rows])
    else:
        ax.set_yticks([(group[0].y + group[-1].y) / 2 for group in groups])
    ax.set_yticklabels(labels)
    ax.tick_params(axis="y", length=0, pad=4)
    ax.spines["left"].set_visible(False)
    for row in rows:
        _style.words(ax, 1, row.y, _ratio_text(row.ratio), 2.2, ha="left", color=INK if row.shown else GREY)
    one = math.log(1 / lo) / math.log(hi / lo)
    _style.above(ax, one, "← costs less", -1, ha="right")
    _style.above(ax, one, "more →", 1, ha="left")


def ratios(document: Document, *, problem: Problem = None, strategies: Strategies = None, against: str = "baseline",
           cost: str = "validity_checks", together: bool = False, ax: Any = None) -> Any:
    """Does guidance pay? A forest plot of the validity checks divided by the reference's on the same seed: the median,
    with its 95 % interval. Left of 1, tinted, the strategy costs less. A mark is filled where the sign test, corrected
    by Holm over the comparisons, shows a difference (5 %). An arrow ends an interval that continues beyond the axis; in
    place of a mark: the median is infinite, or 0. Where several problems are one row, light dots are the medians of the
    problems, rings of those that the strategies were tuned on.

    problem:  one or several names of problems, one below the other (default all; more than 24: all together).
    against:  the reference: "baseline"; "own_planner", the strategy of the document that is the same planner without
              guides; or "best_part", of a strategy with several guides the cheaper of the strategies with a part of
              them (default "baseline").
    cost:     "validity_checks" until the first path, or "cpu_s", the CPU time of runs (default "validity_checks").
    together: whether the seeds of all problems count together (default False).
    ax:       axes to draw in, one, or two for many rows (default those of a new figure, 86 mm wide; many rows are in
              two columns of 178 mm).

    The other arguments, what it returns and what it raises are those of `costs`; `Error` also where the document has no
    reference.
    """
    check_against(against)
    check_cost(cost, ("validity_checks", "cpu_s"))
    results = read(document)
    beside, needed = _BESIDE[against]
    given = [name for name in results.chosen(strategies) if against != "baseline" or name != results.baseline]
    if not results.baseline or not given:
        raise Error(f"{results.file}: ratios need a baseline and another strategy")
    found = ratios_of(results, against, cost)
    problems = chosen_problems(results, problem, together, 24)
    names = [name for name in given if against == "baseline" or any((one, name) in found.ratio for one in problems)]
    if not names:
        raise Error(f"{results.file}: ratios beside {against} need {needed}")
    total = len(problems) * (len(names) + _GAP)
    several = len(problems) > 1
    entries = [Entry(name, _style.look(results, name)) for name in names] if several else []
    halves = [list(problems)]
    if ax is None and total * 2.6 > 98 and several or ax is not None and not hasattr(ax, "get_xlim"):
        middle = (len(problems) + 1) // 2
        halves = [list(problems[:middle]), list(problems[middle:])]
    width = COLUMN if len(halves) == 1 else PAGE
    texts = _style.width_of([_ratio_text(found.of(one, name)) for one in problems for name in names], SMALL)
    with _style.styled():
        axes = _style.given(ax, len(halves), "ratios")
        own = axes is None
        labels = [[_style.cut(title(results, one) if several else name, 24)
                   for one in half for name in ([""] if several else names)] for half in halves]
        left = max(_style.width_of([label for half in labels for label in half]) + 3.5, 8)
        margins = Margins(left=left, right=texts + 3.2, bottom=8.4, wide=left + texts + 5,
                          top=4.2 + (_style.key_height(entries, width - 4, False) + 1.5 if several else 0))
        if axes is None:
            rows = max(len(half) for half in halves) * (len(names) + _GAP) - _GAP + 1.4
            frame = margins.top + margins.bottom
            most = 3.2 if several else 5.0 if _problem_dots(results, found, problems, names) else 4.2
            row = max(2.3, min(most, (120 - frame) / rows))
            axes = _style.place("ratios", width, rows * row + frame, len(halves), len(halves), margins)
            if several:
                _style.key(axes[0].figure, entries, 2, width - 4, False)
        elif several:
            for one in axes:
                _style.inner_key(one, entries, False, 3.4)
        every = [row for group in _ratio_rows(results, found, problems, names) for row in group]
        for one, half, its in zip(axes, halves, labels):
            _ratios_panel(one, results, found, half, names, its, every)
            if own and len(half) < len(halves[0]):  # rows as high as those of the other column
                one.set_ylim(axes[0].get_ylim())
        beside = beside.format(results.baseline)
        if cost == "cpu_s":
            beside = beside.replace("those", "that", 1)
        label = f"{'CPU time' if cost == 'cpu_s' else 'checks'} ÷ {beside}"
        _style.below(axes, f"{label}, same seeds", own, margins)
    return _style.returned(axes)


# Levels --------------------------------------------------------------------------------------------------------------


class LevelVerdict(NamedTuple):
    """What the runs without a guide show."""

    strategy: str
    key: str
    guide: str
    ratio: Interval  # checks without the guide divided by those with it; NaN: not tested
    least: bool  # the median is at least this: runs without the guide were stopped before they found a path
    verdict: str
    pairs: int


def verdicts(results: Results, problem: Optional[str]) -> List[LevelVerdict]:
    """The verdicts on all guides of all strategies on a problem, or on all problems together (None)."""
    found = []
    for strategy in results.strategies:
        entry = results.summary(problem, strategy)
        if entry is None:
            continue
        guides: List[Mapping[str, Any]] = [dict(level, guide=level["name"]) for level in entry["levels"]]
        for guide in guides + list(entry.get("guides_without_level", [])):
            verdict = guide.get("verdict")
            if not verdict:
                continue
            ratio = verdict.get("ratio")
            least = False
            without = Interval()
            if ratio:
                middle, interval = ratio["median"], ratio["interval"]
                low, high = number(middle["lo"]), number(middle["hi"])
                least = low != high
                without = Interval(high, number(interval["lo"]), number(interval["hi"])).inverse()
            found.append(LevelVerdict(strategy, str(guide["key"]), str(guide["guide"]), without, least,
                                      str(verdict["verdict"]), int(verdict.get("pairs") or 0)))
    return found


def verdict_text(one: LevelVerdict) -> str:
    """What to do with the guide."""
    if one.verdict in ("pays", "costs") and abs(math.log(one.ratio.value)) < math.log(1.1):
        return "hardly matters"
    known = {"pays": "keep", "costs": "drop", "no difference": "hardly matters"}
    return known.get(one.verdict, one.verdict)


def _without(one: LevelVerdict) -> str:
    if math.isnan(one.ratio.value):
        return "–"
    return ("≥ " if one.least else "") + _style.digits(one.ratio.value)


Place = Tuple[str, str, str]


def _levels_panel(ax: Any, found: Mapping[Place, LevelVerdict], places: Sequence[Place], results: Results,
                  labels: Sequence[str], labelled: bool, every: Sequence[Forest], column: float, said: bool) -> None:
    lo, hi = forest_axis(ax, every, "right")
    _style.rows_axis(ax, labels, labelled)
    rows = []
    for y, place in enumerate(places):
        one = found.get(place)
        if one is None:
            continue
        shown = one.verdict in ("pays", "costs")
        rows.append(Forest(y, one.ratio, _style.look(results, one.strategy), shown))
        colour = INK if shown else GREY
        _style.words(ax, 1, y, _without(one), column, ha="right", color=colour)
        if said:
            _style.words(ax, 1, y, verdict_text(one), column + 1.8, ha="left", color=colour)
    draw_forest(ax, rows, lo, hi)


def levels(document: Document, *, problem: Problem = None, strategies: Strategies = None, together: bool = False,
           ax: Any = None) -> Any:
    """Which guide earns its place? The validity checks without a guide divided by those with it, on the same seeds: the
    median with its interval. Right of 1, tinted, the guide pays: keep it. A mark is filled where the sequential test
    shows a difference; an arrow ends an interval that continues beyond the axis; "≥": runs without the guide were
    stopped at so many times the checks.

    The arguments, what it returns and what it raises are those of `costs`; new figures are 86 mm wide for one panel,
    and 178 mm for several. `Error` also where no guide was tested: with `--ablation 0`, or without guides.
    """
    results = read(document)
    names = results.chosen(strategies)
    problems = chosen_problems(results, problem, together, 12)
    found = [{(one.strategy, one.key, one.guide): one for one in verdicts(results, each) if one.strategy in names}
             for each in problems]
    every = [one for panel in found for one in panel.values()]
    places = [place for place in dict.fromkeys(place for panel in found for place in panel)
              if any(not math.isnan(panel[place].ratio.value) for panel in found if place in panel)]
    places.sort(key=lambda place: names.index(place[0]))
    if not places:
        raise Error(f"{results.file}: no guide was tested; run with --ablation 2")
    single = len({place[0] for place in places}) == 1
    count, columns = len(problems), columns_of(len(problems))
    width = COLUMN if count == 1 else PAGE
    said = count == 1
    number_column = 1.8 + _style.width_of([_without(one) for one in every], SMALL)
    words = 2 + _style.width_of([verdict_text(one) for one in every], SMALL) if said else 0.0
    right = number_column + words + 0.8

    def labelled(most: float) -> Tuple[List[str], float]:
        labels = [_style.cut(f"{'' if single else place[0] + ' '}without {_style.short_guide(place[2])}", most)
                  for place in places]
        return labels, _style.width_of(labels) + 3

    with _style.styled():
        axes = _style.given(ax, count, "levels")
        own = axes is None
        labels, left = labelled(0.42 * COLUMN if count == 1 else 0.3 * PAGE)
        if own and width - left - right < 26 and count == 1:  # no room for intervals in a column
            width = PAGE
            labels, left = labelled(0.3 * PAGE)
        margins = Margins(left=left, right=right, top=4.2 if count == 1 else 5.6, bottom=8.4, wide=number_column + 3,
                          high=7.5)
        if axes is None:
            rows = math.ceil(count / columns)
            spare = _style.HIGHEST - margins.top - margins.bottom - margins.high * (rows - 1)
            row = min(5.6 if count == 1 else 4.2, max(2.6, spare / rows / len(places)))
            height = rows * row * len(places) + margins.top + margins.bottom + margins.high * (rows - 1)
            axes = _style.place("levels", width, height, count, columns, margins)
        forest = [Forest(0, one.ratio, _style.nth(0), False) for one in every]
        for i, one in enumerate(axes):
            _levels_panel(one, found[i], places, results, labels, not own or i % columns == 0, forest, number_column,
                          said)
            if count > 1:
                free = _style.size_of(one)[0] - _style.width_of(["keep →"], SMALL) - 1.5
                one.set_title(_style.cut(title(results, problems[i]), free))
                _style.above(one, 1, "keep →", ha="right")
            else:
                lo, hi = one.get_xlim()
                at = math.log(1 / lo) / math.log(hi / lo)
                _style.above(one, at, "keep →", 1, ha="left")
                _style.above(one, at, "← drop", -1, ha="right")
            if own and i + columns < count:
                one.set_xticklabels([])
        _style.below(axes, "checks without the guide ÷ with it, same seeds", own, margins)
    return _style.returned(axes)


def supported_levels(results: Results) -> bool:
    """Whether some guide was tested."""
    found: Dict[str, bool] = {}
    problems: List[Optional[str]] = [None]
    if len(results.problems) <= 12:
        problems = list(results.problems)
    for problem in problems:
        for one in verdicts(results, problem):
            found[one.strategy] = found.get(one.strategy, False) or not math.isnan(one.ratio.value)
    return any(found.values())

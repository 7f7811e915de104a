# SPDX-License-Identifier: MIT-0
"""The statistics of tables and figures that a document does not have, by the definitions of the program: a run without
a path costs infinitely much, and intervals are of 95 %."""
from __future__ import annotations

import math
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ._document import Interval

_LEAST_FOR_INTERVAL = 5
_EACH_SIDE = 0.975
_NORMAL = 1.959963984540054  # the normal quantile of _EACH_SIDE

LEAST_GROUPS_FOR_INTERVAL = 6
_LEAST_PAIRS = 3
_SAMPLES = 10000


def median(values: Sequence[float]) -> float:
    """The median, infinite values included; NaN of none."""
    ordered = sorted(value for value in values if not math.isnan(value))
    if not ordered:
        return math.nan
    upper = ordered[len(ordered) // 2]
    lower = ordered[(len(ordered) - 1) // 2]
    return upper if upper == lower else 0.5 * (lower + upper)


def _place_of_bound(count: int) -> int:
    """The least k such that of `count` fair coins fewer than k show heads with a probability of 97.5 %."""
    below = 0
    for k in range(1, count + 1):
        below += math.comb(count, k - 1)
        if below >= _EACH_SIDE * 2**count:
            return k
    return count + 1


def median_interval(values: Sequence[float]) -> Interval:
    """The median with its distribution-free 95 % interval by order statistics; no interval of fewer than 5 values."""
    known = sorted(value for value in values if not math.isnan(value))
    if len(known) < _LEAST_FOR_INTERVAL:
        return Interval(median(known))
    place = _place_of_bound(len(known))
    if place > len(known):
        return Interval(median(known), -math.inf, math.inf)
    return Interval(median(known), known[len(known) - place], known[place - 1])


def wilson(successes: "np.ndarray[Any, Any]", trials: int) -> Tuple["np.ndarray[Any, Any]", "np.ndarray[Any, Any]"]:
    """The ends of Wilson's 95 % interval of a share."""
    share = np.asarray(successes, float) / trials
    z = _NORMAL
    centre = share + z * z / (2 * trials)
    half = z * np.sqrt(share * (1 - share) / trials + z * z / (4 * trials * trials))
    scale = 1 + z * z / trials
    return np.where(share == 0, 0.0, (centre - half) / scale), np.where(share == 1, 1.0, (centre + half) / scale)


def sign_test(less: int, greater: int) -> float:
    """The p value of the two-sided sign test."""
    count = less + greater
    if count == 0:
        return 1.0
    tail = sum(math.comb(count, k) for k in range(min(less, greater) + 1))
    return float(min(1.0, 2 * tail / 2**count))


def holm(p: Sequence[float]) -> List[float]:
    """The p values with Holm's correction. NaN stays NaN, and counts as no test."""
    order = sorted((i for i, value in enumerate(p) if not math.isnan(value)), key=lambda i: p[i])
    adjusted = list(p)
    largest = 0.0
    for k, i in enumerate(order):
        largest = max(largest, min(1.0, (len(order) - k) * p[i]))
        adjusted[i] = largest
    return adjusted


def _divided(cost: float, by: float) -> float:
    if math.isnan(cost) or math.isnan(by):
        return math.nan
    if cost == by:
        return 1.0
    return cost / by if by > 0 else math.inf


class PairedCosts(NamedTuple):
    """The costs of a strategy and of its reference on the same seeds."""

    pairs: int
    solved: int
    reference_solved: int
    both_solved: int
    median: float
    reference_median: float
    ratio_of_medians: float
    ratio_of_totals: float
    ratio: Interval
    sign_p: float
    effect: float


def paired_costs(mine: Mapping[Any, float], reference: Mapping[Any, float]) -> PairedCosts:
    """Compares costs by seed: infinite without a path, NaN where a run has no value. Leaves out seeds of one alone."""
    left: List[float] = []
    right: List[float] = []
    ratios: List[float] = []
    for seed, cost in mine.items():
        other = reference.get(seed, math.nan)
        ratio = _divided(cost, other)
        if not math.isnan(ratio):
            left.append(cost)
            right.append(other)
            ratios.append(ratio)
    found = median_interval(ratios)
    found.lo = max(found.lo, 0.0) if not math.isnan(found.lo) else found.lo
    less = sum(1 for ratio in ratios if ratio < 1)
    greater = sum(1 for ratio in ratios if ratio > 1)
    mid, other_mid = median(left), median(right)
    total, other_total = sum(left), sum(right)
    none = not ratios or (math.isinf(total) and math.isinf(other_total))
    return PairedCosts(
        pairs=len(ratios),
        solved=sum(1 for cost in left if math.isfinite(cost)),
        reference_solved=sum(1 for cost in right if math.isfinite(cost)),
        both_solved=sum(1 for a, b in zip(left, right) if math.isfinite(a) and math.isfinite(b)),
        median=mid,
        reference_median=other_mid,
        ratio_of_medians=_divided(mid, other_mid) if math.isfinite(mid) or math.isfinite(other_mid) else math.nan,
        ratio_of_totals=math.nan if none else _divided(total, other_total),
        ratio=found,
        sign_p=sign_test(less, greater),
        effect=(less - greater) / len(ratios) if ratios else math.nan,
    )


# Rank correlation within groups --------------------------------------------------------------------------------------


class GroupCorrelation(NamedTuple):
    """Spearman's rank correlation within groups."""

    rho: Interval
    counted: int
    resampled: "np.ndarray[Any, Any]"


def _ranks(values: "np.ndarray[Any, Any]") -> "np.ndarray[Any, Any]":
    """Ranks from 1; ties share their mean."""
    below = (values[None, :] < values[:, None]).sum(axis=1)
    equal = (values[None, :] == values[:, None]).sum(axis=1)
    return np.asarray(below + 0.5 * (equal + 1))


def _sums(a: Sequence[float], b: Sequence[float]) -> Tuple[float, float, float]:
    """The sums of products of the scaled ranks; zeros for a group that does not count."""
    pairs = np.array([(x, y) for x, y in zip(a, b) if not math.isnan(x) and not math.isnan(y)], float).reshape(-1, 2)
    if len(pairs) < _LEAST_PAIRS:
        return 0.0, 0.0, 0.0
    x, y = ((_ranks(pairs[:, k]) - 1) / (len(pairs) - 1) - 0.5 for k in range(2))
    ab, aa, bb = float(x @ y), float(x @ x), float(y @ y)
    return (ab, aa, bb) if aa > 0 and bb > 0 else (0.0, 0.0, 0.0)


def _hash(text: bytes) -> int:
    """FNV-1a, 64 bits."""
    value = 0xCBF29CE484222325
    for byte in text:
        value = ((value ^ byte) * 0x100000001B3) % 2**64
    return value


def _draws(count: int, below: int) -> "np.ndarray[Any, Any]":
    """Uniform integers of {0, ..., below - 1}: those of the program's bootstrap, by the same generator."""
    stream = np.random.Philox(key=_hash(b"\0bootstrap") << 64, counter=2**256 - 1)
    bits = stream.random_raw(count)
    low = (bits & np.uint64(0xFFFFFFFF)) * np.uint64(below) >> np.uint64(32)
    return np.asarray(((bits >> np.uint64(32)) * np.uint64(below) + low) >> np.uint64(32), dtype=np.int64)


def _rho(sums: "np.ndarray[Any, Any]") -> "np.ndarray[Any, Any]":
    ab, aa, bb = sums[..., 0], sums[..., 1], sums[..., 2]
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where((aa > 0) & (bb > 0), ab / np.sqrt(aa * bb), math.nan)


def _student_cdf(t: float, freedom: int) -> float:
    """Student's distribution function, of a whole number of degrees of freedom."""
    angle = math.atan(t / math.sqrt(freedom))
    square = math.cos(angle) ** 2
    if freedom % 2:
        term = total = math.cos(angle) if freedom > 1 else 0.0
        for k in range(3, freedom - 1, 2):
            term *= square * (k - 1) / k
            total += term
        return 0.5 + (angle + math.sin(angle) * total) / math.pi
    term = total = 1.0
    for k in range(2, freedom - 1, 2):
        term *= square * (k - 1) / k
        total += term
    return 0.5 + 0.5 * math.sin(angle) * total


def _student_quantile(share: float, freedom: int) -> float:
    lo, hi = 0.0, 1e4
    for _ in range(200):
        middle = 0.5 * (lo + hi)
        if _student_cdf(middle, freedom) < share:
            lo = middle
        else:
            hi = middle
    return 0.5 * (lo + hi)


def mean_interval(values: Sequence[float]) -> Interval:
    """The mean with Student's 95 % interval; no interval of fewer than 5 values."""
    known = [value for value in values if not math.isnan(value)]
    if not known:
        return Interval()
    count = len(known)
    mean = sum(known) / count
    if count < _LEAST_FOR_INTERVAL:
        return Interval(mean)
    squares = sum((value - mean) ** 2 for value in known)
    half = _student_quantile(_EACH_SIDE, count - 1) * math.sqrt(squares / (count - 1) / count)
    return Interval(mean, mean - half, mean + half)


def _percentiles(value: float, resampled: "np.ndarray[Any, Any]", groups: int) -> Interval:
    """The two ends by percentiles of the samples, expanded for few groups as Student's quantiles are."""
    known = np.sort(resampled[~np.isnan(resampled)])
    if groups < LEAST_GROUPS_FOR_INTERVAL or len(known) == 0:
        return Interval(value)
    quantile = math.sqrt(groups / (groups - 1)) * _student_quantile(_EACH_SIDE, groups - 1)
    tail = 0.5 * math.erfc(quantile / math.sqrt(2))
    last = len(known) - 1
    return Interval(value, float(known[math.floor(tail * last)]), float(known[math.ceil((1 - tail) * last)]))


def group_correlation(groups: Sequence[Tuple[Sequence[float], Sequence[float]]]) -> GroupCorrelation:
    """Spearman's rank correlation within groups of pairs, with a bootstrap's 95 % interval over the groups.

    Each group's values are replaced by their ranks there, scaled to [-1/2, 1/2], and the ranks of all groups are
    correlated together. A group of fewer than three pairs, or with a list of equal values, does not count.
    """
    sums = np.array([_sums(a, b) for a, b in groups], float).reshape(-1, 3)
    counted = int((sums[:, 1] > 0).sum())
    rho = float(_rho(sums.sum(axis=0)))
    if len(sums) == 0:
        return GroupCorrelation(Interval(), 0, np.zeros(0))
    picked = _draws(_SAMPLES * len(sums), len(sums)).reshape(_SAMPLES, len(sums))
    resampled = _rho(sums[picked].sum(axis=1))
    return GroupCorrelation(_percentiles(rho, resampled, counted), counted, resampled)


def correlation_difference(a: GroupCorrelation, b: GroupCorrelation) -> Interval:
    """The difference of two correlations over the same groups, with an interval of the same bootstrap."""
    return _percentiles(a.rho.value - b.rho.value, a.resampled - b.resampled, min(a.counted, b.counted))


# Strategies that differ in one number of one option ------------------------------------------------------------------


class Curve(NamedTuple):
    """Strategies that differ in one number."""

    name: str
    values: List[float]
    strategies: List[str]


def _numbers(value: Any, place: Tuple[Any, ...] = ()) -> List[Tuple[Tuple[Any, ...], float]]:
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return []
    if isinstance(value, Mapping):
        return [found for key, entry in value.items() for found in _numbers(entry, place + (key,))]
    if isinstance(value, list):
        return [found for key, entry in enumerate(value) for found in _numbers(entry, place + (key,))]
    return [(place, float(value))]


def _without(value: Any, place: Tuple[Any, ...]) -> Any:
    """The description with null at a place, as a value that compares."""
    if not place:
        return None
    if isinstance(value, Mapping):
        return {key: _without(entry, place[1:]) if key == place[0] else entry for key, entry in value.items()}
    return [_without(entry, place[1:]) if key == place[0] else entry for key, entry in enumerate(value)]


def _option(spec: Any, place: Tuple[Any, ...]) -> str:
    """ "scale of shrink" for the place of a number."""
    name = str(place[-1])
    for end in range(len(place) - 1, -1, -1):
        owner = spec
        for key in place[:end]:
            owner = owner[key]
        if isinstance(owner, Mapping):
            for kind in ("guide", "planner"):
                if isinstance(owner.get(kind), str):
                    return f"{name} of {owner[kind]}"
    return name


def sweeps(specs: Mapping[str, Any]) -> Dict[str, List[Curve]]:
    """The options that strategies differ in, each with its curves of at least three values.

    specs: the description of each strategy by its name, with every option.
    """
    places: Dict[Tuple[str, ...], List[Tuple[Any, Dict[float, str], Tuple[Any, ...]]]] = {}
    for name, spec in specs.items():
        if spec is None:
            continue
        for place, value in _numbers(spec):
            rest = _without(spec, place)
            alike = places.setdefault(tuple(str(key) for key in place), [])
            found = next((curve for other, curve, _ in alike if other == rest), None)
            if found is None:
                alike.append((rest, {value: name}, place))
            else:
                found.setdefault(value, name)
    options: Dict[str, List[Curve]] = {}
    for key in sorted(places):
        curves = [(curve, place) for _, curve, place in places[key] if len(curve) >= 3]
        for curve, place in curves:
            option = _option(specs[next(iter(curve.values()))], place)
            ordered = sorted(curve)
            options.setdefault(option, []).append(Curve(option, ordered, [curve[value] for value in ordered]))
    return options


def split_levels(text: str) -> List[str]:
    """The levels of a strategy's text, from the first guide to the planner: at each '>>' outside of brackets."""
    levels = [""]
    depth = 0
    quoted = False
    i = 0
    while i < len(text):
        char = text[i]
        if char == '"' and (i == 0 or text[i - 1] != "\\"):
            quoted = not quoted
        if not quoted:
            depth += (char in "({") - (char in ")}")
            if depth == 0 and text.startswith(" >> ", i):
                levels.append("")
                i += 4
                continue
        levels[-1] += char
        i += 1
    return levels


def references(texts: Mapping[str, str], strategy: str, against: str, baseline: str) -> List[str]:
    """The strategies that a strategy is compared with: the baseline, its own planner, or its parts."""
    if against == "baseline":
        return [] if strategy == baseline else [baseline]
    levels = split_levels(texts[strategy])
    guides = len(levels) - 1
    wanted: List[List[str]] = []
    if against == "own_planner":
        wanted = [levels[guides:]] if guides else []
    else:
        for split in range(1, guides):
            wanted += [levels[:split] + levels[-1:], levels[split:guides] + levels[-1:]]
    found: List[str] = []
    for parts in wanted:
        text = " >> ".join(parts)
        name: Optional[str] = next((other for other, its in texts.items() if its == text), None)
        if name is not None and name not in found:
            found.append(name)
    return found

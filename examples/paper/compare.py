#!/usr/bin/env python3
# SPDX-License-Identifier: MIT-0
"""Compares the results of examples/paper.lua, or of examples/parasol.lua, with the figures and sentences of the paper.

    trellis run examples/paper.lua --out DIR
    python3 examples/paper/compare.py DIR

Prints Markdown: both figures side by side, their rank correlations, and whether the results bear the sentences out.
Source of the published figures: Attali et al. 2022, Evaluating Guiding Spaces for Motion Planning, table 1.
"""
import csv
import json
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))

from trellis.columns import rows  # noqa: E402

SOURCE = "Attali et al. 2022, Evaluating Guiding Spaces for Motion Planning, table 1"

# Sampling efficiencies of the root in nats, by problem and strategy: of the tree, and of the expansion if there is one.
FIGURES = {
    "simple_passage": {
        "rrt": (32.147, 18.671), "lazy_prm": (11.395,), "dr_rrt": (6.115, 19.845), "irc": (13.797, 19.447)},
    "trap": {
        "rrt": (9.589, 7.547), "lazy_prm": (14.869,), "dr_rrt": (38.759, 57.244), "irc": (4.845, 21.612)},
    "cup": {
        "rrt": (8.539, 5.246), "lazy_prm": (6.992,), "dr_rrt": (5.834, 18.176), "irc": (3.829, 9.443)},
}

# Sentences: in a problem the efficiency of a strategy is lower (better) than that of others, or is not.
CLAIMS = (
    ("DR-RRT finds the passage without exploring the region",
     "simple_passage", "dr_rrt", True, ("rrt", "lazy_prm", "irc"), ("tree",)),
    ("shrinking makes impassable passages seem traversable: IRC does similarly or worse than RRT in Trap",
     "trap", "irc", False, ("rrt",), ("tree", "expansion")),
    ("DR-RRT does similarly or worse than RRT in Trap", "trap", "dr_rrt", False, ("rrt",), ("tree", "expansion")),
    ("LazyPRM does well in Cup", "cup", "lazy_prm", True, ("rrt",), ("tree",)),
)

ROLES = ("tree", "expansion")
TITLES = {"pooled": "all seeds together", "own": "own path", "cross": "other seeds' paths"}
FIELDS = {"own": "self", "cross": "cross"}  # of the document
HEADLINE = "headline"
FEWEST = 5  # seeds that give an interval, as in reports


def published(problem, strategy, role):
    """Returns the published figure; NaN without."""
    pair = FIGURES.get(problem, {}).get(strategy, ())
    at = ROLES.index(role)
    return pair[at] if at < len(pair) else math.nan


def escaped(text):
    """Returns a text for a cell of Markdown."""
    return "".join("\\" + c if c in "|\\`*_<>[]" else c for c in text)


def fixed(x):
    """Returns a number with two decimals."""
    text = f"{x:.2f}"
    return text.lstrip("-") if not text.strip("-0.") else text


def number(text):
    """Returns the number of a cell of CSV; NaN of an empty one."""
    return float(text) if text else math.nan


def row_of(cells):
    """Returns a row of a table."""
    return "| " + " | ".join(cells) + " |"


def head_of(cells):
    """Returns the head of a table."""
    return row_of(cells) + "\n|" + "---|" * len(cells)


def ranks(values):
    """Returns the rank of each value, the mean rank of equal ones."""
    return [sum(v < x for v in values) + 0.5 * (sum(v == x for v in values) - 1) for x in values]


def correlation(a, b):
    """Returns Spearman's rank correlation; NaN for fewer than three values, or where all are equal."""
    if len(a) < 3:
        return math.nan
    a, b = ranks(a), ranks(b)
    mean = 0.5 * (len(a) - 1)
    a, b = [x - mean for x in a], [x - mean for x in b]
    size = math.sqrt(sum(x * x for x in a) * sum(y * y for y in b))
    return sum(x * y for x, y in zip(a, b)) / size if size > 0.0 else math.nan


def student_probability(t, degrees):
    """Returns the probability that |T| <= t, T of Student's distribution (Abramowitz and Stegun 26.7.3, 26.7.4)."""
    angle = math.atan(t / math.sqrt(degrees))
    term, total = (math.cos(angle), 0.0) if degrees % 2 else (1.0, 0.0)
    for i in range(2 + degrees % 2, degrees + 1, 2):
        total += term
        term *= math.cos(angle) ** 2 * (i - 1) / i
    total *= math.sin(angle)
    return 2.0 / math.pi * (angle + total) if degrees % 2 else total


def student_quantile(degrees):
    """Returns t with |T| <= t at 95 %."""
    lo, hi = 0.0, 1e3
    for _ in range(100):
        middle = 0.5 * (lo + hi)
        lo, hi = (middle, hi) if student_probability(middle, degrees) < 0.95 else (lo, middle)
    return lo


class Results:
    """The figures of a folder of `trellis run --out`."""

    def __init__(self, folder):
        document = json.loads((folder / "results.json").read_text(encoding="utf-8"))
        experiment = document["experiment"]
        self.problems = [problem["name"] for problem in experiment["problems"]]
        self.strategies = [strategy["name"] for strategy in experiment["strategies"]]
        with open(folder / "table.csv", encoding="utf-8") as file:
            cells = [row for row in csv.DictReader(file) if row["quantity"] == "SE"]
        self.paths = list(dict.fromkeys(row["path"] for row in cells))
        self.estimators = list(dict.fromkeys(row["estimator"] for row in cells))
        self.shown = {
            (row["problem"], row["strategy"], row["role"], row["path"]):
                (number(row["value"]), number(row["lo"]), number(row["hi"]))
            for row in cells if row["estimator"] == HEADLINE}
        self.runs = {}
        for place, run in enumerate(document["runs"]):
            self.runs.setdefault((run["problem"], run["strategy"]), []).append(place)
        self.pooled = {(row["problem"], row["strategy"], row["role"]): row
                       for row in rows(document["pooled"]) if row["key"] == "0"}
        self.measure = {(row["run"], row["role"], row["path"]): row
                        for row in rows(document["measure"]) if row["level"] == 0}

    @staticmethod
    def estimate(measured, estimator):
        """Returns SE of a measured set by an estimator; NaN without."""
        if not measured:
            return math.nan
        if estimator in (HEADLINE, measured.get("estimator")):
            value = measured.get("SE")
        else:
            value = dict(measured.get("others") or {}).get(estimator)
        return math.nan if value is None else float(value)

    def of_runs(self, problem, strategy, role, path, estimator):
        """Returns SE of each run, in the order of seeds; NaN where it has none."""
        values = []
        for run in self.runs.get((problem, strategy), []):
            values.append(self.estimate(self.measure.get((run, role, FIELDS[path])), estimator))
        return values

    def compared(self, problem, strategy, role, path, estimator):
        """Returns the figure that is compared: of the headline the middle of what the samples support; NaN without."""
        if estimator == HEADLINE:
            return self.shown[problem, strategy, role, path][0]
        if path == "pooled":
            return self.estimate(self.pooled.get((problem, strategy, role)), estimator)
        values = [x for x in self.of_runs(problem, strategy, role, path, estimator) if not math.isnan(x)]
        return sum(values) / len(values) if values else math.nan


def supported(interval):
    """Returns the SE that the samples support, as text."""
    value, lo, hi = interval
    if math.isnan(lo):
        return "NA"
    if math.isnan(value):
        return "blank"
    return fixed(lo) if fixed(lo) == fixed(hi) else f"{fixed(lo)} to {fixed(hi)}"


def verdict(lo, hi, lower, figures):
    """Returns whether a difference with this interval bears a sentence out, and its figures."""
    if lower:
        said = "yes" if hi < 0.0 else "**no**" if lo > 0.0 else "open"
    else:
        said = "**no**" if hi < 0.0 else "yes"
    return f"{said}: {figures}"


def verdict_of_runs(mine, theirs, lower):
    """The verdict of the difference mine - theirs, paired by seed."""
    pairs = [x - y for x, y in zip(mine, theirs) if not math.isnan(x - y)]
    if not pairs:
        return "NA"
    mean = sum(pairs) / len(pairs)
    if len(pairs) < FEWEST:
        return f"{mean:+.2f}"
    variance = sum((x - mean) ** 2 for x in pairs) / (len(pairs) - 1)
    half = student_quantile(len(pairs) - 1) * math.sqrt(variance / len(pairs))
    return verdict(mean - half, mean + half, lower, f"{mean:+.2f} ± {half:.2f}")


def verdict_together(mine, theirs, lower):
    """The verdict of two intervals of all seeds together."""
    if math.isnan(mine[1]) or math.isnan(theirs[1]):
        return "NA"
    if math.isnan(mine[0]) or math.isnan(theirs[0]):
        return "blank"
    lo, hi = mine[1] - theirs[2], mine[2] - theirs[1]
    return verdict(lo, hi, lower, f"{lo:+.2f} to {hi:+.2f}")


def beside(results):
    """Prints the published figures beside the results."""
    print(f"## Beside the published figures\n\nPublished: {SOURCE}.\n")
    for problem in results.problems:
        strategies = [name for name in results.strategies if name in FIGURES.get(problem, {})]
        if not strategies:
            continue
        print(head_of([escaped(problem), "samples", "published"] + [f"SE, {TITLES[path]}" for path in results.paths]))
        for name in strategies:
            for role in ROLES:
                there = published(problem, name, role)
                print(row_of([escaped(name), role, "NA" if math.isnan(there) else f"{there:g}"] +
                             [supported(results.shown[problem, name, role, path]) for path in results.paths]))
        print()


def rank_correlations(results):
    """Prints the rank correlations with the published figures."""
    print("\n## Rank correlation with the published figures\n\nSpearman's, per problem, over the strategies that have "
          "both figures (their number in brackets): 1: the same ranking, -1: the reverse. Of four strategies only ±1 is "
          "rarer than 5 % by chance (one-sided).\n")
    print(head_of(["estimator", "path", "samples"] + [escaped(problem) for problem in results.problems]))
    for estimator in results.estimators:
        for path in results.paths:
            for role in ROLES:
                cells = []
                for problem in results.problems:
                    pairs = [(published(problem, name, role), results.compared(problem, name, role, path, estimator))
                             for name in results.strategies]
                    pairs = [pair for pair in pairs if not math.isnan(sum(pair))]
                    rho = correlation([pair[0] for pair in pairs], [pair[1] for pair in pairs])
                    cells.append("NA" if math.isnan(rho) else f"{fixed(rho)} ({len(pairs)})")
                if any(cell != "NA" for cell in cells):
                    print(row_of([escaped(estimator), TITLES[path], role] + cells))
    print()


def claims(results):
    """Prints whether the results bear the sentences out."""
    print("\n## What was concluded\n\nEach cell: whether our data bear the sentence out, and the mean difference of SE, "
          "paired by seed, with its 95 % interval; of all seeds together the difference that both intervals allow. "
          "Lower: yes where the interval lies below 0, **no** where above, open where it holds 0. Not lower (similar or "
          "worse): **no** where the interval lies below 0, else yes. Fewer than five seeds have no interval.\n")
    for text, problem, strategy, lower, others, roles in CLAIMS:
        pairs = [(other, role) for other in others for role in roles]
        if not {strategy, *others} <= set(results.strategies) or problem not in results.problems:
            continue
        print(f"**{escaped(text)}** ({escaped(problem)}, SE of {escaped(strategy)})\n")
        print(head_of(["by", "path"] + [f"{role}, {'lower than' if lower else 'not lower than'} {escaped(other)}"
                                        for other, role in pairs]))
        cells = []
        for other, role in pairs:
            difference = published(problem, strategy, role) - published(problem, other, role)
            cells.append("NA" if math.isnan(difference) else
                         f"{'yes' if (difference < 0.0) == lower else '**no**'}: {difference:+.2f}")
        print(row_of(["published", ""] + cells))
        for estimator in results.estimators:
            for path in results.paths:
                # Of other estimators all seeds together have one value, without an interval.
                if path == "pooled" and estimator != HEADLINE:
                    continue
                cells = []
                for other, role in pairs:
                    if path == "pooled":
                        mine, theirs = (results.shown[problem, name, role, path] for name in (strategy, other))
                        cells.append(verdict_together(mine, theirs, lower))
                    else:
                        mine, theirs = (results.of_runs(problem, name, role, path, estimator)
                                        for name in (strategy, other))
                        cells.append(verdict_of_runs(mine, theirs, lower))
                if any(cell != "NA" for cell in cells):
                    print(row_of([escaped(estimator), TITLES[path]] + cells))
        print()


def main():
    """Prints the comparison."""
    results = Results(pathlib.Path(sys.argv[1]))
    beside(results)
    rank_correlations(results)
    claims(results)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: MIT-0
"""Prints the sampling efficiencies of examples/paper.lua, or of another script, in the layout of papers, and compares
them with the figures and sentences of the paper.

    trellis run examples/paper.lua --out DIR
    python3 examples/paper/compare.py DIR

Prints Markdown: the efficiencies, strategies below each other and problems side by side, and where those of single runs
mislead; then both figures side by side, their rank correlations, and whether the results bear the sentences out.
Source of the published figures: Attali et al. 2022, Evaluating Guiding Spaces for Motion Planning, table 1.
"""
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
MIXED = 0.05  # of uniform samples, in SE
WIDEST = 1.0  # nats of an interval on both sides of uniform sampling that is still printed


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


def number(value):
    """Returns a number of the document; NaN of null."""
    return math.nan if value is None else float(value)


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


def mean(values):
    """Returns the mean of the numbers and the ends of Student's 95 % interval; NaN where there are none, or too few."""
    values = [x for x in values if not math.isnan(x)]
    if not values:
        return math.nan, math.nan, math.nan
    middle = sum(values) / len(values)
    if len(values) < FEWEST:
        return middle, math.nan, math.nan
    variance = sum((x - middle) ** 2 for x in values) / (len(values) - 1)
    half = student_quantile(len(values) - 1) * math.sqrt(variance / len(values))
    return middle, middle - half, middle + half


class Supported:
    """The SE that samples support: the ends of its interval, and uniform sampling's SE."""

    def __init__(self, lo=math.nan, hi=math.nan, uniform=math.nan, exact=False):
        self.lo, self.hi, self.uniform = lo, hi, uniform
        # Printed where it shows on which side of uniform sampling the samples are.
        self.printed = not math.isnan(lo) and (exact or hi < uniform or lo > uniform or hi - lo <= WIDEST)
        self.value = 0.5 * (lo + hi) if self.printed else math.nan

    def text(self, above=False):
        """Returns it as text, or the nats above uniform."""
        lo, hi = (self.uniform - self.hi, self.uniform - self.lo) if above else (self.lo, self.hi)
        if math.isnan(lo):
            return "NA"
        if not self.printed:
            return "blank"
        return fixed(lo) if fixed(lo) == fixed(hi) else f"{fixed(lo)} to {fixed(hi)}"


class Results:
    """The figures of a document of `trellis run`."""

    def __init__(self, folder):
        document = json.loads((folder / "results.json").read_text(encoding="utf-8"))
        experiment = document["experiment"]
        self.problems = [problem["name"] for problem in experiment["problems"]]
        self.strategies = [strategy["name"] for strategy in experiment["strategies"]]
        self.seeds = len(experiment["seeds"])
        self.estimators = [HEADLINE] + experiment["measure"]["estimators"]
        self.runs = {}
        for place, run in enumerate(document["runs"]):
            self.runs.setdefault((run["problem"], run["strategy"]), []).append(place)
        self.solved = {(run["problem"], run["strategy"]) for run in document["runs"] if run["solved"]}
        self.pooled = {(row["problem"], row["strategy"], row["role"]): row
                       for row in rows(document["pooled"]) if row["key"] == "0"}
        self.measure = {(row["run"], row["role"], row["path"]): row
                        for row in rows(document["measure"]) if row["level"] == 0}
        together = any(len(self.runs[key[:2]]) >= FEWEST and row["SE"] is not None
                       for key, row in self.pooled.items() if key[2] == "tree")
        self.paths = [path for path in TITLES if path != "pooled" or together]
        self.shown = {
            (problem, strategy, role, path): self.supported(problem, strategy, role, path)
            for problem in self.problems for strategy in self.strategies for role in ROLES for path in TITLES}

    def sets(self, problem, strategy, role, path):
        """Returns the measured sets of the runs."""
        found = (self.measure.get((run, role, FIELDS[path])) for run in self.runs.get((problem, strategy), []))
        return [one for one in found if one]

    def supported(self, problem, strategy, role, path):
        """Returns what the samples support."""
        if path == "pooled":
            row = self.pooled.get((problem, strategy, role))
            if row is None or row["SE"] is None:
                return Supported()
            return Supported(number(row["SE_lo"]), number(row["SE_hi"]), number(row["D_uniform"]),
                             row["estimator"].startswith("exact"))
        every = self.sets(problem, strategy, role, path)
        scored = [row for row in every if row["SE"] is not None]
        if not scored:
            return Supported()
        uniform = mean([number(row["D_uniform"]) for row in every])[0]
        # No SE is below that of perfect guidance, or above that of samples that never lie in the target.
        least = mean([number(row["D_perfect"]) for row in scored])[0]
        ends = []
        for name, end in (("SE_lo", 1), ("SE_hi", 2)):
            found = mean([number(row[name]) for row in scored])
            bound = found[0] if math.isnan(found[end]) else found[end]
            ends.append(bound if math.isnan(least) else min(max(bound, least), uniform - math.log(MIXED)))
        return Supported(*ends, uniform, all(row["estimator"].startswith("exact") for row in scored))

    def samples(self, problem, strategy, role, path):
        """Returns the mean number of samples over the runs; all seeds together: on other seeds' paths."""
        sets = self.sets(problem, strategy, role, "cross" if path == "pooled" else path)
        return mean([float(row["N"]) for row in sets])[0]

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
            return self.shown[problem, strategy, role, path].value
        if path == "pooled":
            return self.estimate(self.pooled.get((problem, strategy, role)), estimator)
        values = [x for x in self.of_runs(problem, strategy, role, path, estimator) if not math.isnan(x)]
        return sum(values) / len(values) if values else math.nan


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
    middle, lo, hi = mean(pairs)
    if math.isnan(lo):
        return f"{middle:+.2f}"
    return verdict(lo, hi, lower, f"{middle:+.2f} ± {hi - middle:.2f}")


def verdict_together(mine, theirs, lower):
    """The verdict of two intervals of all seeds together."""
    if math.isnan(mine.lo) or math.isnan(theirs.lo):
        return "NA"
    if not mine.printed or not theirs.printed:
        return "blank"
    lo, hi = mine.lo - theirs.hi, mine.hi - theirs.lo
    return verdict(lo, hi, lower, f"{lo:+.2f} to {hi:+.2f}")


def plural(count, word, ending="s", one=""):
    """Returns a number with its noun."""
    return f"{count} {word}{one if count == 1 else ending}"


def efficiencies(results):
    """Prints the efficiencies in the layout of papers."""
    print(f"{plural(len(results.problems), 'problem')}, {plural(len(results.strategies), 'strateg', 'ies', 'y')}, "
          f"{results.seeds} seeds. SE: divergence of the target from the root's samples with 5 % uniform mixed in, nats, "
          "lower is better: the 95 % interval that the samples support, one number where recorded densities determine it. "
          "blank: the samples do not show on which side of uniform sampling they are. Upper value: tree; lower value: "
          "expansion (NA: the strategy makes no proposals, or no run has a figure). Other values: mean ± half-width of "
          "the 95 % Student interval over the runs.\n")
    for problem in results.problems:
        none = [escaped(name) for name in results.strategies if (problem, name) not in results.solved]
        if none:
            print(f"**{escaped(problem)}**: no run of {', '.join(none)} found a path; figures are on other strategies' "
                  "paths only.\n")
    for path in results.paths:
        print(f"\n## SE, {TITLES[path]}\n")
        print(head_of(["strategy"] + [escaped(problem) for problem in results.problems]))
        for name in results.strategies:
            print(row_of([escaped(name)] + ["<br>".join(results.shown[problem, name, role, path].text() for role in ROLES)
                                            for problem in results.problems]))
        print()


def disagreements(results):
    """Prints where the samples of all seeds together and those of single runs disagree, on other seeds' paths."""
    if "pooled" not in results.paths:
        return
    visible = 0.05  # nats: their targets differ
    print("\n## Where all seeds together and single runs disagree\n")
    found = []
    for problem in results.problems:
        for name in results.strategies:
            for role in ROLES:
                together = results.shown[problem, name, role, "pooled"]
                value, lo, hi = mean([number(row["above_uniform"]) for row in results.sets(problem, name, role, "cross")
                                      if row["SE"] is not None])
                # Their paths differ, so nats above uniform are compared.
                if together.printed and (hi < together.uniform - together.hi - visible
                                         or lo > together.uniform - together.lo + visible):
                    single = results.shown[problem, name, role, "cross"]
                    found.append([escaped(problem), escaped(name), role, together.text(True), single.text(True),
                                  f"{fixed(value)} ± {fixed(hi - value)}"])
    if not found:
        print("Nowhere: the estimates of single runs lie in the intervals of all seeds together.\n")
        return
    print("Nats above uniform, more is better. The mean of the estimates of single runs, on other seeds' paths, lies with "
          "its interval outside of what all seeds together support. Below it, single runs miss parts of the target that "
          "a mixture of them covers; above it, so few samples do not show how thin they are.\n")
    print(head_of(["problem", "strategy", "samples", "all seeds together", "single runs", "estimate of single runs"]))
    for cells in found:
        print(row_of(cells))
    print()


def print_correlations(results, title, explanation, against):
    """Prints rank correlations of the figures by each estimator, on each path.

    against: returns the value that the figure of a problem, strategy, role and path is compared with, NaN for none.
    """
    print(f"\n## {title}\n\n{explanation}\n")
    print(head_of(["estimator", "path", "samples"] + [escaped(problem) for problem in results.problems]))
    for estimator in results.estimators:
        for path in results.paths:
            for role in ROLES:
                cells = []
                for problem in results.problems:
                    pairs = [(against(problem, name, role, path), results.compared(problem, name, role, path, estimator))
                             for name in results.strategies]
                    pairs = [pair for pair in pairs if not math.isnan(sum(pair))]
                    rho = correlation([pair[0] for pair in pairs], [pair[1] for pair in pairs])
                    cells.append("NA" if math.isnan(rho) else f"{fixed(rho)} ({len(pairs)})")
                if any(cell != "NA" for cell in cells):
                    print(row_of([escaped(estimator), TITLES[path], role] + cells))
    print()


def beside(results):
    """Prints the published figures beside the results."""
    print(f"\n## Beside the published figures\n\nPublished: {SOURCE}.\n")
    for problem in results.problems:
        strategies = [name for name in results.strategies if name in FIGURES.get(problem, {})]
        if not strategies:
            continue
        print(head_of([escaped(problem), "samples", "published"] + [f"SE, {TITLES[path]}" for path in results.paths]))
        for name in strategies:
            for role in ROLES:
                there = published(problem, name, role)
                print(row_of([escaped(name), role, "NA" if math.isnan(there) else f"{there:g}"] +
                             [results.shown[problem, name, role, path].text() for path in results.paths]))
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
    efficiencies(results)
    disagreements(results)
    print_correlations(
        results, "Rank correlation with the number of samples",
        "Spearman's, between each estimator's figures and N, per problem, over the strategies that have both (their number "
        "in brackets). An efficiency is to show where samples lie, not how many there are: near -1 a figure says little "
        "more than the sample count.", results.samples)
    beside(results)
    print_correlations(
        results, "Rank correlation with the published figures",
        "Spearman's, per problem, over the strategies that have both figures (their number in brackets): 1: the same "
        "ranking, -1: the reverse. Of four strategies only ±1 is rarer than 5 % by chance (one-sided).",
        lambda problem, name, role, _: published(problem, name, role))
    claims(results)


if __name__ == "__main__":
    main()

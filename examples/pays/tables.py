#!/usr/bin/env python3
# SPDX-License-Identifier: MIT-0
"""Writes what strategies cost in many worlds, as docs/pays.md prints it.

    python3 examples/pays/tables.py [--by-name] DIR FILE...

Reads documents of `trellis run --json` and writes DIR/table.md, and DIR/table.csv: a row of each strategy on each problem
beside each reference. --by-name: the options of a strategy may differ between the files. Needs pandas."""

import math
import pathlib
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))

from trellis import figures  # noqa: E402

COLUMNS = 8  # problems in a table
COSTS = {"validity_checks": "validity checks", "cpu_s": "CPU time"}


def escaped(text):
    """Returns a text for a cell of Markdown."""
    return "".join("\\" + c if c in "|\\`*_<>[]" else c for c in text)


def code(text):
    """Returns a name of a strategy."""
    return f"`{text}`"


def ratio(x):
    """Returns a ratio with at least two significant digits."""
    if math.isnan(x):
        return "-"
    if math.isinf(x):
        return "inf" if x > 0 else "0"
    size = abs(x)
    return "0" if x == 0 else f"{x:.{0 if size >= 99.95 else 1 if size >= 9.995 else 2 if size >= 0.0995 else 3}f}"


def between(lo, hi):
    """Returns an interval in brackets, "" without."""
    return "" if math.isnan(lo) else f" [{ratio(lo)}, {ratio(hi)}]"


def plural(count, word, one="", more="s"):
    """Returns a number with its noun."""
    return f"{count} {word}{one if count == 1 else more}"


def table(heads, lines):
    """Returns a table of Markdown, whose first column is text."""
    rule = "|---|" + "---:|" * (len(heads) - 1)
    return "\n".join(["| " + " | ".join(cells) + " |" for cells in [heads]] + [rule]
                     + ["| " + " | ".join(cells) + " |" for cells in lines]) + "\n"


def worst(rows):
    """Returns the largest ratio and its problem."""
    known = [row for row in rows if not math.isnan(row["paired_ratio"])]
    if not known:
        return "-"
    row = max(known, key=lambda row: row["paired_ratio"])
    return f"{ratio(row['paired_ratio'])} ({escaped(row['problem'])})"


def summary(rows):
    """Returns the cells of a strategy over several problems: solved, and of each cost the median and the worst ratio."""
    checks = [row for row in rows if row["quantity"] == "validity_checks"]
    runs = sum(row["runs"] for row in checks)
    cells = [f"{sum(row['solved'] for row in checks)}/{runs}" if runs else "-"]
    for quantity in COSTS:
        some = [row for row in rows if row["quantity"] == quantity]
        known = [row["paired_ratio"] for row in some if not math.isnan(row["paired_ratio"])]
        cells += [ratio(statistics.median(known)) if known else "-", worst(some)]
    return cells


class Tables:
    """The tables of results."""

    def __init__(self, results):
        self.results = results
        self.tables = figures.tables(results)
        self.rows = self.tables["paired"].to_dict("records")
        self.problems = {problem["name"]: problem for problem in results.document["experiment"]["problems"]}
        self.grouped = any(problem.get("group") for problem in self.problems.values())

    def strategies(self, against):
        """Returns the strategies that have such a reference, in the order of the script."""
        found = {row["strategy"] for row in self.rows if row["against"] == against}
        return [name for name in self.results.script if name in found]

    def of(self, against, strategy, tuned=None):
        """Returns the rows of a strategy."""
        return [row for row in self.rows if row["against"] == against and row["strategy"] == strategy
                and tuned in (None, row["tuned"])]

    def together(self):
        """Returns the table of all worlds: beside each other those that strategies were tuned on, and the others."""
        kinds = [(None, "")]
        if self.grouped:
            kinds = [(tuned, f", {name}") for tuned, name in ((True, "tuned on"), (False, "held out"))
                     if any(bool(problem.get("tuned")) == tuned for problem in self.problems.values())]
        heads = ["strategy"]
        for _, name in kinds:
            heads += [f"solved{name}", "checks: median", "worst", "CPU time: median", "worst"]
        lines = [[code(name)] + [cell for tuned, _ in kinds for cell in summary(self.of("baseline", name, tuned))]
                 for name in self.strategies("baseline")]
        return "## All worlds together\n\n" + table(heads, lines)

    def beside(self, against, title, what):
        """Returns the table of another reference, "" without."""
        names = self.strategies(against)
        if not names:
            return ""
        lines = []
        for name in names:
            rows = self.of(against, name)
            solved, *costs = summary(rows)
            lines.append([code(name), str(len({row["problem"] for row in rows})), solved, *costs])
        return f"## {title}\n\n{what}\n\n" + table(
            ["strategy", "worlds", "solved", "checks: median", "worst", "CPU time: median", "worst"], lines)

    def correlation(self):
        """Returns which nats predict the checks, "" where too little was scored."""
        if "correlation" not in self.tables:
            return ""
        return ("## Rank correlation of efficiency and checks\n\nSpearman's within problems, over strategies with guides; "
                "-1: the more nats, the fewer checks.\n\n" + figures.tables(self.results, "markdown")["correlation"])

    def matrix(self, problems, quantity):
        """Returns the ratios of one cost, strategies by problems."""
        found = {(row["problem"], row["strategy"]): row for row in self.rows
                 if row["against"] == "baseline" and row["quantity"] == quantity}
        heads = [COSTS[quantity]] + [escaped(problem) for problem in problems]
        lines = [[code(self.results.baseline)] + [self.absolute(problem, quantity) for problem in problems]]
        for name in self.strategies("baseline"):
            cells = []
            for problem in problems:
                row = found.get((problem, name))
                cells.append("-" if row is None else ratio(row["paired_ratio"]) + between(row["lo"], row["hi"])
                             + self.unsolved(problem, name))
            lines.append([code(name)] + cells)
        return table(heads, lines)

    def absolute(self, problem, quantity):
        """Returns the baseline's median cost with its interval."""
        its = self.results.median(problem, self.results.baseline, quantity)
        if quantity == "validity_checks":
            def text(x):
                return "-" if math.isnan(x) else f"{x:.0f}"
        else:
            def text(x):
                return ratio(1000 * x)
        ends = "" if math.isnan(its.lo) or math.isnan(its.hi) else f" [{text(its.lo)}, {text(its.hi)}]"
        return (text(its.value) + ends + ("" if quantity == "validity_checks" else " ms")
                + self.unsolved(problem, self.results.baseline))

    def unsolved(self, problem, strategy):
        """Returns how many runs found a path, "" where all did."""
        solved, runs = self.results.solved(problem, strategy)
        return "" if solved == runs else f" {solved}/{runs}"

    def worlds(self):
        """Returns the matrices of all problems, group by group."""
        groups = {}
        for name, problem in self.problems.items():
            groups.setdefault(problem.get("group", ""), []).append(name)
        text = ("## World by world\n\nThe reference is " + escaped(self.results.baseline) + "; its row has its medians. In "
                "brackets: the 95 % interval of the median by order statistics. A fraction follows where some runs found "
                "no path.\n\n")
        for group, names in groups.items():
            if self.grouped:
                tuned = "tuned on" if self.problems[names[0]].get("tuned") else "held out"
                text += f"### {escaped(group) or 'problems of no group'}, {tuned}\n\n"
            for first in range(0, len(names), COLUMNS):
                for quantity in COSTS:
                    text += self.matrix(names[first:first + COLUMNS], quantity) + "\n"
        return text

    def page(self):
        """Returns all tables."""
        baseline = self.results.baseline
        parts = [
            f"# Costs beside {escaped(baseline)}\n\n{plural(len(self.problems), 'problem')}, "
            f"{plural(len(self.results.script), 'strateg', 'y', 'ies')}, {plural(self.results.seeds, 'seed')}. A number "
            "is a strategy's cost divided by that of its reference on the same seed, the median over the seeds; below 1 "
            "the strategy costs less. A run without a path costs infinitely much; where neither finds one the ratio is "
            "1.\n",
            self.together(),
            self.beside("own_planner", "Beside the planner without guides",
                        "The reference is the strategy's own planner without guides."),
            self.beside("best_part", "A composition beside its parts",
                        "The reference of `a >> b >> planner` is `a >> planner` or `b >> planner`, whichever costs less "
                        "in that world."),
            self.correlation(),
            self.worlds()]
        return "\n".join(part for part in parts if part)


def main():
    """Writes the tables."""
    words = sys.argv[1:]
    by_name = "--by-name" in words
    folder, *files = [word for word in words if word != "--by-name"]
    tables = Tables(figures.read(files, by_name=by_name))
    place = pathlib.Path(folder)
    (place / "table.md").write_text(tables.page(), encoding="utf-8")
    (place / "table.csv").write_text(figures.tables(tables.results, "csv")["paired"], encoding="utf-8")


if __name__ == "__main__":
    main()

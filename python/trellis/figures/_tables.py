# SPDX-License-Identifier: MIT-0
"""Tables of a document, as frames of pandas, and as CSV, Markdown and LaTeX."""
from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Mapping, Optional, Sequence, Union

from ..columns import rows
from . import _style
from ._compare import AGAINST, compared
from ._costs import title, verdict_text, verdicts
from ._document import Document, Error, Interval, Results, number, read
from ._join import nearest
from ._measure import PAIRS, PREDICTORS, correlate
from ._statistics import PairedCosts

if TYPE_CHECKING:
    import pandas

ENDINGS = {"csv": "csv", "markdown": "md", "latex": "tex"}


def _frame(rows: Sequence[Mapping[str, Any]], columns: Sequence[str]) -> "pandas.DataFrame":
    try:
        import pandas
    except ImportError as missing:
        raise ImportError("tables need pandas (Debian: python3-pandas)") from missing
    return pandas.DataFrame(list(rows), columns=list(columns))


# Costs ---------------------------------------------------------------------------------------------------------------

_COSTS = ("problem", "strategy", "solved", "runs", "checks", "checks_lo", "checks_hi", "ratio", "ratio_lo", "ratio_hi",
          "holm_p", "time_ms", "length_m")


def _costs(results: Results) -> List[Dict[str, Any]]:
    rows: List[Dict[str, Any]] = []
    problems: List[Optional[str]] = list(results.problems)
    for problem in problems + ([None] if len(problems) > 1 else []):
        for strategy in results.strategies:
            solved, runs = results.solved(problem, strategy)
            if not runs:
                continue
            checks, ratio = results.median(problem, strategy), results.ratio(problem, strategy)
            if not checks.bounded:
                checks = Interval(checks.value)
            comparison = results.comparison(problem, strategy)
            entry = results.summary(problem, strategy) or {}
            rows.append({
                "problem": title(results, problem), "strategy": strategy, "solved": solved, "runs": runs,
                "checks": checks.value, "checks_lo": checks.lo, "checks_hi": checks.hi,
                "ratio": ratio.value, "ratio_lo": ratio.lo, "ratio_hi": ratio.hi,
                "holm_p": number(comparison["holm_p"]) if comparison else math.nan,
                "time_ms": 1000 * results.median(problem, strategy, "time_s").value,
                "length_m": Interval.of(entry.get("length")).value,
            })
    return rows


_PAIRED = ("group", "tuned", "problem", "strategy", "against", "reference", "quantity", "runs", "solved",
           "reference_solved", "both_solved", "median", "reference_median", "ratio_of_medians", "ratio_of_totals",
           "paired_ratio", "lo", "hi", "sign_p", "holm_p", "effect")


def _paired(results: Results) -> List[Dict[str, Any]]:
    known = {problem["name"]: problem for problem in results.document["experiment"]["problems"]}
    return [
        {**_paired_row(results, known[one.problem], one.strategy, against, one.reference, quantity, one.costs),
         "holm_p": one.holm_p}
        for against in (AGAINST if results.baseline else ())
        for quantity in ("validity_checks", "cpu_s")
        for one in compared(results, against, quantity)
    ]


def _paired_row(results: Results, problem: Mapping[str, Any], strategy: str, against: str, reference: str,
                quantity: str, found: PairedCosts) -> Dict[str, Any]:
    solved, runs = results.solved(problem["name"], strategy)
    return {
        "group": problem.get("group", ""), "tuned": bool(problem.get("tuned", False)), "problem": problem["name"],
        "strategy": strategy, "against": against, "reference": reference, "quantity": quantity, "runs": runs,
        "solved": solved, "reference_solved": found.reference_solved, "both_solved": found.both_solved,
        "median": found.median, "reference_median": found.reference_median,
        "ratio_of_medians": found.ratio_of_medians, "ratio_of_totals": found.ratio_of_totals,
        "paired_ratio": found.ratio.value, "lo": found.ratio.lo, "hi": found.ratio.hi,
        "sign_p": found.sign_p if found.pairs else math.nan, "effect": found.effect,
    }


# Levels and correlation ----------------------------------------------------------------------------------------------

_LEVELS = ("problem", "strategy", "guide", "ratio", "ratio_lo", "ratio_hi", "at_least", "seeds", "verdict", "advice")


def _levels(results: Results) -> List[Dict[str, Any]]:
    rows: List[Dict[str, Any]] = []
    problems: List[Optional[str]] = list(results.problems)
    for problem in problems + ([None] if len(problems) > 1 else []):
        for one in verdicts(results, problem):
            rows.append({
                "problem": title(results, problem), "strategy": one.strategy, "guide": one.guide,
                "ratio": one.ratio.value, "ratio_lo": one.ratio.lo, "ratio_hi": one.ratio.hi, "at_least": one.least,
                "seeds": one.pairs, "verdict": one.verdict, "advice": verdict_text(one),
            })
    return rows


_CORRELATION = ("nats", "nodes", "nodes_lo", "nodes_hi", "proposals", "proposals_lo", "proposals_hi")


def _correlation(results: Results) -> List[Dict[str, Any]]:
    found = {"nodes": correlate(results), "proposals": correlate(results, proposals=True)}
    if found["nodes"] is None:
        return []
    names = list(PREDICTORS) + [f"{PREDICTORS[a]} - {PREDICTORS[b]}" for a, b in PAIRS]
    rows = []
    for k, name in enumerate(names):
        row: Dict[str, Any] = {"nats": name}
        for role, its in found.items():
            rho = Interval() if its is None else ([one.rho for one in its.rho] + its.differences)[k]
            row.update({role: rho.value, f"{role}_lo": rho.lo, f"{role}_hi": rho.hi})
        rows.append(row)
    return rows


# Efficiency ----------------------------------------------------------------------------------------------------------

_EFFICIENCY = ("problem", "strategy", "samples", "seeds", "N", "hitting", "hitting_lo", "hitting_hi", "mass", "spread",
               "SE", "SE_lo", "SE_hi", "uniform")


def _efficiency(results: Results) -> List[Dict[str, Any]]:
    """Of the root's samples of all seeds together, each on the path of a seed left out."""
    rows: List[Dict[str, Any]] = []
    for problem in results.problems:
        for strategy in results.strategies:
            found = results.pooled(problem, strategy)
            for role, name in (("tree", "nodes"), ("expansion", "proposals")):
                row = found.get(role)
                if row is None or row.get("SE") is None:
                    continue
                values = {key: number(row.get(of)) for key, of in (
                    ("hitting", "hitting.nats"), ("hitting_lo", "hitting.lo"), ("hitting_hi", "hitting.hi"),
                    ("mass", "SE_parts.mass"), ("spread", "SE_parts.spread"), ("SE", "SE"), ("SE_lo", "SE_lo"),
                    ("SE_hi", "SE_hi"), ("uniform", "D_uniform"))}
                rows.append({"problem": problem, "strategy": strategy, "samples": name, "seeds": row["seeds"],
                             "N": row["N"], **values})
    return rows


# Texts ---------------------------------------------------------------------------------------------------------------


def _range(row: Mapping[str, Any], name: str, text: Callable[[float], str]) -> str:
    value, lo, hi = row[name], row[name + "_lo"], row[name + "_hi"]
    return text(value) if math.isnan(lo) or math.isnan(hi) else f"{text(value)} [{text(lo)}, {text(hi)}]"


def _p(p: float) -> str:
    return "–" if math.isnan(p) else "<0.001" if p < 0.001 else f"{p:.3f}"


def _printed(name: str, rows: Sequence[Mapping[str, Any]]) -> List[List[str]]:
    """The cells of a table for readers, the first row its heading."""
    digits, checks = _style.digits, _style.counted
    if name == "costs":
        body = [[row["problem"], row["strategy"], f"{row['solved']}/{row['runs']}", _range(row, "checks", checks),
                 _range(row, "ratio", digits), _p(row["holm_p"]), digits(row["time_ms"], 3), digits(row["length_m"], 3)]
                for row in rows]
        return [["problem", "strategy", "solved", "checks", "ratio", "p", "ms", "path, m"], *body]
    if name == "levels":
        body = [[row["problem"], row["strategy"], row["guide"], ("≥ " if row["at_least"] else "")
                 + _range(row, "ratio", digits), str(row["seeds"]), row["advice"]] for row in rows]
        return [["problem", "strategy", "without", "ratio", "seeds", ""], *body]
    if name == "correlation":
        body = [[row["nats"], *(_range(row, role, _style.signed) for role in ("nodes", "proposals"))] for row in rows]
        return [["nats above uniform", "of the nodes", "of the proposals"], *body]
    if name == "efficiency":
        signed = _style.signed

        def nats(x: float) -> str:
            return f"{round(x, 2) + 0.0:.2f}"  # never "-0.00"

        body = [[row["problem"], row["strategy"], row["samples"], _range(row, "hitting", signed),
                 nats(row["mass"]), nats(row["spread"]), _range(row, "SE", nats), nats(row["uniform"])] for row in rows]
        return [["problem", "strategy", "samples", "hitting", "mass", "spread", "SE", "uniform"], *body]
    body = [[row["problem"], row["strategy"], row["reference"], row["quantity"], f"{row['solved']}/{row['runs']}",
             digits(row["ratio_of_medians"]), digits(row["ratio_of_totals"]), digits(row["paired_ratio"]),
             "–" if math.isnan(row["lo"]) else f"{digits(row['lo'])} – {digits(row['hi'])}", _p(row["holm_p"])]
            for row in rows]
    return [["problem", "strategy", "reference", "cost", "solved", "of medians", "of totals", "paired", "95 %", "p"],
            *body]


def _csv(rows: Sequence[Mapping[str, Any]], columns: Sequence[str]) -> str:
    """Numbers that read back as they are; a cell without a value is empty."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        cells = [row.get(name) for name in columns]
        writer.writerow(["" if cell is None or cell != cell else cell for cell in cells])
    return out.getvalue()


_LEFT = {"problem", "strategy", "without", "reference", "cost", "nats above uniform", "samples", ""}


def _markdown(cells: List[List[str]]) -> str:
    def line(row: Sequence[str]) -> str:
        safe = ["".join("\\" + char if char in "|\\`*_<>[]" else char for char in cell) for cell in row]
        return "| " + " | ".join(safe) + " |\n"

    rule = "|" + "|".join("---" if name in _LEFT else "---:" for name in cells[0]) + "|\n"
    return line(cells[0]) + rule + "".join(line(row) for row in cells[1:])


_SIGNS = {"\\": r"\textbackslash{}", "%": r"\%", "&": r"\&", "#": r"\#", "$": r"\$", "_": r"\_", "{": r"\{", "}": r"\}",
          "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": "$<$", ">": "$>$", "|": "$|$", "≥": r"$\geq$",
          "−": "$-$", "–": "--", "…": r"\ldots{}", "∞": r"$\infty$"}


def _latex(cells: List[List[str]]) -> str:
    def line(row: Sequence[str]) -> str:
        safe: List[str] = ["".join(_SIGNS.get(char, char) for char in cell) for cell in row]
        # A bracket at the head of a row would be an argument of the line break before it.
        return " & ".join("{}" + cell if cell.startswith("[") else cell for cell in safe) + r" \\" + "\n"

    text = "\\begin{tabular}{" + "".join("l" if name in _LEFT else "r" for name in cells[0]) + "}\n\\toprule\n"
    text += line(cells[0]) + "\\midrule\n" + "".join(line(row) for row in cells[1:])
    return text + "\\bottomrule\n\\end{tabular}\n"


_MAKERS = {"costs": (_costs, _COSTS), "levels": (_levels, _LEVELS), "paired": (_paired, _PAIRED),
           "efficiency": (_efficiency, _EFFICIENCY), "correlation": (_correlation, _CORRELATION)}


def tables(document: Document, format: Optional[str] = None) -> Dict[str, Any]:
    """The tables of a document by name; those without a row are left out:

    costs:       a row of each strategy on each problem, then over all: solved runs, validity checks until the first
                 path and their ratio to the baseline's (medians with 95 % intervals), p by Holm, time and path length.
    levels:      a row of each guide that was tested: checks without it divided by those with it, and the verdict.
    paired:      a row of each strategy, reference and cost: beside the baseline, its own planner, and the cheaper of its
                 parts.
    efficiency:  a row of each strategy's nodes and proposals of all seeds together on each problem: hitting, mass,
                 spread and SE in nats, with 95 % intervals, and the SE of uniform samples.
    correlation: rank correlations of nats with checks, as of `correlation`.

    document: what `read` takes.
    format:   None (default): frames of pandas, with numbers; "csv", "markdown" or "latex" (booktabs): texts.

    Raises `Error` for another format, and, for frames, ImportError without pandas.
    """
    if format is not None and format not in ENDINGS:
        raise Error(f"there is no format '{format}' of tables; there are: {', '.join(ENDINGS)}")
    results = read(document)
    return {name: _formatted(name, rows, format) for name, rows in rows_of(results).items()}


def frame(document: Document, table: str) -> "pandas.DataFrame":
    """A table of a document as a frame of pandas: "runs", a row of each run; "levels", of each level of each run;
    "measure", of each score; "pooled", of the scores of all seeds together; "setups", of what runs of a world share.
    Rows of levels and scores have the problem, strategy and seed of their run. docs/formats.md has the columns.

    Raises `Error` for another table, and ImportError without pandas.
    """
    results = read(document)
    runs = results.document["runs"]
    if table == "runs":
        try:
            import pandas
        except ImportError as missing:
            raise ImportError("tables need pandas (Debian: python3-pandas)") from missing
        return pandas.json_normalize(list(runs))
    known = ("runs", "levels", "measure", "pooled", "setups")
    if table not in known:
        raise Error(f"there is no table '{table}'{nearest(table, known)}; there are: {', '.join(known)}")
    content = results.document.get(table) or {"rows": 0}
    its = rows(content)
    names = [name for name in content if name != "rows"]
    if "run" not in names:
        return _frame(its, names)
    of_run = ("problem", "strategy", "seed")
    return _frame([{**{key: runs[row["run"]][key] for key in of_run}, **row} for row in its], [*of_run, *names])


def _formatted(name: str, rows: Sequence[Mapping[str, Any]], format: Optional[str]) -> Union[str, "pandas.DataFrame"]:
    if format == "markdown":
        return _markdown(_printed(name, rows))
    if format == "latex":
        return _latex(_printed(name, rows))
    columns = _MAKERS[name][1]
    return _frame(rows, columns) if format is None else _csv(rows, columns)


def rows_of(results: Results) -> Dict[str, List[Dict[str, Any]]]:
    """The rows of all tables that have some."""
    made = {name: make(results) for name, (make, _) in _MAKERS.items()}
    return {name: rows for name, rows in made.items() if rows}


def texts_of(results: Results, formats: Sequence[str]) -> Dict[str, str]:
    """The texts of all tables by the names of their files."""
    rows = rows_of(results)
    return {f"{name}.{ENDINGS[form]}": str(_formatted(name, its, form)) for form in formats
            for name, its in rows.items()}

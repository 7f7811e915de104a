# SPDX-License-Identifier: MIT-0
"""Costs of strategies beside others, seed by seed: the baseline, the own planner, and the better part."""
from __future__ import annotations

import math
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from ._document import Error, Interval, Results
from ._statistics import PairedCosts, holm, median, paired_costs, references

AGAINST = ("baseline", "own_planner", "best_part")


class Compared(NamedTuple):
    """A strategy on a problem beside its reference there."""

    problem: str
    strategy: str
    reference: str
    costs: PairedCosts
    holm_p: float


def check_against(against: str) -> None:
    if against not in AGAINST:
        raise Error(f"there is no reference '{against}'; there are: {', '.join(AGAINST)}")


def by_seed(results: Results, problem: str, strategy: str, quantity: str) -> Dict[Any, float]:
    """The costs of runs by seed."""
    values = results.costs(problem, strategy, quantity)
    return {run["seed"]: float(value) for run, value in zip(results.runs(problem, strategy), values)}


def compared(results: Results, against: str, quantity: str = "validity_checks",
             names: Optional[Sequence[str]] = None) -> List[Compared]:
    """All strategies on all problems beside their references, with Holm's correction over all of them.

    names: of strategies (default all of the document, with those that `ablate` adds).
    """
    texts = {name: str(results.spec(name)["text"]) for name in (results.script if names is None else names)}
    found: List[Tuple[str, str, str, PairedCosts]] = []
    for problem in results.problems:
        costs = {name: by_seed(results, problem, name, quantity) for name in texts}
        for strategy in texts:
            others = [name for name in references(texts, strategy, against, results.baseline) if costs[name]]
            if costs[strategy] and others:
                other = min(others, key=lambda name: median(list(costs[name].values())))
                found.append((problem, strategy, other, paired_costs(costs[strategy], costs[other])))
    p = holm([costs.sign_p if costs.pairs else math.nan for *_, costs in found])
    return [Compared(*one, each) for one, each in zip(found, p)]


def over_all(results: Results, rows: Sequence[Compared], quantity: str = "validity_checks") -> Dict[str, Compared]:
    """The seeds of all problems together: each strategy beside its references, one for each problem."""
    mine: Dict[str, Dict[Any, float]] = {}
    theirs: Dict[str, Dict[Any, float]] = {}
    for row in rows:
        for name, its in ((row.strategy, mine), (row.reference, theirs)):
            costs = by_seed(results, row.problem, name, quantity)
            its.setdefault(row.strategy, {}).update({(row.problem, seed): cost for seed, cost in costs.items()})
    paired = {name: paired_costs(costs, theirs[name]) for name, costs in mine.items()}
    p = holm([costs.sign_p if costs.pairs else math.nan for costs in paired.values()])
    return {name: Compared("", name, "", costs, each) for (name, costs), each in zip(paired.items(), p)}


class Ratios(NamedTuple):
    """Ratios of costs, of problems and of all of them together (None)."""

    ratio: Mapping[Tuple[Optional[str], str], Interval]
    shown: Mapping[Tuple[Optional[str], str], bool]

    def of(self, problem: Optional[str], strategy: str) -> Interval:
        """The median ratio with its interval; NaN of one that there is not."""
        return self.ratio.get((problem, strategy), Interval())


def ratios_of(results: Results, against: str, quantity: str = "validity_checks") -> Ratios:
    """The ratios of checks beside the baseline are those of the document; others are computed from its runs."""
    ratio: Dict[Tuple[Optional[str], str], Interval] = {}
    shown: Dict[Tuple[Optional[str], str], bool] = {}
    if against == "baseline" and quantity == "validity_checks":
        for name in results.others:
            for problem in [*results.problems, None]:
                ratio[problem, name] = results.ratio(problem, name)
                shown[problem, name] = results.shown(problem, name)
        return Ratios(ratio, shown)
    rows = compared(results, against, quantity, results.strategies)
    every: List[Tuple[Optional[str], Compared]] = [(row.problem, row) for row in rows]
    every += [(None, row) for row in over_all(results, rows, quantity).values()]
    for problem, row in every:
        ratio[problem, row.strategy] = row.costs.ratio
        shown[problem, row.strategy] = row.holm_p < 0.05
    return Ratios(ratio, shown)

# SPDX-License-Identifier: MIT-0
"""Joins documents, and compares with another baseline: medians and comparisons are computed from the runs."""
from __future__ import annotations

import difflib
import math
from typing import Any, Dict, List, Mapping, Optional, Sequence, Set, Tuple

import numpy as np

from ._document import FORMAT, Error, Interval, Results
from ._statistics import PairedCosts, holm, median_interval, paired_costs, split_levels

_COSTS = ("validity_checks", "motion_checks", "time_s")


def nearest(name: str, known: Sequence[str]) -> str:
    """ " (did you mean 'x'?)" for the name that is most alike; "" where none is."""
    found = difflib.get_close_matches(name, known, 1, 0.6)
    return f" (did you mean '{found[0]}'?)" if found else ""


def _experiment(parts: Sequence[Results], by_name: bool) -> Dict[str, Any]:
    """The problems, the strategies and the seeds of all."""
    problems: Dict[str, Any] = {}
    strategies: Dict[str, Any] = {}
    seeds: Set[Any] = set()
    given = None
    for part in parts:
        experiment = part.document["experiment"]
        for problem in experiment["problems"]:
            problems.setdefault(problem["name"], problem)
        for strategy in experiment.get("strategies") or []:
            known = strategies.setdefault(strategy["name"], strategy)
            if known["text"] != strategy["text"] and not by_name:
                raise Error(f"{part.file}: '{strategy['name']}' is {strategy['text']} here and {known['text']} in "
                            "another file; --by-name, in Python by_name=True, compares strategies by their names alone")
        seeds.update(experiment.get("seeds") or [])
        given = given or experiment.get("baseline")
    return {**parts[0].document["experiment"], "problems": list(problems.values()),
            "strategies": list(strategies.values()), "baseline": given,
            "seeds": sorted(seeds, key=lambda seed: (len(str(seed)), str(seed)))}


def _baseline(experiment: Mapping[str, Any], left_out: Set[str], asked: Optional[str]) -> str:
    """The strategy asked for; else that of the experiments; else the first without guides."""
    names = [one["name"] for one in experiment["strategies"] if one["name"] not in left_out]
    if asked is not None:
        if asked not in names:
            raise Error(f"baseline: there is no strategy '{asked}'{nearest(asked, names)}; there are: "
                        f"{', '.join(names)}")
        return asked
    if experiment["baseline"] in names:
        return str(experiment["baseline"])
    if len(names) < 2:
        return ""
    plain = [one["name"] for one in experiment["strategies"]
             if one["name"] in names and len(split_levels(str(one["text"]))) == 1]
    return str((plain or names)[0])


def _pictures(parts: Sequence[Results]) -> Dict[str, List[Any]]:
    """The worlds, robots and scenes of all; of a problem in several documents those of the first."""
    out: Dict[str, List[Any]] = {"worlds": [], "robots": [], "scenes": []}
    for part in parts:
        first = {"world": len(out["worlds"]), "robot": len(out["robots"])}
        for key in ("worlds", "robots"):
            out[key] += part.document.get(key) or []
        known = {scene["problem"] for scene in out["scenes"]}
        out["scenes"] += [{**scene, **{key: None if scene.get(key) is None else scene[key] + at
                                       for key, at in first.items()}}
                          for scene in part.document.get("scenes") or [] if scene["problem"] not in known]
    return out


def _entry(interval: Interval) -> Dict[str, float]:
    return {"value": interval.value, "lo": interval.lo, "hi": interval.hi}


def _summary(results: Results, problem: Optional[str], strategy: str, parts: Sequence[Any]) -> Dict[str, Any]:
    """An entry of runs that several documents have: their costs, and no levels, whose figures do not add up."""
    entry: Dict[str, Any] = {"problem": problem, "strategy": strategy, "levels": [], "guides_without_level": [],
                             "parts": list(parts)}
    for cost in _COSTS:
        entry[cost] = _entry(median_interval(list(results.costs(problem, strategy, cost))))
    lengths = [float(run["length"]) for run in results.runs(problem, strategy)
               if run["solved"] and run.get("length") is not None]
    entry["length"] = _entry(Interval(float(np.mean(lengths)) if lengths else math.nan))
    return entry


def _comparisons(results: Results, baseline: str, names: Sequence[str]) -> List[Dict[str, Any]]:
    """The costs beside the baseline, of each problem and of all together, each with Holm's correction."""
    def by_seed(problem: Optional[str], name: str) -> Dict[Tuple[str, Any], float]:
        runs = results.runs(problem, name)
        return {(run["problem"], run["seed"]): float(cost)
                for run, cost in zip(runs, results.costs(problem, name))}

    families: List[List[Optional[str]]] = [list(results.problems)]
    families += [[None]] if len(results.problems) > 1 else []
    out = []
    for family in families:
        found: List[Tuple[Optional[str], str, PairedCosts]] = []
        for problem in family:
            reference = by_seed(problem, baseline)
            for name in names:
                mine = by_seed(problem, name)
                if name != baseline and mine and reference:
                    found.append((problem, name, paired_costs(mine, reference)))
        p = holm([costs.sign_p if costs.pairs else math.nan for *_, costs in found])
        for (problem, name, costs), corrected in zip(found, p):
            out.append({"problem": problem, "strategy": name, "baseline": baseline, "ablation": None,
                        "ratio": _entry(costs.ratio), "pairs": costs.pairs, "holm_p": corrected})
    return out


def joined(parts: Sequence[Results], baseline: Optional[str] = None, by_name: bool = False) -> Results:
    """The runs of documents together. Strategies of one name are the same, or `Error` is raised; a problem and a
    strategy that one document alone has keep the levels of their summary.

    baseline: the strategy to compare with (default that of the experiments, else the first without guides).
    by_name:  whether strategies of one name may differ.
    """
    experiment = _experiment(parts, by_name)
    seen: Set[Tuple[str, str, str]] = set()
    runs: List[Any] = []
    for part in parts:
        for run in part.document.get("runs") or []:
            key = (run["problem"], run["strategy"], str(run["seed"]))
            if key in seen:
                raise Error(f"{part.file}: seed {key[2]} of '{key[1]}' on '{key[0]}' is there twice")
            seen.add(key)
            runs.append(run)
    ablations = [entry for part in parts for entry in part.document.get("comparisons") or [] if entry.get("ablation")]
    left_out = {entry["strategy"] for entry in ablations}
    reference = _baseline(experiment, left_out, baseline)
    document: Dict[str, Any] = {"trellis": {**parts[0].document["trellis"], "format": FORMAT},
                                "experiment": {**experiment, "baseline": reference or None}, **_pictures(parts),
                                "samples": None, "runs": runs, "summary": [], "comparisons": ablations}
    file = parts[0].file if len(parts) == 1 else f"the {len(parts)} documents"
    plain = Results(document, file)
    summary: List[Any] = []
    for problem in [*plain.problems, None]:
        for name in plain.script:
            entries = [entry for entry in (part.entry(problem, name) for part in parts) if entry is not None]
            alone = len(parts) == 1 or (problem is not None and len(entries) == 1)
            if alone and entries:
                summary.append(entries[0])
            elif plain.runs(problem, name) and (problem is not None or len(plain.problems) > 1):
                summary.append(_summary(plain, problem, name, entries))
    names = [name for name in plain.script if name not in left_out]
    document = {**document, "summary": summary,
                "comparisons": (_comparisons(plain, reference, names) if reference else []) + ablations}
    results = Results(document, file)
    results.parts = list(parts)
    return results

#!/usr/bin/env python3
# SPDX-License-Identifier: MIT-0
"""Which figure ranks guides as their costs do?

    python3 examples/pays/rank_guides.py FILE...

Reads documents of `trellis run --json`, as of examples/correlation.lua, and prints for each figure of the root its rank correlation, over the guides of each world, with
the validity checks and with the proposals, both divided by those of the baseline: the mean over the worlds, its 95 %
bootstrap interval, the worst world, and how many worlds are above -0.45. docs/measure.md has the results."""

import json
import math
import pathlib
import random
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))

from trellis.columns import rows  # noqa: E402

ABOVE = -0.45
RESAMPLES = 10000


def ranks(values):
    order = sorted(range(len(values)), key=values.__getitem__)
    result = [0.0] * len(values)
    i = 0
    while i < len(order):
        j = i
        while j < len(order) and values[order[j]] == values[order[i]]:
            j += 1
        for k in range(i, j):
            result[order[k]] = 0.5 * (i + j - 1)
        i = j
    return result


def correlation(a, b):
    """Spearman's; 0 where all values of a list are equal, because such a figure ranks nothing."""
    a, b = ranks(a), ranks(b)
    mean_a, mean_b = statistics.fmean(a), statistics.fmean(b)
    square = sum((x - mean_a) ** 2 for x in a) * sum((y - mean_b) ** 2 for y in b)
    if square == 0.0:
        return 0.0
    return sum((x - mean_a) * (y - mean_b) for x, y in zip(a, b)) / math.sqrt(square)


def interval(values):
    stream = random.Random(1)
    means = sorted(statistics.fmean(stream.choices(values, k=len(values))) for _ in range(RESAMPLES))
    return means[int(0.025 * RESAMPLES)], means[int(0.975 * RESAMPLES) - 1]


def read(path):
    """The document, whose runs have the proposals and the measured sets of the robot's own level."""
    with open(path, encoding="utf-8") as file:
        document = json.load(file)
    if "levels" not in document:
        version = document.get("trellis", {}).get("format", 1)
        sys.exit(f"{path}: the document has format {version}; its runs have to be made again with this version")
    if document["experiment"]["baseline"] is None:
        sys.exit(f"{path}: the experiment has no `baseline`, which the costs are divided by")
    for run in document["runs"]:
        run["measure"] = {}
    for row in rows(document["levels"]):
        if row["level"] == 0:
            document["runs"][row["run"]]["proposals"] = row["proposals"]
    for row in rows(document["measure"]):
        if row["level"] == 0:
            document["runs"][row["run"]]["measure"][row["role"], row["path"]] = row
    document["pooled"] = rows(document["pooled"])
    return document


def at(row, key):
    value = (row or {}).get(key)
    if value == "-inf":
        return -math.inf
    return value if isinstance(value, (int, float)) else None


def mean_of(values):
    known = [v for v in values if v is not None and math.isfinite(v)]
    return statistics.fmean(known) if known else None


def figures(pooled, runs):
    """The figures of a strategy in a world, of its proposals and of its nodes; more is better."""
    result = {}
    for role, name in (("expansion", "proposals"), ("tree", "nodes")):
        whole = pooled.get(role)
        cross = [run["measure"].get((role, "cross")) for run in runs]
        references = [run["measure"].get((role, "uniform")) for run in runs]
        result["hitting", name] = at(whole, "hitting.nats")
        result["hitting, full metric", name] = at(whole, "hitting.full")
        result["bottleneck", name] = at(whole, "bottleneck.nats")
        result["bottleneck, full metric", name] = at(whole, "bottleneck.full")
        result["hitting of single runs", name] = mean_of([at(s, "hitting.nats") for s in cross])
        result["uniform samples of single runs", name] = mean_of([at(s, "hitting.nats") for s in references])
        mass = mean_of([at(s, "SE_parts.mass") for s in cross])
        uniform = mean_of([at(s, "D_uniform") for s in cross])
        result["mass", name] = None if mass is None or uniform is None else uniform - mass
        result["SE", name] = mean_of([at(s, "above_uniform") for s in cross])
    return result


def ratio(mine, theirs):
    """The median of a cost divided by the baseline's on the same seed; infinite without a path."""
    pairs = [(a, b) for a, b in zip(mine, theirs) if b is not None]
    values = [math.inf if a is None else a / max(1, b) for a, b in pairs]
    return statistics.median_low(values) if values else None


def world_of(document, problem, baseline):
    runs = {}
    for run in document["runs"]:
        if run["problem"] == problem:
            runs.setdefault(run["strategy"], []).append(run)
    pooled = {}
    for row in document["pooled"]:
        if row["problem"] == problem and row["key"] == "0":
            pooled.setdefault(row["strategy"], {})[row["role"]] = row
    costs = {
        "checks": lambda run: run["validity_checks"] if run["solved"] else None,
        "proposals": lambda run: run["proposals"] if run["solved"] else None,
    }
    world = {"guides": [], "figures": [], "costs": {cost: [] for cost in costs}, "samples": []}
    for strategy, mine in runs.items():
        if strategy == baseline:
            continue
        ratios = {
            cost: ratio([of(r) for r in mine], [of(r) for r in runs[baseline]]) for cost, of in costs.items()
        }
        if any(r is None for r in ratios.values()):
            continue
        world["guides"].append(strategy)
        world["figures"].append(figures(pooled.get(strategy, {}), mine))
        world["samples"].append(at(pooled.get(strategy, {}).get("expansion"), "hitting.N"))
        for cost, value in ratios.items():
            world["costs"][cost].append(value)
    return world


def text(value):
    return f"{value:+.2f}"


def report(worlds):
    names = list(next(iter(worlds.values()))["figures"][0])
    few = [(n, g) for w in worlds.values() for n, g in zip(w["samples"], w["guides"]) if n is None or n < 600]
    pairs = sum(len(w["guides"]) for w in worlds.values())
    print(f"{len(worlds)} worlds, {pairs} guides in them; {len(few)} with fewer than 600 proposals in the pool\n")
    print("| figure | of the | rank correlation with checks | worst | above -0.45 | minus that of mass | with proposals |")
    print("|---|---|---|---|---|---|---|")
    found = {}
    for name in names:
        by_cost = {}
        for cost in ("checks", "proposals"):
            rho = {}
            for world, w in worlds.items():
                values = [f[name] for f in w["figures"]]
                if all(v is None for v in values):
                    continue
                # A guide without a figure has nothing to show: it ranks last.
                rho[world] = correlation([-math.inf if v is None else v for v in values], w["costs"][cost])
            by_cost[cost] = rho
        found[name] = by_cost
    for (figure, role), by_cost in found.items():
        checks = by_cost["checks"]
        if len(checks) < 2:
            continue
        values = list(checks.values())
        lo, hi = interval(values)
        worst = max(checks, key=checks.get)
        mass = found["mass", role]["checks"]
        both = [checks[w] - mass[w] for w in checks if w in mass]
        less = f"{text(statistics.fmean(both))} [{', '.join(map(text, interval(both)))}]" if both else "-"
        proposals = list(by_cost["proposals"].values())
        ends = ", ".join(map(text, interval(proposals)))
        print(
            f"| {figure} | {role} | {text(statistics.fmean(values))} [{text(lo)}, {text(hi)}] | {text(checks[worst])} ({worst})"
            f" | {sum(v > ABOVE for v in values)} of {len(values)} | {less} | {text(statistics.fmean(proposals))} [{ends}] |"
        )
    uniform = [f["hitting", "proposals"] for w in worlds.values() for g, f in zip(w["guides"], w["figures"])
               if g.startswith("uniform >>") and f["hitting", "proposals"] is not None]
    if uniform:
        print(f"\nhitting of uniform(): {text(min(uniform))} to {text(max(uniform))}, mean {text(statistics.fmean(uniform))}")
    both = [correlation(w["costs"]["proposals"], w["costs"]["checks"]) for w in worlds.values()]
    print(f"proposals and checks themselves: {text(statistics.fmean(both))}")


def main():
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        return 0 if len(sys.argv) > 1 else 2
    worlds = {}
    for path in sys.argv[1:]:
        document = read(path)
        baseline = document["experiment"]["baseline"]
        for problem in document["experiment"]["problems"]:
            world = world_of(document, problem["name"], baseline)
            if len(world["guides"]) >= 3:
                worlds[problem["name"]] = world
    if not worlds:
        print("no world with three guides", file=sys.stderr)
        return 1
    report(worlds)
    return 0


if __name__ == "__main__":
    sys.exit(main())

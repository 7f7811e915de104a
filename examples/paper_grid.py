#!/usr/bin/env python3
# SPDX-License-Identifier: MIT-0
"""Computes the divergence of the published experiment by a plain grid over position, as docs/paper.md prints it.

    trellis run examples/paper.lua --out DIR --samples DIR/samples
    python3 examples/paper_grid.py DIR

Cells of 1 m; the target is the whole tube of 0.5 m about a path, valid or not; a cell without samples gets the share
`floor`. The figures are an artefact of that floor, and serve to compare with figures that were made so.
"""
import csv
import math
import pathlib
import sys

from paper import compare

DELTA = 0.5  # m
WORLD = 10  # m, both sides; also the number of cells on a side
POINT = 0.1  # m between the points that fill the tube
FLOORS = (1e-100, 1e-10)
PATHS = ("all seeds together", "own path", "other seeds' paths")


def cell(x, y):
    """Returns the cell of a position."""
    return tuple(min(max(int(c), 0), WORLD - 1) for c in (x, y))


def shares(cells):
    """Returns the share of each cell."""
    counts = {}
    for at in cells:
        counts[at] = counts.get(at, 0) + 1
    return {at: count / len(cells) for at, count in counts.items()}


def tube(path):
    """Returns the share of each cell in the tube about a path."""
    points = set()
    for (ax, ay), (bx, by) in zip(path, path[1:]):
        dx, dy = bx - ax, by - ay
        square = dx * dx + dy * dy
        ranges = [range(max(0, math.floor((min(a, b) - DELTA) / POINT)),
                        min(math.ceil(WORLD / POINT), math.ceil((max(a, b) + DELTA) / POINT)))
                  for a, b in ((ax, bx), (ay, by))]
        for i in ranges[0]:
            for j in ranges[1]:
                x, y = (i + 0.5) * POINT, (j + 0.5) * POINT
                t = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / square)) if square > 0.0 else 0.0
                if math.hypot(x - ax - t * dx, y - ay - t * dy) <= DELTA:
                    points.add((x, y))
    return shares([cell(x, y) for x, y in points])


def divergence(target, samples, floor):
    """Returns the divergence of samples, shares of cells, from a target."""
    return sum(t * math.log(t / max(samples.get(at, 0.0), floor)) for at, t in target.items())


def mean(values):
    """Returns the mean; NaN without values."""
    return sum(values) / len(values) if values else math.nan


def read_run(folder):
    """Returns the path of a run and its samples by role, positions of the root."""
    with open(folder / "path.csv", encoding="utf-8") as file:
        path = [(float(row["q1"]), float(row["q2"])) for row in csv.DictReader(file)]
    found = {role: {} for role in compare.ROLES}
    with open(folder / "samples.csv", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["level"] != "0" or (row["role"] == "tree" and row["accepted"] == "0"):
                continue
            # The nodes of a tree count once each.
            key = (row["q1"], row["q2"], row["q3"]) if row["role"] == "tree" else row["index"]
            found[row["role"]][key] = cell(float(row["q1"]), float(row["q2"]))
    return path, {role: list(cells.values()) for role, cells in found.items()}


def figures(runs, donors, role):
    """Returns the mean figures of a method over its runs: by path, then by floor."""
    drawn = [shares(samples[role]) for _, samples in runs]
    own = [tube(path) for path, _ in runs]
    together = [shares([at for j, (_, samples) in enumerate(runs) if j != i for at in samples[role]])
                for i in range(len(runs))]
    pairs = {"all seeds together": list(zip(own, together)), "own path": list(zip(own, drawn)),
             "other seeds' paths": [(donors[(i + k) % len(donors)], q) for i, q in enumerate(drawn) for k in (1, 2)]}
    return {where: [mean([divergence(t, q, floor) for t, q in some]) for floor in FLOORS]
            for where, some in pairs.items()}


def row_of(*cells):
    """Returns a row of a table in Markdown."""
    def text(x):
        return x.replace("_", r"\_") if isinstance(x, str) else "NA" if math.isnan(x) else f"{x:.2f}"
    return "| " + " | ".join(text(x) for x in cells) + " |"


def head_of(*cells):
    """Returns the head of a table."""
    return row_of(*cells) + "\n" + "|---" * len(cells) + "|"


def main():
    """Prints the tables."""
    folder = pathlib.Path(sys.argv[1])
    columns = [f"{where}, floor {floor:g}" for where in PATHS for floor in FLOORS]
    agreement = []
    for problem, methods in compare.FIGURES.items():
        places = {method: folder / "samples" / problem / method for method in methods}
        runs = {method: [read_run(run) for run in sorted(place.iterdir())]
                for method, place in places.items() if place.is_dir()}
        if "rrt" not in runs:
            continue
        print(head_of(problem, "samples", "published", *columns))
        donors = [tube(path) for path, _ in runs["rrt"]]
        for role in compare.ROLES:
            there = {method: compare.published(problem, method, role) for method in runs}
            there = {method: value for method, value in there.items() if not math.isnan(value)}
            rows = []
            for name, value in there.items():
                found = figures(runs[name], donors, role)
                rows.append([value for where in PATHS for value in found[where]])
                print(row_of(name, role, f"{value:g}", *rows[-1]))
            agreement.append(row_of(problem, role, str(len(there)),
                                    *[compare.correlation(list(there.values()), ours) for ours in zip(*rows)]))
        print()
    print("Spearman's rank correlation with the published figures, over so many methods:\n")
    print(head_of("problem", "samples", "methods", *columns))
    print("\n".join(agreement))


if __name__ == "__main__":
    main()

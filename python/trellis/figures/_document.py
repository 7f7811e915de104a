# SPDX-License-Identifier: MIT-0
"""Reads the JSON document of `trellis run --json`, and returns the parts that figures and tables show."""
from __future__ import annotations

import json
import math
import os
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from ..columns import rows

FORMAT = 5

_QUANTITIES = ("validity_checks", "motion_checks", "time_s", "cpu_s")


class Error(ValueError):
    """A fault of a document, or of an argument that names a part of it."""


def number(value: Any) -> float:
    """A number of the document, where a missing value is null and an infinite one is a text; NaN for null."""
    return math.nan if value is None else float(value)


class Interval:
    """A value with the ends of its interval. Missing ones are NaN."""

    __slots__ = ("value", "lo", "hi")

    def __init__(self, value: float = math.nan, lo: float = math.nan, hi: float = math.nan) -> None:
        self.value = value
        self.lo = lo
        self.hi = hi

    @classmethod
    def of(cls, entry: Optional[Mapping[str, Any]]) -> "Interval":
        """The interval of the document: an object with `value`, `lo` and `hi`, or null."""
        if entry is None:
            return cls()
        return cls(*(number(entry.get(end)) for end in ("value", "lo", "hi")))

    @property
    def bounded(self) -> bool:
        """Whether it excludes any cost or ratio: [0, inf] excludes none."""
        return not math.isnan(self.lo) and not math.isnan(self.hi) and (self.lo > 0 or math.isfinite(self.hi))

    def inverse(self) -> "Interval":
        """The interval of 1 / x, of a value of at least 0."""
        return Interval(*(1 / x if x > 0 else math.inf if x == 0 else x for x in (self.value, self.hi, self.lo)))


class Results:
    """The results of an experiment, as figures and tables read them. `read` makes one.

    document:   the JSON document, as dicts and lists; docs/formats.md describes each field.
    file:       the file that it comes from, for messages.
    problems:   the names of the problems, in the order of the document.
    strategies: the names of the strategies: the baseline, then the others by the mean logarithm of the ratios of their
                costs to the baseline's, the cheapest first. Without those that `ablate` adds.
    baseline:   the strategy that the others are compared with, "" for none.
    samples:    the folder with the samples of the runs, None of a document without one.
    """

    document: Dict[str, Any]
    file: str
    samples: Optional[str]
    problems: List[str]
    strategies: List[str]
    baseline: str

    def __init__(self, document: Mapping[str, Any], file: str = "the document", samples: Optional[str] = None) -> None:
        head = document.get("trellis")
        if not isinstance(head, Mapping) or not isinstance(document.get("experiment"), Mapping):
            raise Error(f"{file}: this is no document of `trellis run --json`")
        found = head.get("format", 1)
        if found != FORMAT:
            raise Error(
                f"{file}: the document has format {found}; figures read format {FORMAT}: run it again with this version"
            )
        self.document = dict(document)
        self.file = file
        self.samples = samples
        self.index: Any = None  # of the samples, once a figure reads them
        self.scenes: Dict[str, Any] = {}  # of problems, likewise
        self.parts: List["Results"] = []  # of documents that were joined
        experiment = document["experiment"]
        self.problems = [problem["name"] for problem in experiment["problems"]]
        self._specs = {strategy["name"]: strategy for strategy in experiment.get("strategies") or []}
        comparisons = document.get("comparisons") or []
        left_out = {entry["strategy"] for entry in comparisons if entry.get("ablation")}
        self._listed = [name for name in self._specs if name not in left_out]
        self._levels: Optional[Dict[int, List[Mapping[str, Any]]]] = None
        self._scores: Optional[Dict[Tuple[int, str, str], Mapping[str, Any]]] = None
        self._pooled: Optional[Dict[Tuple[str, str], Dict[str, Mapping[str, Any]]]] = None
        self._runs: Dict[Tuple[str, str], List[Mapping[str, Any]]] = {}
        for run in document.get("runs") or []:
            self._runs.setdefault((run["problem"], run["strategy"]), []).append(run)
        self._summary = {(entry["problem"], entry["strategy"]): entry for entry in document.get("summary") or []}
        self._comparisons = {
            (entry["problem"], entry["strategy"]): entry
            for entry in comparisons
            if not entry.get("ablation")
        }
        self.baseline = self._reference()
        others = [name for name in self._listed if name != self.baseline]
        others.sort(key=self._overall)
        self.strategies = ([self.baseline] if self.baseline else []) + others

    def _reference(self) -> str:
        compared = [str(entry["baseline"]) for entry in self._comparisons.values()]
        if compared:
            return compared[0]
        given = self.document["experiment"].get("baseline")
        if given in self._listed:
            return str(given)
        if len(self._listed) < 2:
            return ""
        return next((name for name in self._listed if not self._specs[name]["guided"]), self._listed[0])

    def _overall(self, strategy: str) -> float:
        logs = []
        for problem in self.problems:
            ratio = self.ratio(problem, strategy).value
            if not math.isnan(ratio):
                logs.append(math.log(min(max(ratio, 1e-3), 1e3)))
        return sum(logs) / len(logs) if logs else 0.0

    def __repr__(self) -> str:
        return f"<trellis.figures.Results of {sum(map(len, self._runs.values()))} runs>"

    @property
    def seeds(self) -> int:
        """The number of seeds."""
        return len(self.document["experiment"].get("seeds") or [])

    @property
    def others(self) -> List[str]:
        """The strategies without the baseline, in the order of `strategies`."""
        return [name for name in self.strategies if name != self.baseline]

    @property
    def script(self) -> List[str]:
        """All strategies in the order of the document, with those that `ablate` adds."""
        return list(self._specs)

    def place(self, strategy: str) -> int:
        """The place of a strategy among those that are no baseline, in the order of the document; -1: the baseline."""
        if strategy == self.baseline:
            return -1
        return [name for name in self._listed if name != self.baseline].index(strategy)

    def spec(self, strategy: str) -> Mapping[str, Any]:
        """The entry of `experiment.strategies`."""
        spec: Mapping[str, Any] = self._specs[strategy]
        return spec

    def guided(self, strategy: str) -> bool:
        """Whether the strategy has guides."""
        return bool(self._specs[strategy]["guided"])

    def runs(self, problem: Optional[str], strategy: str) -> List[Mapping[str, Any]]:
        """The runs of a strategy on a problem, or on all problems (None), by problem and seed."""
        where = self.problems if problem is None else [problem]
        return [run for name in where for run in self._runs.get((name, strategy), [])]

    def levels(self, run: Mapping[str, Any]) -> List[Mapping[str, Any]]:
        """The levels of a run of `runs`, the robot's own first: rows of the document's table, with the names of its
        columns."""
        for part in self.parts:
            if any(other is run for other in part.document["runs"]):
                return part.levels(run)
        if self._levels is None:
            self._levels = {}
            for row in rows(self.document.get("levels") or {"rows": 0}):
                self._levels.setdefault(row["run"], []).append(row)
        return self._levels.get(self._number(run), [])

    def scores(self, run: Mapping[str, Any], role: str, path: str = "self") -> Mapping[str, Any]:
        """The figures of the samples of a run's root on a path: a row of the table `measure`; empty where there is
        none."""
        for part in self.parts:
            if any(other is run for other in part.document["runs"]):
                return part.scores(run, role, path)
        if self._scores is None:
            self._scores = {}
            for row in rows(self.document.get("measure") or {"rows": 0}):
                if row["level"] == 0 and row["space"] == "root":
                    self._scores[row["run"], row["role"], row["path"]] = row
        return self._scores.get((self._number(run), role, path), {})

    def _number(self, run: Mapping[str, Any]) -> int:
        return next(i for i, other in enumerate(self.document["runs"]) if other is run)

    def pooled(self, problem: str, strategy: str) -> Mapping[str, Mapping[str, Any]]:
        """The samples of the robot's own level of all seeds together: rows of the table `pooled`, by their role."""
        if self.parts:
            # Samples of several documents do not add up.
            own = [part for part in self.parts if part.runs(problem, strategy)]
            return own[0].pooled(problem, strategy) if len(own) == 1 else {}
        table = self.document.get("pooled") or {"rows": 0}
        if self._pooled is None:
            self._pooled = {}
            for row in rows(table) if table["rows"] else []:
                if row["key"] == "0":
                    self._pooled.setdefault((row["problem"], row["strategy"]), {})[row["role"]] = row
        return self._pooled.get((problem, strategy), {})

    def costs(self, problem: Optional[str], strategy: str, cost: str = "validity_checks") -> "np.ndarray[Any, Any]":
        """What each run costs until its first path; infinite for a run without a path, NaN where it has no such value.

        cost: "validity_checks" or "motion_checks", or "time_s" or "cpu_s" in seconds. Times are of all of a run.

        Raises `Error` for another cost.
        """
        check_cost(cost, _QUANTITIES)
        return np.array([self._cost(run, cost) for run in self.runs(problem, strategy)], float)

    @staticmethod
    def _cost(run: Mapping[str, Any], cost: str) -> float:
        if not run["solved"]:
            return math.inf
        later = number(run.get("improvement_checks", 0)) if cost == "validity_checks" else 0.0
        return number(run[cost]) - later

    def spent(self, problem: Optional[str], strategy: str, cost: str = "validity_checks") -> float:
        """The largest cost of a run, solved or not; 0 without runs."""
        return max((number(run[cost]) for run in self.runs(problem, strategy)), default=0.0)

    def summary(self, problem: Optional[str], strategy: str) -> Optional[Mapping[str, Any]]:
        """The entry of `summary` of a strategy on a problem, or on all of them (None); None where there is none."""
        if problem is None and len(self.problems) == 1:
            problem = self.problems[0]
        return self.entry(problem, strategy)

    def entry(self, problem: Optional[str], strategy: str) -> Optional[Mapping[str, Any]]:
        """The entry of `summary` as the document has it: of a single problem there is none of all problems."""
        return self._summary.get((problem, strategy))

    def comparison(self, problem: Optional[str], strategy: str) -> Optional[Mapping[str, Any]]:
        """The entry of `comparisons`, likewise."""
        if problem is None and len(self.problems) == 1:
            problem = self.problems[0]
        return self._comparisons.get((problem, strategy))

    def median(self, problem: Optional[str], strategy: str, cost: str = "validity_checks") -> Interval:
        """The median cost with its 95 % interval: that of the document's summary where it has one."""
        entry = self.summary(problem, strategy)
        if entry is not None and cost in entry:
            return Interval.of(entry[cost])
        from ._statistics import median_interval  # it imports this module

        return median_interval(list(self.costs(problem, strategy, cost)))

    def ratio(self, problem: Optional[str], strategy: str) -> Interval:
        """The median of the validity checks divided by the baseline's on the same seed, with its 95 % interval."""
        entry = self.comparison(problem, strategy)
        return Interval() if entry is None else Interval.of(entry["ratio"])

    def shown(self, problem: Optional[str], strategy: str) -> bool:
        """Whether the sign test, corrected by Holm, shows a difference to the baseline (5 %)."""
        entry = self.comparison(problem, strategy)
        return entry is not None and number(entry["holm_p"]) < 0.05

    def solved(self, problem: Optional[str], strategy: str) -> Tuple[int, int]:
        """The numbers of solved runs and of runs."""
        runs = self.runs(problem, strategy)
        return sum(1 for run in runs if run["solved"]), len(runs)

    def _named(self, what: str, given: Union[None, str, Sequence[str]], known: Sequence[str]) -> List[str]:
        """The names given, each of which is known; all for None."""
        names = list(known) if given is None else [given] if isinstance(given, str) else list(given)
        for name in names:
            if name not in known:
                raise Error(f"{self.file}: there is no {what} '{name}'; there are: {', '.join(known)}")
        return names

    def chosen(self, strategies: Optional[Sequence[str]]) -> List[str]:
        """The named strategies, in the order of `strategies`; all for None.

        Raises `Error` for an unknown name.
        """
        names = self._named("strategy", strategies, self.strategies)
        return [name for name in self.strategies if name in names]

    def panels(self, problem: Union[None, str, Sequence[str]]) -> List[str]:
        """The named problems, in the order given; all for None.

        Raises `Error` for an unknown name, and for an empty list.
        """
        names = self._named("problem", problem, self.problems)
        if not names and problem is not None:
            raise Error(f"{self.file}: name at least one problem")
        return names


def check_cost(cost: str, known: Sequence[str]) -> None:
    if cost not in known:
        raise Error(f"there is no cost '{cost}'; there are: {', '.join(known)}")


Document = Union[str, "os.PathLike[str]", Mapping[str, Any], Results, Any]


def _absolute(document: Mapping[str, Any]) -> Optional[str]:
    """The folder of samples that a document names, where that needs no folder of the document."""
    folder = document.get("samples")
    return folder if isinstance(folder, str) and os.path.isabs(folder) else None


def read(document: Union[Document, Sequence[Document]], samples: Union[None, str, "os.PathLike[str]"] = None, *,
         baseline: Optional[str] = None, by_name: bool = False) -> Results:
    """Returns the results of a document, or of several together.

    document: the path of a file of `trellis run --json`, its content as a dict, a `trellis.Result`, or a `Results`,
              which is returned as it is. Or a list of these: runs of the same strategies are joined.
    samples:  the folder of `trellis run --samples` with the samples of the document's runs (default the folder that
              the document names, seen from its own folder). Figures of worlds and levels show them.
    baseline: the strategy that the others are compared with (default that of the document).
    by_name:  whether strategies of one name in several documents may differ (default False).

    Raises `Error` for a document of another format, for a file that is no document, for documents whose strategies or
    seeds contradict each other, and for an unknown baseline; OSError where the file cannot be read.
    """
    if not isinstance(document, (list, tuple)):
        results = _read_one(document, samples)
        if baseline is None or baseline == results.baseline:
            return results
        parts = [results]
    else:
        if not document:
            raise Error("name at least one document")
        if len(document) > 1 and samples is not None:
            raise Error("samples are of one document; several documents name their own folders")
        parts = [_read_one(one, samples) for one in document]
        if len(parts) == 1 and baseline in (None, parts[0].baseline):
            return parts[0]
    from ._join import joined

    return joined(parts, baseline, by_name)


def _read_one(document: Document, samples: Union[None, str, "os.PathLike[str]"]) -> Results:
    given = None if samples is None else os.fspath(samples)
    if isinstance(document, Results):
        return document if given is None else Results(document.document, document.file, given)
    if isinstance(document, Mapping):
        return Results(document, samples=given or _absolute(document))
    if isinstance(document, (str, os.PathLike)):
        file = os.fspath(document)
        with open(file, encoding="utf-8") as stream:
            try:
                content = json.load(stream)
            except ValueError as fault:
                raise Error(f"{file}: this is no JSON document ({fault})") from fault
        if not isinstance(content, Mapping):
            raise Error(f"{file}: this is no document of `trellis run --json`")
        if given is None and content.get("samples"):
            given = os.path.join(os.path.dirname(file), str(content["samples"]))
        return Results(content, file, given)
    content = getattr(document, "document", None)
    if isinstance(content, Mapping):
        return Results(content, samples=given or _absolute(content))
    raise Error(f"a document is a path, a dict or a result, got {type(document).__name__}")

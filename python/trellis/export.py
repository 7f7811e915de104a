# SPDX-License-Identifier: MIT-0
"""Writes the runs of a document of results as an SQLite file, which Planner Arena reads too, or for Planner Developer
Tools (PDT):

    python3 -m trellis.export RESULTS --to sqlite FILE
    python3 -m trellis.export RESULTS --to pdt FOLDER

RESULTS is a document of `trellis run --json`, or a folder of `trellis run --out`, `sweep` or `merge`. It needs nothing
but Python itself. docs/formats.md describes the tables.
"""
from __future__ import annotations

import json
import math
import os
import re
import signal
import sqlite3
import struct
import sys
from contextlib import contextmanager
from itertools import groupby
from typing import Any, Dict, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from ._command import Parser, fail
from .columns import rows

FORMAT = 5
APPLICATION = 0x54726C52  # "TrlR", in the header of the file
VERSION_OF_TABLES = 2

Document = Union[str, "os.PathLike[str]", Mapping[str, Any]]


class Error(ValueError):
    """A fault of a document, or of a file that is not replaced."""


class Level(NamedTuple):
    """A level of a run, with its measured sets: those in its own space and those lifted to the root's."""

    entry: Mapping[str, Any]
    own: Mapping[str, Mapping[str, Any]]
    root: Mapping[str, Mapping[str, Any]]


class Run(NamedTuple):
    """A run, with the ids of its problem and strategy, from 1."""

    id: int
    problem: int
    strategy: int
    entry: Mapping[str, Any]
    levels: List[Level]
    measure: List[Mapping[str, Any]]


class Results(NamedTuple):
    """A document, and the manifest of its folder, {} without."""

    document: Mapping[str, Any]
    manifest: Mapping[str, Any]

    @property
    def problems(self) -> Sequence[Mapping[str, Any]]:
        return self.document["experiment"]["problems"]  # type: ignore[no-any-return]

    @property
    def strategies(self) -> Sequence[Mapping[str, Any]]:
        return self.document["experiment"]["strategies"]  # type: ignore[no-any-return]

    def runs(self) -> Iterator[Run]:
        """The runs in the order of the document."""
        problems, strategies = ({one["name"]: k for k, one in enumerate(some, 1)}
                                for some in (self.problems, self.strategies))
        levels, measure = (_by_run(self.document.get(name)) for name in ("levels", "measure"))
        for place, run in enumerate(self.document["runs"]):
            sets = measure.get(place, [])
            yield Run(place + 1, problems[run["problem"]], strategies[run["strategy"]], run,
                      [_level(level, sets) for level in levels.get(place, [])], sets)


def _by_run(table: Optional[Mapping[str, Any]]) -> Dict[int, List[Mapping[str, Any]]]:
    return {run: list(some) for run, some in groupby(rows(table or {"rows": 0}), lambda row: int(row["run"]))}


def _level(level: Mapping[str, Any], sets: Iterable[Mapping[str, Any]]) -> Level:
    found: Dict[str, Dict[str, Mapping[str, Any]]] = {"own": {}, "root": {}}
    for one in sets:
        if one["level"] == level["level"] and one["path"] == "self":
            found[one["space"]][one["role"]] = _bounded(one)
    if level["level"] == 0:  # its own space is the root's
        return Level(level, found["root"], found["root"])
    return Level(level, found["own"], {**found["own"], **found["root"]})


def _bounded(measured: Mapping[str, Any]) -> Mapping[str, Any]:
    """A measured set as reports print it: the bound where the estimate of SE is beyond what is certain."""
    found, uniform = measured["SE"], measured["D_uniform"]
    if found is None or uniform is None:
        return measured
    certain, mixed = measured["D_mass_lower95"], 0.05
    least = 0.0
    if not str(measured["estimator"]).startswith("exact") and measured["D_perfect"] is not None and certain is not None:
        least = -math.log((1 - mixed) * math.exp(-float(certain)) + mixed * math.exp(-uniform))
    found = max(float(found), least, 0.0)
    return {**measured, "SE": found, "above_uniform": uniform - found}


def read(results: Document) -> Results:
    """Reads a document, or that of a folder; a document as dicts and lists is taken as it is."""
    if isinstance(results, Mapping):
        return _checked("the document", results, {})
    file = os.fspath(results)
    if os.path.isdir(file):
        file = os.path.join(file, "results.json")
    beside = os.path.join(os.path.dirname(file), "manifest.json")
    return _checked(file, _json(file), _json(beside) if os.path.exists(beside) else {})


def _json(file: str) -> Mapping[str, Any]:
    try:
        with open(file, encoding="utf-8") as content:
            found = json.load(content)
    except ValueError as fault:
        raise Error(f"{file}: this is no JSON: {fault}") from fault
    if not isinstance(found, Mapping):
        raise Error(f"{file}: this is no document of `trellis run --json`")
    return found


def _checked(file: str, document: Mapping[str, Any], manifest: Mapping[str, Any]) -> Results:
    head = document.get("trellis")
    if not isinstance(head, Mapping) or not isinstance(document.get("experiment"), Mapping):
        raise Error(f"{file}: this is no document of `trellis run --json`")
    if head.get("format", 1) != FORMAT:
        raise Error(f"{file}: the document has format {head.get('format', 1)}; exports read format {FORMAT}: run it "
                    "again with this version")
    return Results(document, manifest)


@contextmanager
def _draft(path: str) -> Iterator[str]:
    """A file beside the final one, which replaces it at the end: the final one has its old content or the new one."""
    draft = f"{path}.part-{os.getpid()}"
    try:
        yield draft
        with open(draft, "rb+") as written:
            os.fsync(written.fileno())
        os.replace(draft, path)
    finally:
        if os.path.exists(draft):
            os.unlink(draft)


# SQLite --------------------------------------------------------------------------------------------------------------


def _text(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


def _value(value: Any) -> Any:
    """A value of the document as SQLite stores it: objects and lists as JSON, integers with a sign."""
    if isinstance(value, (dict, list)):
        return _text(value)
    return value - (1 << 64) if isinstance(value, int) and value >= 1 << 63 else value


class _Table:
    """A table of the database. Its columns are written "NAME TYPE"; those of a source are filled from it by name."""

    def __init__(self, database: sqlite3.Connection, name: str, columns: Sequence[str], constraints: str = "") -> None:
        self._database = database
        self._names = [column.split()[0] for column in columns]
        database.execute(f"CREATE TABLE {name} ({', '.join(columns)}{constraints})")
        self._insert = f"INSERT OR REPLACE INTO {name} VALUES ({', '.join('?' * len(columns))})"

    def add(self, source: Mapping[str, Any], **given: Any) -> None:
        self._database.execute(self._insert, [_value(given[name] if name in given else source.get(name))
                                              for name in self._names])


_RUN_COUNTS = ("validity_checks", "motion_checks", "improvement_checks", "shortcut_checks", "path_checks")
_RUN_NUMBERS = ("work", "set_up_work", "time_s", "cpu_s", "lua_s", "set_up_s", "shared_set_up_s", "path_cpu_s", "length",
                "clearance")


def _inputs(database: sqlite3.Connection, results: Results) -> None:
    document, manifest = results
    experiment = document["experiment"]
    text = "TEXT" if not manifest else "TEXT NOT NULL"  # a document alone does not have it
    _Table(database, "experiment", (
        "id INTEGER PRIMARY KEY", "version TEXT NOT NULL", "script TEXT NOT NULL", f"script_hash {text}",
        f"options {text}", f"files {text}", "description TEXT NOT NULL",
    )).add(manifest, id=1, version=document["trellis"]["version"], script=document["script"], description=experiment)
    problems = _Table(database, "problem", (
        "id INTEGER PRIMARY KEY", "experiment INTEGER NOT NULL REFERENCES experiment", "world TEXT",
        "description TEXT NOT NULL", "name TEXT NOT NULL UNIQUE", "space TEXT NOT NULL", "dimension INTEGER NOT NULL",
        "resolution REAL NOT NULL", "collision TEXT NOT NULL"))
    worlds = manifest.get("worlds", {})
    for place, problem in enumerate(results.problems, 1):
        problems.add(problem, id=place, experiment=1, world=worlds.get(problem["name"]), description=problem)
    strategies = _Table(database, "strategy", (
        "id INTEGER PRIMARY KEY", "experiment INTEGER NOT NULL REFERENCES experiment", "name TEXT NOT NULL UNIQUE",
        "text TEXT NOT NULL", "hash TEXT NOT NULL", "spec TEXT NOT NULL"))
    for place, strategy in enumerate(results.strategies, 1):
        strategies.add(strategy, id=place, experiment=1)


def _scores(level: Level) -> Dict[str, Any]:
    """The columns of a level's samples on its own path."""
    return {f"{space}{role}_{name}": sets.get(role, {}).get(name)
            for space, sets in (("", level.own), ("root_", level.root)) for role in ("tree", "expansion")
            for name in ("SE", "above_uniform", "coverage")}


def _record(run: Run) -> str:
    """All that the document has of a run, as JSON."""
    def whole(row: Mapping[str, Any]) -> Dict[str, Any]:
        return {name: value for name, value in row.items() if name != "run" and value is not None}

    return _text({**run.entry, "levels": [whole(level.entry) for level in run.levels],
                  "measure": [whole(one) for one in run.measure]})


def _runs(database: sqlite3.Connection, results: Results) -> None:
    runs = _Table(database, "run", (
        "id INTEGER PRIMARY KEY", "problem INTEGER NOT NULL REFERENCES problem",
        "strategy INTEGER NOT NULL REFERENCES strategy", "record TEXT NOT NULL", "seed INTEGER NOT NULL",
        "status TEXT NOT NULL", "solved INTEGER NOT NULL", "certified INTEGER NOT NULL",
        *(f"{name} INTEGER NOT NULL" for name in _RUN_COUNTS), *(f"{name} REAL" for name in _RUN_NUMBERS),
        "refuted_paths INTEGER NOT NULL"), ", UNIQUE (problem, strategy, seed)")
    levels = _Table(database, "level", (
        "run INTEGER NOT NULL REFERENCES run", "level INTEGER NOT NULL", "parent INTEGER", "depth INTEGER NOT NULL",
        "key TEXT NOT NULL", "name TEXT NOT NULL", "space TEXT NOT NULL", "dimension INTEGER NOT NULL",
        "planner TEXT NOT NULL", "solves INTEGER NOT NULL", "proposals INTEGER NOT NULL", "accepted INTEGER NOT NULL",
        "nodes INTEGER NOT NULL", "validity_checks INTEGER NOT NULL", "motion_checks INTEGER NOT NULL", "time_s REAL",
        "status TEXT NOT NULL", "solved INTEGER NOT NULL",
        *(f"{space}{role}_{name} REAL" for space in ("", "root_") for role in ("tree", "expansion")
          for name in ("SE", "above_uniform")), "tree_coverage REAL"), ", PRIMARY KEY (run, level)")
    for run in results.runs():
        runs.add(run.entry, id=run.id, problem=run.problem, strategy=run.strategy, record=_record(run))
        for level in run.levels:
            levels.add({**level.entry, **_scores(level)}, run=run.id)


# OMPL's PlannerStatus, by value, and the names of ours.
_OMPL = ("Unknown status", "Invalid start", "Invalid goal", "Unrecognized goal type", "Timeout", "Approximate solution",
         "Exact solution", "Crash", "Abort", "Infeasible")
_STATUS = {"solved": 6, "budget_spent": 4, "no_path": 9, "invalid_start": 1, "invalid_goal": 2}


def _arena(database: sqlite3.Connection, results: Results) -> None:
    """The tables of Planner Arena, as OMPL's ompl_benchmark_statistics.py writes them. The order of the first columns is
    fixed: Planner Arena takes all after the twelfth as parameters of the problems."""
    document = results.document
    seconds = dict.fromkeys((problem["name"] for problem in results.problems), 0.0)
    for run in document["runs"]:
        seconds[run["problem"]] += run["time_s"]
    experiments = _Table(database, "experiments", (
        "id INTEGER PRIMARY KEY AUTOINCREMENT", "name VARCHAR(512)", "totaltime REAL", "timelimit REAL",
        "memorylimit REAL", "runcount INTEGER", "version VARCHAR(128)", "hostname VARCHAR(1024)", "cpuinfo TEXT",
        "date DATETIME", "seed INTEGER", "setup TEXT"))
    seeds = document["experiment"]["seeds"]
    for place, problem in enumerate(results.problems, 1):
        experiments.add({}, id=place, name=problem["name"], totaltime=seconds[problem["name"]], runcount=len(seeds),
                        version="Trellis " + document["trellis"]["version"], hostname="", cpuinfo="", date="",
                        seed=seeds[0], setup=problem)
    planners = _Table(database, "plannerConfigs", (
        "id INTEGER PRIMARY KEY AUTOINCREMENT", "name VARCHAR(512) NOT NULL", "settings TEXT"))
    for place, strategy in enumerate(results.strategies, 1):
        planners.add(strategy, id=place, settings=strategy["text"])
    enums = _Table(database, "enums", ("name VARCHAR(512)", "value INTEGER", "description TEXT"),
                   ", PRIMARY KEY (name, value)")
    for value, description in enumerate(_OMPL):
        enums.add({}, name="status", value=value, description=description)
    runs = _Table(database, "runs", (
        "id INTEGER PRIMARY KEY AUTOINCREMENT", "experimentid INTEGER", "plannerid INTEGER", "status ENUM", "time REAL",
        "cpu_time REAL", "solved BOOLEAN", "correct_solution BOOLEAN", "solution_length REAL",
        "validity_checks INTEGER", "motion_checks INTEGER", "iterations INTEGER", "graph_states INTEGER",
        "tree_above_uniform REAL", "expansion_above_uniform REAL", "tree_coverage REAL", "seed INTEGER"),
        ", FOREIGN KEY (experimentid) REFERENCES experiments(id) ON DELETE CASCADE"
        ", FOREIGN KEY (plannerid) REFERENCES plannerConfigs(id) ON DELETE CASCADE")
    progress = _Table(database, "progress", (
        "runid INTEGER", "time REAL", "best_cost REAL", "validity_checks INTEGER"),
        ", PRIMARY KEY (runid, time), FOREIGN KEY (runid) REFERENCES runs(id) ON DELETE CASCADE")
    for one in results.runs():
        run, root = one.entry, one.levels[0]
        runs.add({**run, **_scores(root)}, id=one.id, experimentid=one.problem, plannerid=one.strategy,
                 status=_STATUS.get(run["status"], 0), time=run["time_s"], cpu_time=run["cpu_s"],
                 correct_solution=run["solved"], solution_length=run["length"], iterations=root.entry["proposals"],
                 graph_states=root.entry["nodes"])
        for step in run["improvements"]:
            progress.add({}, runid=one.id, time=step["cpu_s"], best_cost=step["length"],
                         validity_checks=step["checks"])


def _require_own(file: str) -> None:
    """Raises `Error` for a file that is there and that this did not write."""
    if not os.path.exists(file):
        return
    try:
        database = sqlite3.connect(f"file:{_quoted(os.path.abspath(file))}?mode=ro", uri=True)
        try:
            found = database.execute("PRAGMA application_id").fetchone()[0]
        finally:
            database.close()
    except sqlite3.Error:
        found = None
    if found != APPLICATION:
        raise Error(f"{file}: Trellis did not write this file; it is left as it is")


def _quoted(path: str) -> str:
    return path.replace("%", "%25").replace("?", "%3f").replace("#", "%23")


def sqlite(results: Document, file: "Union[str, os.PathLike[str]]") -> None:
    """Writes one SQLite file: the tables experiment, problem, strategy, run and level, and those of Planner Arena.

    Raises `Error` for a file that something else wrote.
    """
    found, file = read(results), os.fspath(file)
    _require_own(file)
    with _draft(file) as draft:
        database = sqlite3.connect(draft, isolation_level=None)
        try:
            database.execute("PRAGMA synchronous = OFF")
            database.execute("PRAGMA journal_mode = MEMORY")
            database.execute("BEGIN")
            database.execute(f"PRAGMA application_id = {APPLICATION}")
            database.execute(f"PRAGMA user_version = {VERSION_OF_TABLES}")
            for write in (_inputs, _runs, _arena):
                write(database, found)
            database.execute("COMMIT")
        finally:
            database.close()


# PDT -----------------------------------------------------------------------------------------------------------------


def _cell(text: str) -> str:
    """A text as a cell of CSV; a spreadsheet takes none for a formula."""
    number = re.fullmatch(r"-((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|inf(inity)?|nan)", text, re.IGNORECASE)
    formula = text[:1] in set("=+-@\t\r") and not number
    if not formula and not set(',"\r\n') & set(text):
        return text
    return ('"\'' if formula else '"') + text.replace('"', '""') + '"'


def _digits(x: float) -> str:
    text = repr(float(x))
    return text[:-2] if text.endswith(".0") else text


def _before(time: float) -> float:
    """The largest number below a time of more than 0."""
    bits: int = struct.unpack("<q", struct.pack("<d", time))[0]
    return float(struct.unpack("<d", struct.pack("<q", bits - 1))[0]) if bits > 0 else time


def _steps(run: Mapping[str, Any], end: float) -> Iterator[Tuple[float, float]]:
    """The cost of a run over time. PDT interpolates between points, so each step has a point before it."""
    points: List[Tuple[float, float]] = []
    cost = math.inf

    def last() -> float:
        return points[-1][0] if points else 0.0

    def add(time: float, value: float) -> None:
        if time > last():
            points.append((time, value))

    for one in run["improvements"]:
        time = float(one["cpu_s"])
        add(_before(time), cost)
        if run["solved"] and one["length"] is not None:
            cost = float(one["length"])
            if time <= last():
                points[-1] = (last(), cost)
        add(time, cost)
    add(_before(end), cost)
    add(end, cost)
    return iter(points)


class _Names:
    """The names of files for names of problems: what a shell or a file system may not take becomes '-'."""

    def __init__(self) -> None:
        self._of: Dict[str, str] = {}

    def __call__(self, name: str) -> str:
        if name not in self._of:
            safe = re.sub(r"[\x00-\x7f]", lambda it: it[0] if re.match(r"[0-9A-Za-z._+=@,()-]", it[0]) else "-", name)
            safe = "-" + safe[1:] if not safe or safe[0] == "." else safe
            file, k = safe, 2
            while file in self._of.values():
                file, k = f"{safe}-{k}", k + 1
            self._of[name] = file
        return self._of[name]


def pdt(results: Document, folder: "Union[str, os.PathLike[str]]") -> None:
    """Writes for each problem a CSV file that Planner Developer Tools read: for each run a line of times and a line of
    costs, each after the strategy's name. All runs of a file extend to the end of the longest one."""
    found = read(results)
    os.makedirs(folder, exist_ok=True)
    names = _Names()
    for problem, some in groupby(found.document["runs"], lambda run: str(run["problem"])):
        runs = list(some)
        end = max(max([run["time_s"], run["cpu_s"], *(one["cpu_s"] for one in run["improvements"])]) for run in runs)
        with _draft(os.path.join(folder, names(problem) + ".csv")) as draft:
            with open(draft, "w", encoding="utf-8", newline="") as out:
                for run in runs:
                    points = list(_steps(run, float(end)))
                    for k in (0, 1):
                        out.write(", ".join([_cell(run["strategy"]), *(_digits(point[k]) for point in points)]) + "\n")


# The command ---------------------------------------------------------------------------------------------------------


def main(arguments: Optional[Sequence[str]] = None) -> None:
    """Runs the command with these arguments (default those of the process)."""
    parser = Parser(prog="python3 -m trellis.export", allow_abbrev=False, description="Exports the runs of results.")
    parser.add_argument("--to", choices=("sqlite", "pdt"), required=True,
                        help="one SQLite file, also for Planner Arena; or a CSV file for each problem, for PDT")
    parser.add_argument("results", metavar="RESULTS", help="a document, or a folder of trellis run --out, sweep or merge")
    parser.add_argument("out", metavar="OUT", help="the file of sqlite, the folder of pdt")
    options = parser.parse_args(arguments)
    try:
        (sqlite if options.to == "sqlite" else pdt)(options.results, options.out)
    except Error as fault:
        fail(str(fault), 1)
    except sqlite3.Error as fault:
        fail(f"cannot write '{options.out}': {fault}", 1)
    except OSError as fault:
        fail(f"{fault.filename or options.out}: {fault.strerror}", 1)
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as fault:
        fail(f"{options.results}: the document is damaged or incomplete ({type(fault).__name__}: {fault})", 1)


if __name__ == "__main__":
    # A Ctrl-C ends it without a traceback.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    main()

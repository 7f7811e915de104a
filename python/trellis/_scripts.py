# SPDX-License-Identifier: MIT-0
"""Scripts, strategies, and the results of runs."""
from __future__ import annotations

import difflib
import html
import json
import os
import re
import warnings
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple, Union

from . import _trellis
from .columns import rows
from ._trellis import Error, Guide, Problem, Script, Strategy

if TYPE_CHECKING:
    import pandas

    from .figures import Figures

_MOST_JOBS = 1024


def load(path: Union[str, "os.PathLike[str]"], *, trust: bool = False, seed: int = 1) -> Script:
    """Runs a script and returns its strategies, problems and seeds; plans nothing.

    path:  a file in Lua that returns an experiment, or a strategy and a problem.
    trust: whether the script may reach files, processes and the clock (default False: it reads modules and scenes).
    seed:  of the script's `math.random`, an integer of at least 0 (default 1).

    Raises `trellis.Error` for a file that cannot be read and for each mistake of the script, with its line.
    """
    return _trellis.load(os.fspath(path), trust, seed)


def script(text: str, *, folder: Union[str, "os.PathLike[str]"] = ".", trust: bool = False, seed: int = 1) -> Script:
    """The same for the text of a script.

    folder: where its modules and scenes lie (default the current folder).

    Raises `trellis.Error`, whose messages call the script "text".
    """
    return _trellis.load_text(text, os.fspath(folder), trust, seed)


def strategy(text: str, *, folder: Union[str, "os.PathLike[str]"] = ".") -> Strategy:
    """Returns the strategy that an expression describes: `strategy("skeleton() >> rrt { step = 0.5 }")`.

    folder: where files that it names lie (default the current folder).

    Raises `trellis.Error` for unknown names, options out of range, and for anything that is no strategy.
    """
    return _trellis.strategy(text, os.fspath(folder))


def guide(text: str, *, folder: Union[str, "os.PathLike[str]"] = ".") -> Guide:
    """Returns the guide that an expression describes: `guide("skeleton() >> lazy()")`.

    folder: where files that it names lie (default the current folder).

    Raises `trellis.Error` for unknown names, options out of range, and for anything that is no guide.
    """
    return _trellis.guide(text, os.fspath(folder))


def problems(text: str, *, folder: Union[str, "os.PathLike[str]"] = ".") -> List[Problem]:
    """Returns the problems that an expression of the language describes: `problems('scenes.load "maze.yaml"')`.

    Raises `trellis.Error` for unknown names, files that are not there, and for anything that is no problem.
    """
    return _trellis.problems(text, os.fspath(folder))


def problem(text: str, *, folder: Union[str, "os.PathLike[str]"] = ".") -> Problem:
    """The same for one problem: `problem("scenes.trap()")`.

    Raises `trellis.Error` also where there are several.
    """
    found = problems(text, folder=folder)
    if len(found) != 1:
        raise Error(f"problem: the expression gives {len(found)} problems; call problems()")
    return found[0]


def _flat(entry: Mapping[str, Any], prefix: str = "") -> Dict[str, Any]:
    """The numbers and texts of an object, with the names of nested ones joined by dots; without its lists."""
    row: Dict[str, Any] = {}
    for key, value in entry.items():
        if isinstance(value, dict):
            row.update(_flat(value, f"{prefix}{key}."))
        elif not isinstance(value, list):
            row[prefix + key] = value
    return row


def _is_usual(name: str) -> bool:
    """Whether `Result.levels` has a column: what a level is and spends, and its main figures in the root's space."""
    if name.startswith("measure."):
        return re.fullmatch(r"measure\.root\.(tree|expansion)\.(self|cross)\.(SE|above_uniform|coverage)", name) is not None
    return not name.startswith(("metrics.", "resolved_for.", "spent.guided.", "spent.unguided.", "rejections."))


def _measured(measure: Mapping[str, Any]) -> Dict[Tuple[int, int], Dict[str, Any]]:
    """Of each level, by its run and number, the columns of its measured sets, `measure.root.tree.self.SE`."""
    found: Dict[Tuple[int, int], Dict[str, Any]] = {}
    for row in rows(measure):
        run, level, space, path, role = (row.pop(key) for key in ("run", "level", "space", "path", "role"))
        if path not in ("self", "cross"):
            names = [f"measure.{path}.{role}"]
        else:
            names = [f"measure.root.{role}.{path}"] if space == "root" else []
            if space == "own" or level == 0:  # the root's own space is the root's
                names.append(f"measure.{role}.{path}")
        its = found.setdefault((run, level), {})
        for name in names:
            its.update({f"{name}.{key}": value for key, value in row.items() if not isinstance(value, list)})
    return found


def _frame(found: List[Dict[str, Any]]) -> "pandas.DataFrame":
    try:
        import pandas
    except ImportError as missing:
        raise ImportError("frames need pandas (Debian: python3-pandas); `Result.document` does without") from missing
    return pandas.DataFrame(found)


class Result:
    """The results of runs.

    document: the JSON document of `trellis run --json`, as dicts and lists; docs/formats.md describes each field.
    text:     the report that `trellis run` prints. `str` gives it too.
    warnings: what it warns of.
    """

    document: Dict[str, Any]
    text: str
    warnings: List[str]

    def __init__(self, document: str, text: str, warned: Sequence[str]) -> None:
        self._json = document
        self.document = json.loads(document)
        self.text = text
        self.warnings = list(warned)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<trellis.Result of {len(self.document['runs'])} runs>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the report and, where matplotlib is installed, the costs of all runs."""
        shown = f"<pre style='line-height:1.25'>{html.escape(self.text)}</pre>"
        try:
            from .figures import svg
        except ImportError:
            return shown
        return shown + svg(self.figures.costs()) if any(self.document["runs"]) else shown

    @property
    def runs(self) -> "pandas.DataFrame":
        """A row of each run: `problem`, `strategy`, `seed`, `solved`, `validity_checks`, `length` in metres, `cpu_s` in
        seconds, ... Columns are those fields of `document["runs"]` that are no lists; missing values are None or NaN.

        Raises ImportError without pandas.
        """
        return _frame([_flat(run) for run in self.document["runs"]])

    def _level_rows(self) -> List[Dict[str, Any]]:
        runs = self.document["runs"]
        measured = _measured(self.document["measure"])
        found = []
        for row in rows(self.document["levels"]):
            number = row.pop("run")
            of_run = {key: runs[number][key] for key in ("problem", "strategy", "seed")}
            its = {key: value for key, value in row.items() if not isinstance(value, list)}
            found.append({**of_run, **its, **measured.get((number, row["level"]), {})})
        return found

    @property
    def levels(self) -> "pandas.DataFrame":
        """A row of each level of each run: `problem`, `strategy`, `seed`, then the fields of the level: `level` (0 is
        the root), `name`, `validity_checks`, `measure.root.tree.self.SE` in nats (lower is better), ... These are at
        most 40 columns; `levels_by` has those that are named.

        Raises ImportError without pandas.
        """
        found = self._level_rows()
        names: Dict[str, None] = {name: None for row in found for name in row if _is_usual(name)}
        return _frame([{name: row.get(name) for name in names} for row in found])

    def levels_by(self, *columns: str) -> "pandas.DataFrame":
        """A row of each level of each run, with `problem`, `strategy`, `seed`, `level` and the named columns. Names are
        those of the columns of `document["levels"]`, and of the measured sets the space, the role, the path and the
        quantity: `measure.root.tree.cross.coverage`, `resolved_for.rejections`. A name ends in `*` for all that begin so.

        Raises trellis.Error for a name that no level has, and ImportError without pandas.
        """
        levels = self._level_rows()
        known: Dict[str, None] = {name: None for row in levels for name in row}
        chosen: Dict[str, None] = dict.fromkeys(("problem", "strategy", "seed", "level"))
        for column in columns:
            found = [name for name in known if name == column or column[-1:] == "*" and name.startswith(column[:-1])]
            if not found:
                near = difflib.get_close_matches(column, known, 1)
                raise Error(f"levels_by: no level has '{column}'" + (f"; did you mean '{near[0]}'?" if near else ""))
            chosen.update(dict.fromkeys(found))
        return _frame([{name: row.get(name) for name in chosen} for row in levels])

    @property
    def summary(self) -> "pandas.DataFrame":
        """A row of each strategy on each problem: medians and shares over the seeds.

        Raises ImportError without pandas.
        """
        return _frame([_flat(entry) for entry in self.document["summary"]])

    @property
    def figures(self) -> "Figures":
        """The figures and tables of the document: `result.figures.costs()`, `result.figures.save("figures")`.

        Raises ImportError without matplotlib.
        """
        from .figures import Figures

        return Figures(self.document)

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes the document to a file, which `trellis report` and `verify` read.

        Raises OSError where the file cannot be written.
        """
        with open(path, "w", encoding="utf-8") as file:
            file.write(self._json)


def _seeds(seeds: Union[None, int, Iterable[int]], otherwise: List[int]) -> List[int]:
    if seeds is None:
        return otherwise
    if isinstance(seeds, int) and not isinstance(seeds, bool):
        if seeds < 1:
            raise Error(f"seeds: as a number it must be at least 1, got {seeds}")
        return list(range(1, seeds + 1))
    if isinstance(seeds, (bool, str)) or not isinstance(seeds, Iterable):
        raise Error(f"seeds must be a number of seeds or a list of them, got {seeds!r}")
    listed = list(seeds)
    for seed in listed:
        if int(seed) != seed or not 0 <= seed < 2**63:
            raise Error(f"seeds: a seed is an integer in [0, 2^63), got {seed!r}")
    return [int(seed) for seed in listed]


Strategies = Union[Strategy, str, Mapping[str, Union[Strategy, str]]]
Problems = Union[None, Problem, str, Sequence[Union[Problem, str]]]


def _strategies(what: Strategies) -> List[Tuple[str, Strategy]]:
    named: Mapping[str, Union[Strategy, str]] = what if isinstance(what, Mapping) else {"strategy": what}
    made: List[Tuple[str, Strategy]] = []
    for name, spec in named.items():
        if isinstance(spec, str):
            spec = strategy(spec)
        if not isinstance(spec, Strategy):
            raise Error(f"run: '{name}' must be a strategy, got {spec!r}")
        made.append((name, spec))
    return made


def _problems(given: Problems, of: Dict[str, Problem]) -> List[Problem]:
    if given is None:
        if not of:
            raise Error("run: a strategy needs a problem")
        return list(of.values())
    listed = [given] if isinstance(given, (Problem, str)) else list(given)
    found: List[Problem] = []
    for one in listed:
        if isinstance(one, str):
            if of and one not in of:
                raise Error(f"run: the script has no problem '{one}'; it has: {', '.join(of)}")
            found.append(of[one] if of else problem(one))
        elif isinstance(one, Problem):
            found.append(one)
        else:
            raise Error(f"run: a problem is expected, got {one!r}")
    return found


def run(
    what: Union[Script, Strategies],
    problem: Problems = None,
    seeds: Union[None, int, Iterable[int]] = None,
    *,
    strategy: Union[None, str, Sequence[str]] = None,
    baseline: Optional[str] = None,
    measure: bool = True,
    jobs: int = 1,
    threads: int = 1,
    ablation: Optional[float] = None,
    cross: Optional[int] = None,
    samples: Union[None, str, "os.PathLike[str]"] = None,
    progress: Optional[Callable[[int, int], object]] = None,
) -> Result:
    """Plans, scores the samples of each level, and returns the results. The same seeds give the same results, and those
    of `trellis run`, except for times.

    what:     a script (`load`, `script`); or a strategy, or several by name: {"rrt": a, "guided": b}. An expression in
              the language serves as a strategy.
    problem:  of a script the names of some of its problems (default all); else a problem, an expression, or a list.
    seeds:    N for the seeds 1 to N, or a list of integers in [0, 2^63) (default the script's; of a strategy 1).
    strategy: of a script the names of some of its strategies (default all).
    baseline: the strategy to compare the others with, by name (default the script's; else the first without a guide).
    measure:  whether samples are scored (default True: as the script says, and within a tube about the path for a
              strategy). Without it there are no values in nats.
    jobs:     runs at the same time, in [1, 1024] (default 1, so that their times compare).
    threads:  threads of each run, in [1, 1024] (default 1): they compute ahead for searches without a guide.
    ablation: the work for the runs without each guide that decide which guide pays, as a multiple of the work of all
              runs, at least 0 (default the script's; 0, none, for a strategy).
    cross:    the number of other seeds' paths to score each run on, at least 0 (default the script's; 2 for a
              strategy).
    samples:  a folder for the packed samples of all runs, which `result.figures.world()` and `levels_of_world()` show
              (default none). The document names it.
    progress: called with the finished and all steps, in this thread, about 20 times a second.

    Raises `trellis.Error` for a fault of the input and for a folder that cannot be made, before it plans; KeyboardInterrupt on Ctrl-C, within a proposal;
    and what `progress` raises, which stops the runs too. What Trellis warns of is issued by `warnings.warn`.
    """
    for name, number in ("jobs", jobs), ("threads", threads):
        if not isinstance(number, int) or not 1 <= number <= _MOST_JOBS:
            raise Error(f"{name} must be an integer in [1, {_MOST_JOBS}], got {number!r}")
    if ablation is not None and not ablation >= 0:
        raise Error(f"ablation must be at least 0, got {ablation!r}")
    if cross is not None and not cross >= 0:
        raise Error(f"cross must be at least 0, got {cross!r}")
    of = what if isinstance(what, Script) else None
    if isinstance(what, Script):
        there = what.strategies
        names = list(there) if strategy is None else [strategy] if isinstance(strategy, str) else list(strategy)
        for name in names:
            if name not in there:
                raise Error(f"run: the script has no strategy '{name}'; it has: {', '.join(there)}")
        chosen = [(name, there[name]) for name in names]
        where = _problems(problem, what.problems)
        which = _seeds(seeds, what.seeds)
        measure = measure and what.measured
    else:
        if strategy is not None:
            raise Error("run: `strategy` chooses among the strategies of a script")
        chosen = _strategies(what)
        where = _problems(problem, {})
        which = _seeds(seeds, [1])
    document, text, warned = _trellis.run(
        of, chosen, where, which, baseline, measure, jobs, threads, ablation, cross,
        None if samples is None else os.fspath(samples), progress
    )
    for sentence in warned:
        warnings.warn(sentence, stacklevel=2)
    return Result(document, text, warned)

# SPDX-License-Identifier: MIT-0
"""Scripts, strategies, and the results of runs."""
from __future__ import annotations

import difflib
import functools
import html
import inspect
import json
import math
import operator
import os
import re
import warnings
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Mapping, Optional, Sequence, SupportsIndex, Tuple, Union, overload

from . import _trellis
from .columns import rows
from ._trellis import Error, Guide, Known, Problem, Script, Strategy, Value

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


def _text(what: str, text: Any) -> str:
    if not isinstance(text, str):
        raise Error(f"{what}: an expression in the language is a text, got {text!r}")
    if text.endswith(".lua"):
        raise Error(f"{what}: '{text}' is a script: trellis.run(trellis.load('{text}'))")
    if what == "problem" and text.isidentifier():
        for word in _trellis.words():
            if word["module"] in ("scenes", "worlds") and word["name"].endswith("." + text):
                raise Error(f"problem: '{text}' is written {word['name']}()")
    return text


def strategy(text: Union[str, Strategy], *, folder: Union[str, "os.PathLike[str]"] = ".") -> Strategy:
    """Returns the strategy that an expression describes: `strategy("skeleton() >> rrt { step = 0.5 }")`. A strategy is
    returned as it is.

    folder: where files that it names lie (default the current folder).

    Raises `trellis.Error` for unknown names, options out of range, and for anything that is no strategy.
    """
    return text if isinstance(text, Strategy) else _trellis.strategy(_text("strategy", text), os.fspath(folder))


@overload
def guide(text: Union[str, Guide], *, folder: Union[str, "os.PathLike[str]"] = ".") -> Guide: ...
@overload
def guide(text: Callable[[Known], Any], *, cost: float = 20e-6, name: str = "") -> Guide: ...
@overload
def guide(text: None = None, *, cost: float = 20e-6, name: str = "") -> Callable[[Callable[[Known], Any]], Guide]: ...
def guide(
    text: Union[None, str, Guide, Callable[[Known], Any]] = None,
    *,
    folder: Union[str, "os.PathLike[str]"] = ".",
    cost: float = 20e-6,
    name: str = "",
) -> Any:
    """Returns the guide that an expression describes: `guide("skeleton() >> lazy()")`. A guide is returned as it is.

    Of a function it makes a guide without a space of its own, whose h is what the function returns:

        @trellis.guide
        def about_goal(known):
            return known.rng.normal(known.goals[0], 0.3, (known.count, len(known.lo)))

        trellis.run(about_goal >> rrt(), scenes.trap())

    The function takes a `trellis.Known` and returns an array of shape (N, D), N of at least 1: draws in C, in their
    order, possibly invalid; those outside of the bounds are reflected at them. It is called again when they are used,
    for 8, 16, ... 512 draws (`known.count`); if it has read what became of proposals, also when a node was added. It
    composes as all guides do. Runs are deterministic if the function is, with `known.rng` for its random numbers.
    Several runs call it in turn.

    folder: of an expression: where files that it names lie (default the current folder).
    cost:   of a function: the CPU time of a call in seconds, at least 0 (default 20e-6). It counts as work, so that
            bounded loss holds for the CPU time that is stated here.
    name:   of a function: in reports (default its own).

    Raises `trellis.Error` for unknown names, options out of range, and for anything that is no guide; in a run also for
    what a function raises, with its line.
    """
    if text is None:
        return functools.partial(guide, cost=cost, name=name)
    if isinstance(text, Guide):
        return text
    if not callable(text) or isinstance(text, (_trellis.Strategy, _trellis.Value)):
        return _trellis.guide(_text("guide", text), os.fspath(folder))
    if not (isinstance(cost, (int, float)) and 0 <= cost < math.inf):
        raise Error(f"guide: 'cost' must be a number of seconds of at least 0, got {cost!r}")
    called = name or getattr(text, "__name__", type(text).__name__)
    if not called.isidentifier():
        raise Error(f"guide: 'name' must be a name, as \"about_goal\", got {called!r}")
    global _functions
    _functions += 1
    identity = f"python:{getattr(text, '__module__', '')}.{getattr(text, '__qualname__', called)}:{_functions}"
    summary = (inspect.getdoc(text) or "what its function returns").split("\n")[0]
    return _trellis.function_guide(text, called, identity, summary, float(cost))


_functions = 0  # guides made of functions: each is equal to itself alone


def problems(text: str, *, folder: Union[str, "os.PathLike[str]"] = ".") -> List[Problem]:
    """Returns the problems that an expression of the language describes: `problems('scenes.load "maze.yaml"')`.

    Raises `trellis.Error` for unknown names, files that are not there, and for anything that is no problem.
    """
    return _trellis.problems(_text("problem", text), os.fspath(folder))


def problem(text: Optional[str] = None, *, folder: Union[str, "os.PathLike[str]"] = ".", **fields: Any) -> Problem:
    """Returns a problem: of its parts, as the word of the language, or of an expression.

        problem(world=world(bounds=[0, 0, 10, 10]), robot=robot.disc(0.2), start=[1, 1], goal=[9, 9])
        problem("scenes.trap()")

    text:   an expression that gives one problem.
    folder: where files that it names lie (default the current folder).
    fields: in place of `text`: name, world, robot, start, goal, ...; `trellis.help("problem")` describes each.

    Raises `trellis.Error` also where an expression gives several problems.
    """
    if text is None or fields:
        if text is not None:
            raise Error("problem: takes an expression, or parts by name; got both")
        made: Problem = _trellis.call("problem", (), fields)
        return made
    assert text is not None
    found = problems(text, folder=folder)
    if len(found) != 1:
        raise Error(f"problem: the expression gives {len(found)} problems; call problems()")
    place = os.path.abspath(folder)
    setattr(found[0], "_made_by", lambda: (_problem, (text, place)))  # for pickle
    return found[0]


def _problem(text: str, folder: str) -> Problem:
    return problem(text, folder=folder)


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
    if isinstance(seeds, SupportsIndex) and not isinstance(seeds, bool) and getattr(seeds, "ndim", 0) == 0:
        seeds = operator.index(seeds)  # also numbers of numpy
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


Strategies = Union[Strategy, str, Mapping[str, Union[Strategy, str]], Sequence[Union[Strategy, str]]]
Problems = Union[None, Problem, str, Sequence[Union[Problem, str]], Mapping[str, Union[Problem, str]]]


def _strategies(of: str, what: Strategies) -> List[Tuple[str, Strategy]]:
    """The strategies by name. Those of a list have their texts as names, as in the language."""
    if isinstance(what, Mapping):
        pairs: List[Tuple[Optional[str], Any]] = list(what.items())
    elif isinstance(what, (list, tuple)):
        pairs = [(None, spec) for spec in what]
    else:
        pairs = [("strategy", what)]
    made: List[Tuple[str, Strategy]] = []
    for name, spec in pairs:
        if isinstance(spec, str):
            spec = strategy(spec)
        if isinstance(spec, Guide):
            raise Error(f"{of}: '{spec}' is a guide, which plans nothing; a strategy ends with a planner: {spec} >> rrt()")
        if not isinstance(spec, Strategy):
            raise Error(f"{of}: '{name}' must be a strategy, got {spec!r}" if name else f"{of}: a strategy is expected, got {spec!r}")
        made.append((str(spec) if name is None else name, spec))
    return made


def _problems(of: str, given: Problems, there: Dict[str, Problem]) -> List[Problem]:
    """The problems: of a script those that are named, all for None; else those given, under the names of a dict."""
    if given is None:
        if not there:
            raise Error(f"{of}: a strategy needs a problem")
        return list(there.values())
    if isinstance(given, Mapping):
        return [_trellis.named(one, name) for name, one in zip(given, _problems(of, list(given.values()), there))]
    if not isinstance(given, (Problem, str, Iterable)):
        raise Error(f"{of}: a problem is expected, got {given!r}")
    listed = [given] if isinstance(given, (Problem, str)) else list(given)
    found: List[Problem] = []
    for one in listed:
        if isinstance(one, str):
            if there and one not in there:
                raise Error(f"{of}: the script has no problem '{one}'; it has: {', '.join(there)}")
            found.append(there[one] if there else problem(one))
        elif isinstance(one, Problem):
            found.append(one)
        elif isinstance(one, (list, tuple)):
            found.extend(_problems(of, one, there))  # of a file
        else:
            raise Error(f"{of}: a problem is expected, got {one!r}")
    return found


def experiment(
    problems: Problems,
    strategies: Strategies,
    seeds: Union[None, int, Iterable[int]] = None,
    *,
    measure: Union[None, bool, Value] = None,
    baseline: Optional[str] = None,
    **options: Any,
) -> Script:
    """Prepares problems x strategies x seeds, as `experiment { ... }` of the language; `run()` of what it returns plans,
    as `trellis.run` does.

        experiment(problems=[scenes.trap(), scenes.cup()], strategies={"rrt": rrt(), "guided": skeleton() >> rrt()},
                   baseline="rrt", seeds=20, measure=tube(delta=0.5)).run(jobs=4)

    problems:   a problem, a list of them, or a dict, whose keys are then their names. Expressions in the language serve
                as problems and strategies, too.
    strategies: a dict of strategies by name, or a list, whose strategies have their texts as names.
    seeds:      N for the seeds 1 to N, or a list of integers in [0, 2^63) (default 1).
    measure:    what samples are measured against, as tube(delta=0.5), or False (default tube()).
    baseline:   the strategy to compare the others with, by name (default the first without a guide).
    options:    the others of `trellis.help("experiment")`: ablate, ablation, groups, shortcut, cross, ...

    Raises `trellis.Error` for each fault.
    """
    fields: Dict[str, Any] = dict(options)
    fields["problems"] = _problems("experiment", problems, {})
    fields["strategies"] = [[name, spec] for name, spec in _strategies("experiment", strategies)]
    if seeds is not None:
        fields["seeds"] = seeds if "seed" in options else _seeds(seeds, [])
    if measure is not None and measure is not True:
        fields["measure"] = measure
    if baseline is not None:
        fields["baseline"] = baseline
    made: Script = _trellis.call("experiment", (), fields)
    return made


def run(
    what: Union[Script, Strategies],
    problem: Problems = None,
    seeds: Union[None, int, Iterable[int]] = None,
    *,
    strategy: Union[None, str, Sequence[str]] = None,
    baseline: Optional[str] = None,
    measure: Union[None, bool, Value] = None,
    jobs: int = 1,
    threads: int = 1,
    ablation: Optional[float] = None,
    cross: Optional[int] = None,
    samples: Union[None, str, "os.PathLike[str]"] = None,
    progress: Optional[Callable[[int, int], object]] = None,
) -> Result:
    """Plans, scores the samples of each level, and returns the results. The same seeds give the same results, and those
    of `trellis run`, except for times.

    what:     a script (`load`, `script`, `experiment`); or a strategy, several by name: {"rrt": a, "guided": b}, or a
              list. An expression in the language serves as a strategy.
    problem:  of a script the names of some of its problems (default all); else a problem, an expression, a list, or a
              dict, whose keys are then their names.
    seeds:    N for the seeds 1 to N, or a list of integers in [0, 2^63) (default the script's; of a strategy 1).
    strategy: of a script the names of some of its strategies (default all).
    baseline: the strategy to compare the others with, by name (default the script's; else the first without a guide).
    measure:  whether samples are scored, which takes longer than planning: of a script False where it shall not (by
              default it is as the script says); of a strategy True for a tube about the path, or what they are measured
              against, as tube(delta=0.5) (default False). Without it there are no values in nats.
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
    if measure is not None and not isinstance(measure, (bool, Value)):
        raise Error(f"run: measure is True, False, or a target, as tube(delta=0.5), got {measure!r}")
    if isinstance(measure, Value):
        if isinstance(what, Script):
            raise Error("run: a script says what its samples are measured against; measure=False leaves it out")
        if strategy is not None:
            raise Error("run: `strategy` chooses among the strategies of a script")
        what = experiment(_problems("run", problem, {}), dict(_strategies("run", what)), seeds, measure=measure, ablation=0)
        problem = None
        seeds = None
    if isinstance(what, Script):
        of: Optional[Script] = what
        there = what.strategies
        names = list(there) if strategy is None else [strategy] if isinstance(strategy, str) else list(strategy)
        for name in names:
            if name not in there:
                raise Error(f"run: the script has no strategy '{name}'; it has: {', '.join(there)}")
        chosen = [(name, there[name]) for name in names]
        where = _problems("run", problem, what.problems)
        which = _seeds(seeds, what.seeds)
        measured = measure is not False and what.measured
    else:
        if strategy is not None:
            raise Error("run: `strategy` chooses among the strategies of a script")
        of = None
        chosen = _strategies("run", what)
        where = _problems("run", problem, {})
        which = _seeds(seeds, [1])
        measured = measure is True
    document, text, warned = _trellis.run(
        of, chosen, where, which, baseline, measured, jobs, threads, ablation, cross,
        None if samples is None else os.fspath(samples), progress
    )
    for sentence in warned:
        warnings.warn(sentence, stacklevel=2)
    return Result(document, text, warned)

# SPDX-License-Identifier: MIT-0
"""Scores the samples of any planner, as `trellis measure` does, with the same code."""
from __future__ import annotations

import json
import math
import operator
import os
from array import array
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple, Union

from . import _trellis
from ._trellis import Error, Problem

if TYPE_CHECKING:
    from ._sampler import Sampler

Interval = Tuple[float, float]
Valid = Union[None, Problem, Callable[[Tuple[float, ...]], bool]]
Path = Union[str, "os.PathLike[str]"]


def _number(value: Any) -> float:
    """A number of the document: missing values are null, and infinite ones are texts."""
    return math.nan if value is None else float(value)


def _interval(of: Mapping[str, Any], name: str) -> Interval:
    return _number(of[name + "_lo"]), _number(of[name + "_hi"])


class Measurement:
    """The scores of samples relative to a target T about a path. Values are in nats; a missing one is NaN.

    document: all figures of `trellis measure --json`; docs/formats.md describes each field.
    text:     the table that `trellis measure` prints. `str` gives it too.
    """

    document: Dict[str, Any]
    text: str

    def __init__(self, document: str, text: str) -> None:
        self.document = json.loads(document)
        self.text = text

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        lo, hi = self.se_interval
        return f"<trellis.Measurement SE {self.se:.3f} [{lo:.2f}, {hi:.2f}] of {self.n} samples>"

    @property
    def se(self) -> float:
        """SE_T(Q), the divergence of T from the samples with 5 % uniform ones mixed in; at least 0, less is better. The
        estimate of `estimator`."""
        return _number(self.document["SE"])

    @property
    def se_interval(self) -> Interval:
        """The 95 % interval of `se` that the samples support."""
        return _interval(self.document, "SE")

    @property
    def mass(self) -> float:
        """The part of `se` that comes from samples outside of T: `se` = `mass` + `spread`."""
        return _number(self.document["SE_parts"]["mass"])

    @property
    def mass_interval(self) -> Interval:
        """The 95 % interval of `mass` (Clopper and Pearson)."""
        return _interval(self.document["SE_parts"], "mass")

    @property
    def spread(self) -> float:
        """The part of `se` that comes from how unevenly the samples within T cover it."""
        return _number(self.document["SE_parts"]["spread"])

    @property
    def spread_interval(self) -> Interval:
        """The 90 % interval of `spread`, by the 95 % intervals of `se` and `mass`."""
        return _interval(self.document["SE_parts"], "spread")

    @property
    def uniform(self) -> float:
        """`se` of uniform sampling of the space."""
        return _number(self.document["D_uniform"])

    @property
    def perfect(self) -> float:
        """`se` of perfect guidance, samples of T itself; positive, because of the 5 % uniform ones."""
        return _number(self.document["D_perfect"])

    @property
    def above_uniform(self) -> float:
        """`uniform` - `se`: nats above uniform sampling, more is better."""
        return _number(self.document["above_uniform"])

    @property
    def hitting(self) -> float:
        """How much sooner than uniform samples these hit the balls along the path in turn, nats, more is better."""
        return _number(self.document["hitting"]["nats"])

    @property
    def bottleneck(self) -> float:
        """The least log ratio of the share of the samples in such a ball to that of uniform samples, nats."""
        return _number(self.document["bottleneck"]["nats"])

    @property
    def bottleneck_at(self) -> float:
        """The place of the bottleneck: arc length along the path, metres."""
        return _number(self.document["bottleneck"]["at"])

    @property
    def n(self) -> int:
        """The number of samples."""
        return int(self.document["N"])

    @property
    def in_target(self) -> int:
        """How many of them lie in T."""
        return int(self.document["n"])

    @property
    def estimator(self) -> str:
        """The estimator of `se`."""
        return str(self.document["estimator"])

    @property
    def flags(self) -> List[str]:
        """What limits the figures: "underpowered", "censored", "invalid path", ..."""
        return list(self.document["flags"])


def _by_names(values: Any, names: Sequence[str], what: str) -> Any:
    """The columns of a frame in the order of the coordinates. A frame whose columns have numbers has that order."""
    columns = [str(name) for name in values.columns]
    if all(isinstance(name, int) or not isinstance(name, str) for name in values.columns):
        return values.to_numpy()
    missing = [name for name in names if columns.count(name) != 1]
    if missing:
        raise Error(
            f"recorder: a frame of {what}s needs one column for each coordinate; {', '.join(missing)} "
            f"{'is' if len(missing) == 1 else 'are'} not there once; it has {', '.join(columns)}. Give an array for "
            "columns in the order of the coordinates: frame.to_numpy()"
        )
    others = [name for name in columns if name not in names]
    if others:
        raise Error(f"recorder: a frame of {what}s has other columns: {', '.join(others)}; choose {list(names)}")
    return values[list(names)].to_numpy()


def _rows(values: Any, names: Sequence[str], what: str) -> "array[float]":
    """The numbers of one configuration, or of several, row by row."""
    dimension = len(names)
    if hasattr(values, "columns") and hasattr(values, "to_numpy"):
        values = _by_names(values, names, what)
    if hasattr(values, "__array__"):
        return _array_rows(values, dimension, what)
    try:
        listed = list(values)
        if listed and not hasattr(listed[0], "__len__"):
            listed = [listed]
        flat = array("d")
        for i, row in enumerate(listed):
            if isinstance(row, str):
                raise TypeError("a text is no row")
            if len(row) != dimension:
                raise Error(f"recorder: {what} {i + 1} has {len(row)} coordinates, not {dimension}")
            flat.extend(float(x) for x in row)
    except (OverflowError, TypeError, ValueError) as fault:
        raise Error(f"recorder: {what}s must be an array of N rows of {dimension} numbers ({fault})") from fault
    for i, x in enumerate(flat):
        if not math.isfinite(x):
            raise Error(f"recorder: {what} {i // dimension + 1} has a coordinate that is not finite")
    return flat


def _array_rows(values: Any, dimension: int, what: str) -> "array[float]":
    """The same for an array of numpy."""
    import numpy

    if numpy.any(getattr(values, "mask", False)):
        raise Error(f"recorder: {what}s have masked numbers; choose the rows without: values[~values.mask.any(axis=1)]")
    try:
        table = numpy.ascontiguousarray(values, dtype=float)
    except (OverflowError, TypeError, ValueError) as fault:
        raise Error(f"recorder: {what}s must be an array of numbers ({fault})") from fault
    if table.ndim == 1 and table.size:
        table = table.reshape(1, -1)
    if table.size and (table.ndim != 2 or table.shape[1] != dimension):
        raise Error(f"recorder: {what}s must be an array of shape (N, {dimension}), got {table.shape}")
    finite = numpy.isfinite(table)
    if not finite.all():
        row = int(numpy.argwhere(~finite)[0][0])
        raise Error(f"recorder: {what} {row + 1} has a coordinate that is not finite")
    return array("d", table.tobytes())


def _whole(value: Any, name: str) -> int:
    """An integer, of numpy too."""
    try:
        return operator.index(value)
    except TypeError as fault:
        raise Error(f"recorder: '{name}' must be an integer, got {value!r}") from fault


def _listed(values: Iterable[Any]) -> List[Any]:
    return list(values.tolist() if hasattr(values, "tolist") else values)


class Recorder:
    """Collects the samples of a planner, and scores them relative to a path.

        recorder = trellis.Recorder(lo=[0, 0, -pi], hi=[10, 10, pi], weights=[1, 1, 0.5], angles=[2])
        for state in planner.states(): recorder.add(state)
        print(recorder.measure(path, delta=0.5))

    lo, hi:    bounds of the D coordinates, D in [1, 100]; metres, or radians of an angle. lo < hi.
    weights:   metres of the metric per unit of the coordinate, greater than 0 (default 1 each). The metric is the root
               of the sum of squares.
    angles:    the numbers, from 0, or the names of the coordinates that wrap from hi to lo (default none).
    names:     the coordinates' names, no two alike (default q1 to qD).
    rotations: of each rotation in space the names of four neighbouring coordinates, a quaternion x, y, z, w of norm 1;
               they have one weight, metres per radian (default none).
    valid:     what decides validity: a function of a tuple of D numbers that returns a bool, or a `trellis.Problem`
               (default None: every configuration counts as valid). With it the target is the valid part of the tube, so
               that no sampler is blamed for not sampling obstacles.
    free:      the same by a name: a scene of the standard library, a scene file, or a script (default None).

    Raises `trellis.Error` that names the argument for a fault of these, when it measures.
    """

    def __init__(
        self,
        lo: Iterable[float],
        hi: Iterable[float],
        *,
        weights: Optional[Iterable[float]] = None,
        angles: Iterable[Union[int, str]] = (),
        names: Optional[Sequence[str]] = None,
        rotations: Sequence[Sequence[str]] = (),
        valid: Valid = None,
        free: Optional[Path] = None,
    ) -> None:
        low = _listed(lo)
        self._dimension = len(low)
        coordinates = [f"q{j + 1}" for j in range(self._dimension)] if names is None else list(names)
        self._space: Dict[str, Any] = {
            "dim": self._dimension,
            "coords": coordinates,
            "weights": [1.0] * self._dimension if weights is None else _listed(weights),
            "lo": low,
            "hi": _listed(hi),
        }
        periodic = [False] * self._dimension
        for angle in angles:
            if isinstance(angle, str):
                if angle not in coordinates:
                    there = ", ".join(coordinates)
                    raise Error(f"recorder: angles: there is no coordinate '{angle}'; there are: {there}")
                angle = coordinates.index(angle)
            angle = _whole(angle, "angles")
            if not 0 <= angle < self._dimension:
                raise Error(f"recorder: angles: a coordinate is in [0, {self._dimension - 1}], got {angle}")
            periodic[angle] = True
        self._space["periodic"] = periodic
        if rotations:
            self._space["rotations"] = [list(rotation) for rotation in rotations]
        if valid is not None and free is not None:
            raise Error("recorder: give `valid` or `free`, not both")
        self._valid = valid
        self._free = None if free is None else os.fspath(free)
        self._samples = array("d")

    @classmethod
    def of(cls, problem: Union[Problem, "Sampler"], samples: str = "proposals") -> "Recorder":
        """Returns a recorder for the space of a problem, with its validity; or for that of a sampler, with the samples
        of its planner so far.

        samples: of a sampler, "proposals" (default), all draws; or "nodes", those of the planner's tree or roadmap.
        """
        if not isinstance(problem, Problem):
            if samples not in ("proposals", "nodes"):
                raise Error(f"recorder: samples are \"proposals\" or \"nodes\", got {samples!r}")
            recorder = cls.of(problem.problem)
            recorder.add(problem.levels[0][samples])
            return recorder
        wraps = [j for j, periodic in enumerate(problem.periodic) if periodic]
        return cls(
            problem.lo,
            problem.hi,
            weights=problem.weights,
            angles=wraps,
            names=problem.names,
            rotations=problem.rotations,
            valid=problem,
        )

    def __len__(self) -> int:
        """The number of samples."""
        return len(self._samples) // self._dimension

    def add(self, samples: Any) -> None:
        """Adds a sample of D numbers, or several: an array of shape (N, D), or a list of rows, in any order. Of a frame
        of pandas the columns called as the coordinates are taken, in whatever order they are.

        Raises `trellis.Error` for another number of coordinates, for numbers that are masked or not finite, and for a
        frame with other columns.
        """
        self._samples.extend(_rows(samples, self._space["coords"], "sample"))

    def clear(self) -> None:
        """Removes all samples."""
        self._samples = array("d")

    def measure(
        self,
        path: Any,
        *,
        delta: float,
        samples: Any = None,
        distance: str = "full",
        estimator: str = "",
        seed: int = 1,
    ) -> Measurement:
        """Scores the samples. The figures are those of `trellis measure` for the same samples and path.

        path:      configurations from start to goal, of shape (K, D), K of at least 2. Shorten it first: the target
                   lies about it.
        delta:     the radius of the tube about the path, metres of the metric, greater than 0.
        samples:   samples to score instead of those that were added, of shape (N, D) (default None).
        distance:  "full" (default), or "planar": the tube is measured by the position alone.
        estimator: a name, or "all" (default "": knn, and arc from five degrees of freedom on).
        seed:      of the points that integrate over the target, an integer of at least 0 (default 1).

        Raises `trellis.Error` for a fault of these, where no sample lies within the bounds, and where nothing valid
        lies within the tube; KeyboardInterrupt on Ctrl-C; and what the function `valid` raises.
        """
        given = self._samples if samples is None else _rows(samples, self._space["coords"], "sample")
        if not given:
            raise Error("recorder: there are no samples; add some first")
        points = _rows(path, self._space["coords"], "configuration of the path")
        if len(points) < 2 * self._dimension:
            raise Error(f"recorder: a path is of shape (K, {self._dimension}) with K of at least 2, from start to goal")
        case: Mapping[str, Any] = {
            **self._space,
            "path": [points[i : i + self._dimension].tolist() for i in range(0, len(points), self._dimension)],
            "delta": delta,
            "distance": distance,
            "seed": _whole(seed, "seed"),
            **({} if self._free is None else {"free": self._free}),
        }
        try:
            text = json.dumps(case, allow_nan=False, default=float)
        except (OverflowError, TypeError, ValueError) as fault:
            raise Error(f"recorder: all numbers must be finite ({fault})") from fault
        count = len(given) // self._dimension
        table = memoryview(given).cast("B").cast("d", [count, self._dimension])
        return Measurement(*_trellis.measure(text, os.getcwd(), table, estimator, self._valid))


def measure(
    samples: Any, path: Any, *, lo: Iterable[float], hi: Iterable[float], delta: float, **options: Any
) -> Measurement:
    """Scores samples in one call: `measure(samples, path, lo=[0, 0], hi=[10, 10], delta=0.5)`.

    samples: of shape (N, D). path: of shape (K, D). The other arguments are those of `Recorder` and `Recorder.measure`.

    Raises `trellis.Error` as these do.
    """
    scoring = {key: options.pop(key) for key in ("distance", "estimator", "seed") if key in options}
    return Recorder(lo, hi, **options).measure(path, delta=delta, samples=samples, **scoring)

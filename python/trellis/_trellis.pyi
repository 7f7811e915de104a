# SPDX-License-Identifier: MIT-0
"""Types of the native part. The functions are those that the package calls; call the package's own."""
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union, overload

class Error(Exception):
    """What Trellis reports of an input: a script, a problem, samples."""

    messages: List[str]
    """One message for each fault, as the program prints them."""

class Strategy:
    """A hierarchy of guiding spaces with a planner at its root. Immutable; `str` gives it in the language."""

    def __eq__(self, other: object) -> bool: ...
    def __hash__(self) -> int: ...
    def tree(self) -> str:
        """The hierarchy as a tree of text, a line for each level."""
    def json(self) -> str:
        """The hierarchy as JSON, with every option."""
    def hash(self) -> str:
        """16 hexadecimal digits, equal for equal strategies."""

class Guide:
    """A guide, or a hierarchy or combination of guides. Immutable; `str` gives it in the language.

    `a >> b` guides b by a, `0.7 * a + 0.3 * b` mixes; `sequence(a, b)` is what the language writes as a .. b.
    """

    def __eq__(self, other: object) -> bool: ...
    def __hash__(self) -> int: ...
    @overload
    def __rshift__(self, guided: Guide) -> Guide: ...
    @overload
    def __rshift__(self, guided: Strategy) -> Strategy: ...
    def __add__(self, other: Guide) -> Guide: ...
    def __mul__(self, weight: float) -> Guide: ...
    def __rmul__(self, weight: float) -> Guide: ...

class Value:
    """A value of the language of another type, as a world, a robot or a target. Immutable.

    Its members are those of the language: `world.obstacles`, `robot.scaled(0.5)`.
    """

    def __eq__(self, other: object) -> bool: ...
    def __hash__(self) -> int: ...
    def __getattr__(self, name: str) -> Any: ...
    def __call__(self, *given: Any, **named: Any) -> Any: ...

class Problem:
    """A world, a robot, a start, and goals. Immutable.

    It has the members of the language, too: `problem.world`, `problem.robot`.
    """

    def __getattr__(self, name: str) -> Any: ...

    @property
    def name(self) -> str: ...
    @property
    def names(self) -> List[str]:
        """The coordinates' names, D of them."""
    @property
    def lo(self) -> List[float]:
        """Lower bounds of the coordinates; metres, or radians of an angle."""
    @property
    def hi(self) -> List[float]:
        """Upper bounds of the coordinates."""
    @property
    def weights(self) -> List[float]:
        """Metres of the metric per unit of the coordinate."""
    @property
    def periodic(self) -> List[bool]:
        """Whether the coordinate wraps from `hi` to `lo`."""
    @property
    def rotations(self) -> List[List[str]]:
        """Of each rotation in space the names of its quaternion's four coordinates."""
    @property
    def start(self) -> List[float]: ...
    @property
    def goals(self) -> List[List[float]]: ...
    def valid(self, q: Any) -> Any:
        """Whether the robot at `q` (D numbers) is within its bounds and touches no obstacle. Of an array of shape (N, D)
        an array of N bools.

        Raises `trellis.Error` for another number of coordinates.
        """
    def fault(self, q: Sequence[float]) -> str:
        """Why `q` is not valid: a joint beyond its limits, or what touches what. "" where it is valid."""
    def joints(self) -> List[Dict[str, object]]:
        """Each coordinate of a robot of a URDF file: `name`, `kind` of joint, limits `lower`, `upper` in radians or
        metres, and its greatest `velocity` a second; None where the file states none.
        """
    def ik(
        self,
        link: str,
        position: Sequence[float],
        rpy: Optional[Sequence[float]] = None,
        quaternion: Optional[Sequence[float]] = None,
        within: Tuple[float, float] = (0.001, 0.01),
        seed: Union[int, Sequence[float]] = 0,
        count: int = 10,
    ) -> List[List[float]]:
        """Valid configurations that bring a link to a pose of the world, at most `count`; [] where none is found.

        The orientation is given by `rpy` in radians or by a quaternion x, y, z, w; `within` says how near to the pose,
        in metres and radians, of which pi or more means any orientation. A configuration as `seed` is where the first
        attempt starts, and the nearest to it come first; a number is that of the random starts.
        Raises `trellis.Error` for a robot that is not one of a URDF file.
        """

class Script:
    """What a script returns."""

    @property
    def path(self) -> str:
        """The file, "" of a text."""
    @property
    def strategies(self) -> Dict[str, Strategy]: ...
    @property
    def problems(self) -> Dict[str, Problem]: ...
    @property
    def seeds(self) -> List[int]: ...
    @property
    def measured(self) -> bool:
        """Whether its experiment scores samples."""
    @property
    def warnings(self) -> List[str]: ...
    def run(self, *given: Any, **named: Any) -> Any:
        """The results of `trellis.run(script, ...)`."""

def version() -> str:
    """The version of Trellis."""

def commit() -> str:
    """The commit of its sources, "" where they were no git repository."""

def words() -> List[Dict[str, Any]]: ...
def help_text(name: str) -> str: ...
def call(name: str, given: Tuple[Any, ...], named: Dict[str, Any]) -> Any: ...
def named(problem: Problem, name: str) -> Problem: ...
def load(path: str, trust: bool, seed: int) -> Script: ...
def load_text(text: str, folder: str, trust: bool, seed: int) -> Script: ...
def strategy(text: str, folder: str) -> Strategy: ...
class Known:
    """What a function that `trellis.guide` makes a guide of may read, during its call: copies as arrays of numpy.

    q:          the proposals in C so far, of shape (N, D), of all guides.
    fate:       what became of each, of shape (N,): 0 rejected, 1 a node was added on the way, 2 at the proposal.
    node:       the node that was added, of shape (N, D); NaN where none was.
    blocked_at: the first configuration found invalid, of shape (N, D); NaN where none was.
    mine:       whether this guide drew it, of shape (N,).
    start, goals: of shape (D,) and (K, D).
    names, lo, hi, weights: of the D coordinates.
    count:      how many draws are wanted: any other number is allowed.
    rng:        a generator of numpy with a seed of this call.
    """

    q: Any
    fate: Any
    node: Any
    blocked_at: Any
    mine: Any
    start: Any
    goals: Any
    names: List[str]
    lo: Any
    hi: Any
    weights: Any
    count: int
    rng: Any

    def valid(self, rows: Any) -> Any:
        """Whether configurations of shape (N, D) are valid, of shape (N,). Each counts as a validity check."""

def function_guide(function: Callable[[Known], Any], name: str, identity: str, summary: str, cost: float) -> Guide: ...

class Sampler:
    def draw(self, side: str) -> Tuple[int, Any, bool, Optional[int]]: ...
    def draw_many(self, n: int, side: str) -> Any: ...
    def root(self, side: str, goal: int) -> int: ...
    def node(self, q: Any) -> Optional[int]: ...
    def nodes(self) -> int: ...
    def accepted(self, id: int, q: Any, parent: Optional[int], reached: bool, connected: bool, side: str) -> int: ...
    def rejected(self, id: int, start: Any, end: Any, at: Any) -> None: ...
    def joined(self, node: int, side: str) -> None: ...
    def cleared(self) -> None: ...
    def path_found(self, length: float) -> None: ...
    def worth_connecting(self, start: Any, end: Any) -> bool: ...
    def edge_factor(self, a: Any, b: Any) -> float: ...
    def spent(self, checks: int) -> None: ...
    def allow(self, checks: int) -> str: ...
    def state(self) -> str: ...
    def checks(self) -> int: ...
    def density(self, Q: Any) -> Any: ...
    def levels(self) -> List[Dict[str, Any]]: ...

def sampler(
    guide: Guide,
    problem: Problem,
    seed: int,
    step: float,
    uniform: float,
    goal_bias: float,
    grant: float,
    optimistic: bool,
) -> Sampler: ...
def guide(text: str, folder: str) -> Guide: ...
def problems(text: str, folder: str) -> List[Problem]: ...
def run(
    script: Optional[Script],
    strategies: Sequence[Tuple[str, Strategy]],
    problems: Sequence[Problem],
    seeds: Sequence[int],
    baseline: Optional[str],
    measured: bool,
    jobs: int,
    threads: int,
    ablation: Optional[float],
    cross: Optional[int],
    samples: Optional[str],
    progress: Optional[Callable[[int, int], object]],
) -> Tuple[str, str, List[str]]: ...
def measure(
    case: str,
    folder: str,
    samples: memoryview,
    estimator: str,
    valid: Union[None, Problem, Callable[[Tuple[float, ...]], bool]],
) -> Tuple[str, str]: ...

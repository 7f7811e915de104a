# SPDX-License-Identifier: MIT-0
"""Guiding spaces for motion planning: run Trellis scripts and strategies, and score the samples of any planner.

    import trellis
    script = trellis.load("gaps.lua")
    result = trellis.run(script.strategies["nested"], script.problems["false_gaps"], seeds=10)
    print(result.runs[["seed", "solved", "validity_checks"]])

    from trellis import lazy, rrt, scenes, skeleton       # every word of the language
    trellis.run(skeleton() >> lazy() >> rrt(step=0.5), scenes.trap(), seeds=10)

    recorder = trellis.Recorder(lo=[0, 0], hi=[10, 10])
    recorder.add(samples)                      # of any planner: an array of N rows
    print(recorder.measure(path, delta=0.5))   # SE_T(Q), mass and spread, with intervals

    from trellis import figures                # figures and tables for papers
    figures.save("results.json", "figures")

Faults of an input raise `trellis.Error`, with the message that the program prints. Calls release the interpreter lock,
and Ctrl-C stops a run. pandas is needed for frames and tables only, matplotlib and numpy for figures only. The compiled
module is loaded when a name of it is first used, so `trellis.figures` works without it.
"""
from typing import TYPE_CHECKING, Any, List

if TYPE_CHECKING:
    from . import figures
    from ._recorder import Measurement, Recorder, measure
    from ._sampler import Draw, Sampler
    from ._scripts import Result, experiment, guide, load, problem, problems, run, script, strategy
    from ._trellis import Error, Guide, Known, Problem, Script, Strategy, Value, commit, version
    from ._words import *

    __version__: str

__all__ = [
    "Draw",
    "Error",
    "Guide",
    "Known",
    "Measurement",
    "Problem",
    "Recorder",
    "Result",
    "Sampler",
    "Script",
    "Strategy",
    "Value",
    "commit",
    "experiment",
    "guide",
    "load",
    "measure",
    "problem",
    "problems",
    "run",
    "script",
    "strategy",
    "version",
]


def __getattr__(name: str) -> Any:
    """Loads what a name needs: `figures`, which needs no compiled module, or all others, which are words or not."""
    import importlib

    if name == "figures":
        return importlib.import_module(".figures", __name__)
    if name not in __all__ and name != "__version__":
        return _word(name)
    try:
        importlib.import_module("._trellis", __name__)
    except ModuleNotFoundError as missing:
        if missing.name != "trellis._trellis":
            raise
        raise ImportError(
            "the compiled module trellis._trellis is not built for this Python: build it by `scripts/setup build "
            "python && scripts/build`, and run Python with PYTHONPATH=build/release/python, or `pip install .`. "
            "`trellis.figures` works without it"
        ) from missing
    for part in ("_trellis", "_recorder", "_scripts", "_sampler"):
        module = importlib.import_module("." + part, __name__)
        globals().update({each: getattr(module, each) for each in __all__ if hasattr(module, each)})
    globals()["__version__"] = globals()["version"]()
    return globals()[name]


def _word(name: str) -> Any:
    """The word of the language of this name."""
    import difflib
    import importlib

    words: List[str] = []
    if not name.startswith("_"):
        try:
            module = importlib.import_module("._words", __name__)
        except ImportError as missing:
            raise AttributeError(f"module {__name__!r} has no {name!r} without its compiled part: {missing}") from missing
        if hasattr(module, name):
            return getattr(module, name)
        words = module.__all__
    near = difflib.get_close_matches(name, [*words, *__all__], 1)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}" + (f" (did you mean '{near[0]}'?)" if near else ""))


def __dir__() -> List[str]:
    import importlib

    try:
        words = importlib.import_module("._words", __name__).__all__
    except ImportError:
        words = []
    return sorted({*globals(), *__all__, *words, "__version__", "figures"})

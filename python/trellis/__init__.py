# SPDX-License-Identifier: MIT-0
"""Guiding spaces for motion planning: run Trellis scripts and strategies, and score the samples of any planner.

    import trellis
    script = trellis.load("gaps.lua")
    result = trellis.run(script.strategies["nested"], script.problems["false_gaps"], seeds=10)
    print(result.runs[["seed", "solved", "validity_checks"]])

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
    from ._scripts import Result, guide, load, problem, problems, run, script, strategy
    from ._trellis import Error, Guide, Problem, Script, Strategy, commit, version

    __version__: str

__all__ = [
    "Draw",
    "Error",
    "Guide",
    "Measurement",
    "Problem",
    "Recorder",
    "Result",
    "Sampler",
    "Script",
    "Strategy",
    "commit",
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
    """Loads what a name needs: `figures`, which needs no compiled module, or all others."""
    import importlib

    if name == "figures":
        return importlib.import_module(".figures", __name__)
    if name not in __all__ and name != "__version__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        importlib.import_module("._trellis", __name__)
    except ModuleNotFoundError as missing:
        if missing.name != "trellis._trellis":
            raise
        raise ImportError(
            "the compiled module of the package 'trellis' is not built for this Python: build it by `scripts/setup build "
            "python && scripts/build`, and run Python with PYTHONPATH=build/release/python, or `pip install .`. "
            "`trellis.figures` works without it"
        ) from missing
    for part in ("_trellis", "_recorder", "_scripts", "_sampler"):
        module = importlib.import_module("." + part, __name__)
        globals().update({each: getattr(module, each) for each in __all__ if hasattr(module, each)})
    globals()["__version__"] = globals()["version"]()
    return globals()[name]


def __dir__() -> List[str]:
    return sorted({*globals(), *__all__, "__version__", "figures"})

# SPDX-License-Identifier: MIT-0
"""Guiding spaces for motion planning: run Trellis scripts and strategies, and score the samples of any planner.

    import trellis
    script = trellis.load("gaps.lua")
    result = trellis.run(script.strategies["nested"], script.problems["false_gaps"], seeds=10)
    print(result.runs[["seed", "solved", "validity_checks"]])

    recorder = trellis.Recorder(lo=[0, 0], hi=[10, 10])
    recorder.add(samples)                      # of any planner: an array of N rows
    print(recorder.measure(path, delta=0.5))   # SE_T(Q), mass and spread, with intervals

Faults of an input raise `trellis.Error`, with the message that the program prints. Calls release the interpreter lock,
and Ctrl-C stops a run. pandas is needed for frames only, and numpy for nothing.
"""
from ._recorder import Measurement, Recorder, measure
from ._scripts import Result, load, problem, problems, run, script, strategy
from ._trellis import Error, Problem, Script, Strategy, commit, version

__version__ = version()

__all__ = [
    "Error",
    "Measurement",
    "Problem",
    "Recorder",
    "Result",
    "Script",
    "Strategy",
    "commit",
    "load",
    "measure",
    "problem",
    "problems",
    "run",
    "script",
    "strategy",
    "version",
]

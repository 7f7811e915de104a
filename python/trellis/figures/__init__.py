# SPDX-License-Identifier: MIT-0
"""Figures and tables for papers, from a document of `trellis run --json`; without the compiled module of Trellis.

    from trellis import figures
    figures.save("results.json", "figures")        # all that the document has data for: SVG, PDF, PNG, and tables
    ax = figures.costs("results.json")             # one of them: axes of matplotlib
    figures.save(ax, "figures", formats=["pdf"])

| function | question |
|---|---|
| `costs` | what does each strategy cost? |
| `success` | how likely is a path by a number of checks? |
| `length` | how fast do paths get shorter? |
| `ratios` | does guidance pay? |
| `levels` | which guide earns its place? |
| `waterfall` | what does each level add? |
| `correlation` | which nats predict the checks? |
| `scales` | how do the costs depend on an option? |
| `profile` | where along the path do the samples lie? |
| `world` | where did each strategy search, and what path did it find? |
| `levels_of_world` | what did each level search, and what did it hand up? |
| `strip` | how does the robot move? |
| `schedule` | which robot of a team waits, and how close do they come? |
| `tables` | the numbers: frames of pandas, CSV, Markdown, LaTeX |
| `frame` | runs, levels and scores as they are stored: a frame of pandas |

Each function takes a document (a path, a dict, a `trellis.Result`, what `read` returned, or a list of these) and `ax=`,
and returns the axes. Text has 7 pt; the baseline is grey, and each other strategy has a colour, a mark and a dash by
its place in the document, the same in every figure. Pictures of worlds show the samples of `trellis run --samples` or
`--out`. Medians, intervals and verdicts are those of the document. Widths are 86 mm (a column) or 178 mm (a page).
pyplot is not used, and no setting of matplotlib is changed.

Needs numpy and matplotlib (Debian: python3-matplotlib); frames need pandas (python3-pandas). The command
`python3 -m trellis.figures` does the same; `trellis report --figures` calls it.
"""
import sys as _sys

try:
    import matplotlib as _matplotlib  # noqa: F401
except ImportError as _missing:
    _needed = "figures need matplotlib (Debian: python3-matplotlib)"
    if _sys.argv[:1] == ["-m"]:  # python3 -m trellis.figures, before __main__ runs
        raise SystemExit(_needed) from _missing
    raise ImportError(_needed) from _missing

from ._bound import Figures
from ._costs import costs, levels, ratios, success
from ._document import Error, Interval, Results, read
from ._measure import correlation, scales, waterfall
from ._paths import length, profile
from ._save import save, supported, svg
from ._tables import frame, tables
from ._teams import schedule
from ._worlds import levels_of_world, strip, world

__all__ = [
    "Error",
    "Figures",
    "Interval",
    "Results",
    "correlation",
    "costs",
    "frame",
    "length",
    "levels",
    "levels_of_world",
    "profile",
    "ratios",
    "read",
    "save",
    "scales",
    "schedule",
    "strip",
    "success",
    "supported",
    "svg",
    "tables",
    "waterfall",
    "world",
]

# SPDX-License-Identifier: MIT-0
"""Writes figures and tables to files: the same document gives the same bytes."""
from __future__ import annotations

import io
import os
import pathlib
import re
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _style
from ._costs import costs, levels, ratios, success, supported_levels
from ._document import Document, Error, Results, read
from ._measure import _waterfalls, correlate, correlation, options, scales, waterfall
from ._tables import ENDINGS, texts_of
from ._teams import schedule, scheduled
from ._worlds import levels_of_world, strip, supported_pictures, world

FORMATS = ("svg", "pdf", "png")
# No dates, so that a document gives the same bytes on any day.
_METADATA: Dict[str, Dict[str, Optional[str]]] = {
    "svg": {"Date": None, "Creator": "Trellis"},
    "pdf": {"CreationDate": None, "Creator": "Trellis", "Producer": None},
    "png": {"Software": "Trellis"},
}


def _figure_of(what: Any) -> Any:
    """The figure of axes, of an array of them, or a figure itself; None for anything else."""
    if hasattr(what, "savefig") and hasattr(what, "add_axes"):
        return what
    if isinstance(what, np.ndarray) and what.dtype == object and what.size:
        what = what.ravel()[0]
    elif isinstance(what, (list, tuple)) and what:
        what = what[0]
    return what.figure if hasattr(what, "get_xlim") else None


def _write(figure: Any, stem: pathlib.Path, formats: Sequence[str]) -> List[pathlib.Path]:
    written = []
    for ending in formats:
        path = stem.with_name(f"{stem.name}.{ending}")
        with _style.styled():
            figure.savefig(path, format=ending, metadata=_METADATA[ending], facecolor="white", edgecolor="none")
        written.append(path)
    return written


def svg(what: Any) -> str:
    """Returns a figure as the text of an SVG element, for pages and notebooks: with the style of `save`, and the same
    text for the same figure.

    what: a figure, axes, or an array of axes, as the functions return them.

    Raises `Error` for anything else.
    """
    figure = _figure_of(what)
    if figure is None:
        raise Error("svg: a figure, or axes of one, is needed, as figures.costs(document) returns them")
    text = io.BytesIO()
    with _style.styled():
        figure.savefig(text, format="svg", metadata=_METADATA["svg"], facecolor="white", edgecolor="none")
    whole = text.getvalue().decode("utf-8")
    return whole[whole.index("<svg"):]


def _pictures(results: Results) -> Dict[str, List[Dict[str, str]]]:
    """The figures of worlds and motions, each with the arguments of all its pictures."""
    return {**supported_pictures(results), "schedule": [{"problem": name} for name in scheduled(results)]}


def _picture_stems(results: Results, pictures: Mapping[str, Sequence[Mapping[str, str]]]) -> List[Tuple[str, str, Any]]:
    """The stem of each picture's files, its function and its arguments: world-PROBLEM, of levels with the strategy."""
    stems: List[Tuple[str, str, Any]] = []
    used: Dict[str, int] = {}
    for name, every in pictures.items():
        for arguments in every:
            if arguments["problem"] not in results.problems[:_MOST]:
                continue
            parts = [re.sub(r"[^A-Za-z0-9._+-]+", "_", part) for part in arguments.values()]
            stem = "-".join([name, *parts])
            used[stem.lower()] = used.get(stem.lower(), 0) + 1
            if used[stem.lower()] > 1:
                stem = f"{stem}-{used[stem.lower()]}"
            stems.append((stem, name, arguments))
    return stems


def supported(document: Document) -> List[str]:
    """The names of the figures that a document has data for."""
    results = read(document)
    found = ["costs", "success"] if any(results.document["runs"]) else []
    if results.baseline and results.others:
        found.append("ratios")
    if supported_levels(results):
        found.append("levels")
    if _waterfalls(results, None, results.strategies):
        found.append("waterfall")
    if correlate(results) is not None:
        found.append("correlation")
    if options(results):
        found.append("scales")
    return found + [name for name, pictures in _pictures(results).items() if pictures]


_FIGURES: Dict[str, Callable[[Results], Any]] = {
    "costs": costs,
    "success": success,
    "ratios": ratios,
    "levels": levels,
    "waterfall": waterfall,
    "correlation": correlation,
    "scales": scales,
}
_PICTURES: Dict[str, Callable[..., Any]] = {
    "world": world,
    "levels_of_world": levels_of_world,
    "strip": strip,
    "schedule": schedule,
}
_MOST = 12  # problems whose worlds and motions `save` draws


def save(what: Any, folder: Union[str, "os.PathLike[str]"], formats: Sequence[str] = FORMATS, *,
         name: Optional[str] = None, texts: Sequence[str] = ("csv", "markdown", "latex")) -> List[pathlib.Path]:
    """Writes figures, with the style of the figures whatever the user's settings are. The same document gives the same
    bytes.

    what:    a document (what `read` takes): all figures that it has data for, as costs.svg, and its tables. Worlds and
             motions are drawn of its first twelve problems, as world-PROBLEM.svg, levels_of_world-PROBLEM-STRATEGY.svg
             of each strategy with guides and samples, strip-PROBLEM.svg, and schedule-PROBLEM.svg of teams. Or a
             figure, axes, or an array of axes, as the functions return them: that figure.
    folder:  where the files are written; it is made if it is not there.
    formats: of "svg", "pdf" and "png" (default all three). Text is outlines in SVG, and an embedded font in PDF.
    name:    of a figure's files, without an ending (default the function that drew it).
    texts:   formats of a document's tables: of "csv", "markdown" and "latex" (default all three).

    Returns the paths. Raises `Error` for an unknown format and a figure without a name; ImportError for tables without
    pandas; OSError where a file cannot be written.
    """
    for given, known in ((formats, FORMATS), (texts, tuple(ENDINGS))):
        for one in given:
            if one not in known:
                raise Error(f"there is no format '{one}'; there are: {', '.join(known)}")
    place = pathlib.Path(folder)
    figure = _figure_of(what)
    if figure is not None:
        stem = name or str(figure.get_label())
        if not stem:
            raise Error("save: the figure has no name; give name=")
        place.mkdir(parents=True, exist_ok=True)
        return _write(figure, place / stem, formats)
    results = read(what)
    place.mkdir(parents=True, exist_ok=True)
    written: List[pathlib.Path] = []
    for one in supported(results):
        if one in _FIGURES:
            written += _write(_figure_of(_FIGURES[one](results)), place / one, formats)
    for stem, one, arguments in _picture_stems(results, _pictures(results)):
        written += _write(_figure_of(_PICTURES[one](results, **arguments)), place / stem, formats)
    for file, text in texts_of(results, texts).items():
        path = place / file
        path.write_bytes(text.encode("utf-8"))
        written.append(path)
    return written

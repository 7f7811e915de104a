# SPDX-License-Identifier: MIT-0
"""Writes figures and tables to files: the same document gives the same bytes."""
from __future__ import annotations

import io
import os
import pathlib
import re
from typing import Any, Callable, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _style
from ._compare import compared
from ._costs import costs, levels, ratios, success, supported_levels
from ._document import Document, Error, Results, read
from ._join import nearest
from ._measure import _waterfalls, correlate, correlation, options, scales, waterfall
from ._paths import anytime, length, profile, profiled
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


def _bytes(figure: Any, ending: str) -> bytes:
    content = io.BytesIO()
    with _style.styled():
        figure.savefig(content, format=ending, metadata=_METADATA[ending], facecolor="white", edgecolor="none")
    return content.getvalue()


def _put(path: pathlib.Path, content: bytes) -> None:
    """Writes a file beside its place and renames it: it is complete or absent."""
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        try:
            part.write_bytes(content)
            os.replace(part, path)
        finally:
            if part.exists():
                part.unlink()
    except OSError as fault:
        raise OSError(fault.errno, fault.strerror, str(path)) from fault


def _write(figure: Any, stem: pathlib.Path, formats: Sequence[str]) -> Iterator[pathlib.Path]:
    for ending in formats:
        path = stem.with_name(f"{stem.name}.{ending}")
        _put(path, _bytes(figure, ending))
        yield path


def svg(what: Any) -> str:
    """Returns a figure as the text of an SVG element, for pages and notebooks: with the style of `save`, and the same
    text for the same figure.

    what: a figure, axes, or an array of axes, as the functions return them.

    Raises `Error` for anything else.
    """
    figure = _figure_of(what)
    if figure is None:
        raise Error("svg: a figure, or axes of one, is needed, as figures.costs(document) returns them")
    whole = _bytes(figure, "svg").decode("utf-8")
    return whole[whole.index("<svg"):]


_FIGURES: Dict[str, Callable[..., Any]] = {
    "costs": costs,
    "success": success,
    "length": length,
    "ratios": ratios,
    "levels": levels,
    "waterfall": waterfall,
    "correlation": correlation,
    "scales": scales,
}
_PICTURES: Dict[str, Callable[..., Any]] = {
    "profile": profile,
    "world": world,
    "levels_of_world": levels_of_world,
    "strip": strip,
    "schedule": schedule,
}
FIGURES = (*_FIGURES, *_PICTURES)
_MOST = 12  # problems whose worlds, motions and profiles `save` draws


def _pictures(results: Results) -> Dict[str, List[Dict[str, str]]]:
    """The figures of single problems, each with the arguments of all its pictures."""
    return {"profile": [{"problem": name} for name in profiled(results)], **supported_pictures(results),
            "schedule": [{"problem": name} for name in scheduled(results)]}


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


def _charts(results: Results) -> List[Tuple[str, str, Dict[str, Any]]]:
    """The stem, the function and the arguments of each figure of all problems that a document has data for."""
    found: List[Tuple[str, str, Dict[str, Any]]] = []
    if any(results.runs(None, name) for name in results.strategies):
        found += [("costs", "costs", {}), ("success", "success", {})]
    if anytime(results):
        found.append(("length", "length", {}))
    if results.baseline and results.others:
        found.append(("ratios", "ratios", {}))
        for against in ("own_planner", "best_part"):
            rows = compared(results, against, names=results.strategies)
            if any(row.reference != results.baseline for row in rows):
                found.append((f"ratios-{against}", "ratios", {"against": against, "together": True}))
    if supported_levels(results):
        found.append(("levels", "levels", {}))
    if _waterfalls(results, None, results.strategies):
        found.append(("waterfall", "waterfall", {}))
    if correlate(results) is not None:
        found.append(("correlation", "correlation", {}))
    return found + ([("scales", "scales", {})] if options(results) else [])


def supported(document: Document) -> List[str]:
    """The names of the figures that a document has data for."""
    results = read(document)
    names = [name for _, name, _ in _charts(results)]
    return list(dict.fromkeys(names + [name for name, pictures in _pictures(results).items() if pictures]))


def check_figures(names: Sequence[str]) -> None:
    """Raises `Error` for a name that is no figure's."""
    for name in names:
        if name not in FIGURES:
            raise Error(f"there is no figure '{name}'{nearest(name, FIGURES)}; there are: {', '.join(FIGURES)}")


def _check_known(what: str, given: Sequence[str], known: Sequence[str]) -> None:
    for one in given:
        if one not in known:
            raise Error(f"there is no format '{one}'{what}; there are: {', '.join(known)}")


def save(what: Any, folder: Union[str, "os.PathLike[str]"], formats: Sequence[str] = FORMATS, *,
         name: Optional[str] = None, figures: Optional[Sequence[str]] = None,
         texts: Sequence[str] = ("csv", "markdown", "latex"), level: Optional[int] = None,
         azimuth: Optional[float] = None, elevation: Optional[float] = None) -> List[pathlib.Path]:
    """Writes figures, with the style of the figures whatever the user's settings are. The same document gives the same
    bytes. Each file is written beside its place and then renamed.

    what:    a document, or a list of documents (what `read` takes): all figures that it has data for, as costs.svg, and
             its tables. Figures of single problems are drawn of the first twelve: world-PROBLEM.svg,
             levels_of_world-PROBLEM-STRATEGY.svg of each strategy with guides and samples, strip-PROBLEM.svg,
             schedule-PROBLEM.svg of teams, and profile-PROBLEM.svg of scores. Or a figure, axes, or an array of axes,
             as the functions return them: that figure.
    folder:  where the files are written; it is made if it is not there.
    formats: of "svg", "pdf" and "png" (default all three). Text is outlines in SVG, and an embedded font in PDF.
    name:    of a figure's files, without an ending (default the function that drew it).
    figures: names of functions: of a document these figures alone are drawn, and no tables (default all, and tables).
    texts:   formats of a document's tables: of "csv", "markdown" and "latex" (default all three).
    level:   of the world figures: the number of the level that they show in place of the robot's own.
    azimuth, elevation: of the camera in space, in degrees (default those of the document).

    Returns the paths. Raises `Error` for an unknown format or figure, for a figure in `figures` that the document has
    no data for, and for a figure without a name; OSError where a file cannot be written.
    """
    return list(saved(what, folder, formats, name, figures, texts, level, azimuth, elevation))


def saved(what: Any, folder: Union[str, "os.PathLike[str]"], formats: Sequence[str], name: Optional[str],
          figures: Optional[Sequence[str]], texts: Sequence[str], level: Optional[int], azimuth: Optional[float],
          elevation: Optional[float]) -> Iterator[pathlib.Path]:
    """The same, a path after each file."""
    _check_known("", formats, FORMATS)
    _check_known(" of tables", texts, tuple(ENDINGS))
    check_figures(figures or ())
    place = pathlib.Path(folder)
    figure = _figure_of(what)
    if figure is not None:
        stem = name or str(figure.get_label())
        if not stem:
            raise Error("save: the figure has no name; give name=")
        place.mkdir(parents=True, exist_ok=True)
        yield from _write(figure, place / stem, formats)
        return
    results = read(what)
    seen = {"azimuth": azimuth, "elevation": elevation}
    drawn = _drawn(results, figures, {"world": {**seen, "level": level}, "levels_of_world": seen, "strip": seen})
    place.mkdir(parents=True, exist_ok=True)
    for stem, make in drawn:
        yield from _write(_figure_of(make()), place / stem, formats)
    for file, text in texts_of(results, texts).items() if figures is None else ():
        _put(place / file, text.encode("utf-8"))
        yield place / file


def _drawn(results: Results, figures: Optional[Sequence[str]],
           more: Mapping[str, Mapping[str, Any]]) -> List[Tuple[str, Callable[[], Any]]]:
    """The stems of the files and the figures to draw; one that was asked for and cannot be drawn raises `Error`."""
    def drawing(function: Callable[..., Any], arguments: Mapping[str, Any]) -> Callable[[], Any]:
        return lambda: function(results, **arguments)

    made: List[Tuple[str, Callable[[], Any]]] = []
    found = set()
    for stem, one, arguments in _charts(results):
        if figures is None or one in figures:
            found.add(one)
            made.append((stem, drawing(_FIGURES[one], arguments)))
    for stem, one, arguments in _picture_stems(results, _pictures(results)):
        if figures is None or one in figures:
            found.add(one)
            made.append((stem, drawing(_PICTURES[one], {**arguments, **more.get(one, {})})))
    for one in figures or ():
        if one not in found:  # it says what is missing
            {**_FIGURES, **_PICTURES}[one](results)
            raise Error(f"{results.file}: there is no data for the figure '{one}'")
    return made


def draw(document: Document, figure: str, path: Union[str, "os.PathLike[str]"], **arguments: Any) -> pathlib.Path:
    """Writes one figure to a file, whose ending is its format; for `python3 -m trellis.figures --file`."""
    check_figures([figure])
    file = pathlib.Path(path)
    ending = file.suffix[1:].lower()
    if ending not in FORMATS:
        raise Error(f"{file}: the ending says the format; there are: {', '.join('.' + one for one in FORMATS)}")
    _put(file, _bytes(_figure_of({**_FIGURES, **_PICTURES}[figure](read(document), **arguments)), ending))
    return file

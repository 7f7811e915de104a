# SPDX-License-Identifier: MIT-0
"""Figures of worlds and motions: where each strategy searched, what each level handed up, and how the robot moves."""
from __future__ import annotations

import math
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _plane, _style
from ._document import Document, Error, Results, read
from ._plane import Body, PlaneView
from ._scenes import Array, Level, Scene, has_samples, index_of, levels_of, metres, path_of, scene_of, traced
from ._space import SpaceView
from ._style import COLUMN, GREY, INK, PAGE, SMALL, Margins

View = Union[PlaneView, SpaceView]
Run = Mapping[str, Any]
Seed = Union[None, int, str]

_TEAM_GOAL = "#0072B2"  # of the robot at the goal, in a world without runs
_TOP = 8.6  # above a panel: a name and a line, mm
_LEVELS = 12  # panels of levels at most
_SAMPLES = 10000  # dots of samples in a panel at most, all robots of a team together


# What is drawn -------------------------------------------------------------------------------------------------------


def pictured(results: Results) -> List[str]:
    """The problems with a world."""
    return [name for name in results.problems if scene_of(results, name) is not None]


def chosen_scene(results: Results, problem: Optional[str], azimuth: Optional[float] = None,
                 elevation: Optional[float] = None) -> Scene:
    """The scene of a problem; of the first that has one by default.

    azimuth, elevation: of the camera in space, in degrees (default those of the document).
    """
    found: Optional[Scene] = None
    if problem is not None:
        results.panels(problem)
        found = scene_of(results, problem)
        if found is None:
            raise Error(f"{results.file}: '{problem}' has no world that can be drawn")
    else:
        found = next((scene for scene in (scene_of(results, name) for name in results.problems) if scene), None)
    if found is None:
        raise Error(f"{results.file}: no problem has a world that can be drawn")
    if found.dimension == 2 or (azimuth is None and elevation is None):
        return found
    view = [old if new is None else new for old, new in zip(found.world["view"], (azimuth, elevation))]
    return found.seen_from(view)


def chosen_run(results: Results, problem: str, strategy: str, seed: Seed, solved: bool = False,
               samples: bool = False) -> Run:
    """The run of a seed; by default the first that is solved, else the first.

    solved, samples: what it has to have.
    """
    runs = results.runs(problem, strategy)
    where = f"of '{strategy}' on '{problem}'"
    if seed is not None:
        runs = [run for run in runs if str(run["seed"]) == str(seed)]
        if not runs:
            raise Error(f"{results.file}: there is no run {where} with seed {seed}")
    if not runs:
        raise Error(f"{results.file}: there is no run {where}")
    found = [run for run in runs if path_of(run) is not None]
    if solved and not found:
        raise Error(f"{results.file}: no run {where} has a path")
    if samples:
        index_of(results)  # says where it is missing
        with_samples = [run for run in found + list(runs) if has_samples(results, run)]
        if not with_samples:
            raise Error(f"{results.file}: there are no samples {where}: run it with --samples DIR, --out DIR, "
                        "in Python samples=DIR; name another folder as figures.read(document, samples=DIR)")
        return with_samples[0]
    return (found or list(runs))[0]


def best(results: Results, problem: str, guided: bool = False) -> str:
    """The first strategy, the cheapest first, that has a path on a problem; else any."""
    order = results.others + ([results.baseline] if results.baseline else [])
    names = [name for name in order if not guided or results.guided(name)]
    solved = [name for name in names if any(path_of(run) is not None for run in results.runs(problem, name))]
    if not names:
        raise Error(f"{results.file}: no strategy has guides" if guided and order else
                    f"{results.file}: there is no strategy")
    return (solved or names)[0]


def view_of(scene: Scene, bounds: Optional[Tuple[Array, Array]] = None) -> View:
    """The picture of a scene; of a part of it, in coordinates of the picture, where bounds are given."""
    return PlaneView(scene, bounds) if scene.dimension == 2 else SpaceView(scene, bounds)


def whole_view(scene: Scene, paths: Sequence[Array]) -> View:
    """The picture of the world; of space without its rim, where obstacles and robots on the paths take little of it."""
    view = view_of(scene)
    if not isinstance(view, SpaceView):
        return view
    ends = [q[None] for q in (scene.start, *scene.goals) if q is not None]
    rows = [*ends, *(path[:: 1 + len(path) // 40] for path in paths)]
    points = [view.content()] + [part for some in rows for part in _parts(scene, view, some)]
    every = np.concatenate(points)
    lo, hi = np.maximum(every.min(0), view.lo), np.minimum(every.max(0), view.hi)
    margin = 0.05 * max(hi - lo)
    lo, hi = np.maximum(lo - margin, view.lo), np.minimum(hi + margin, view.hi)
    return view_of(scene, (lo, hi)) if max((hi - lo) / (view.hi - view.lo)) < 0.75 else view


def _parts(scene: Scene, view: View, rows: Array) -> List[Array]:
    """Points in the picture about all of the robot at configurations."""
    robot = scene.robot
    parts: List[Array] = [view.project(trace.points(rows))[:, :2] for trace in scene.traces]
    for q in rows if robot is not None and not robot.is_point else ():
        placed: Any = robot.placed(q)  # type: ignore[union-attr]
        if scene.dimension == 2:
            for shape in placed:
                parts += [shape.points - shape.radius, shape.points + shape.radius]
        else:
            parts.append(view.project(placed.surfaces.vertices)[:, :2])
    return parts or [np.stack([view.lo, view.hi])]


def moments_of(scene: Scene, run: Run, path: Array) -> Array:
    """When a path reaches each of its rows: times of a team, s; else how far along the path it is, m."""
    times = run.get("times")
    if times and len(times["at"]) == len(path):
        return np.asarray(times["at"], float)
    return scene.space.lengths(path)


def _colours(scene: Scene) -> List[str]:
    return [member.colour for member in scene.team]


# Robots on a path ----------------------------------------------------------------------------------------------------


def _poses(scene: Scene, path: Array, apart: float, most: int) -> Array:
    """Configurations of a path whose reference points are evenly apart along it, with both ends."""
    far = np.zeros(1)
    if scene.traces:
        points = scene.traces[0].points(path)
        far = np.concatenate([far, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    if not far[-1] > 0:
        far = scene.space.lengths(path)
    count = int(np.clip(round(far[-1] / apart) if apart > 0 else most, 1, most)) + 1
    return scene.space.along(path, far, np.linspace(0, far[-1], count))


def _is_arm(scene: Scene) -> bool:
    return not scene.traces or scene.traces[0].curved


def _bodies(scene: Scene, path: Optional[Array], colour: str) -> List[Body]:
    """The robot along a path: bodies that overlap little, or of an arm both ends and outlines between them."""
    robot = scene.robot
    if robot is None or robot.is_point:
        return []
    if scene.team:
        ends = [scene.start, *scene.goals, None]
        start, goal = (path[0], path[-1]) if path is not None else (ends[0], ends[1])
        looks = [(goal, colour, 0.0, 0.45, _plane.PATH - 0.5), (start, None, 0.9, 1.0, _plane.BODIES)]
        if scene.dimension == 3:
            looks = [(start, colour, 0.4, 0.25, 0.0), (goal, colour, 0.5, 0.9, 0.0)]
        return [Body(robot, q, face, INK, width, alpha, layer, _colours(scene))
                for q, face, width, alpha, layer in looks if q is not None]
    if path is None:
        at_ends = [Body(robot, q, colour, INK, 0.5, 0.85) for q in scene.goals]
        return at_ends + ([Body(robot, scene.start, "white", INK, 0.5, 0.85)] if scene.start is not None else [])
    if _is_arm(scene):
        between = _poses(scene, path, 0, 9 if scene.dimension == 2 else 3)[1:-1]
        light = [Body(robot, q, None, GREY, 0.3, 0.6, _plane.PATH - 1) for q in between] if scene.dimension == 2 else []
        return [*light, Body(robot, path[0], "white", INK, 0.5, 0.95), Body(robot, path[-1], colour, INK, 0.5, 0.85)]
    if scene.dimension == 2:
        return [Body(robot, q, "white", INK, 0.5, 0.95) for q in _poses(scene, path, 4.4 * robot.radius, 40)]
    return [Body(robot, q, colour, INK, 0.5, 0.6) for q in _poses(scene, path, 3.2 * robot.radius, 14)]


def _draw_path(ax: Any, view: View, scene: Scene, path: Array, level: Optional[Level] = None) -> None:
    """The path of the robot, or of a level."""
    colours = _colours(scene)
    of: Union[Scene, Level] = scene if level is None else level
    for trace in of.traces:
        points = traced(of.space, trace, path)
        own = colours[trace.member] if trace.member < len(colours) else INK
        view.path(ax, points, own, 1.1 if len(of.traces) <= 8 else 0.7, halo=len(of.traces) <= 8)


def _draw_ends(ax: Any, view: View, scene: Scene, path: Optional[Array] = None) -> None:
    """A ring at the start, and a disc at each goal."""
    if scene.team:
        return
    for trace in scene.traces[:1]:
        goals = scene.goals or ([path[-1]] if path is not None else [])
        for q in goals:
            view.mark(ax, trace.points(np.array([q]))[0], INK, INK)
        if scene.start is not None:
            view.mark(ax, trace.points(np.array([scene.start]))[0], "white", INK)


def _draw_level(ax: Any, view: View, level: Level, colour: str, team: Sequence[str] = ()) -> None:
    """Edges of the tree above the samples."""
    # More dots would only be a grey field: each second is drawn, each third, ...
    proposals = level.proposals[::1 + len(level.proposals) * len(level.traces) // _SAMPLES]
    alpha = _plane.sample_alpha(len(proposals) * len(level.traces))
    for trace in level.traces:
        own = team[trace.member] if trace.member < len(team) else colour
        if len(proposals):
            view.samples(ax, trace.points(proposals), own, alpha)
        motions = level.motions(trace)
        if len(motions):
            width, alpha = _plane.tree_stroke(len(motions) * len(level.traces))
            view.segments(ax, motions, own, width, alpha)


def _heading(ax: Any, name: str, line: str, colour: str, room: float) -> None:
    """A name, and a line below it, above a panel."""
    size = _style.SIZE
    while name and _style.width_of([name], size) * 1.12 > room:
        name = _style.cut(name, _style.width_of([name], size) - 1, size)
    _style.above(ax, 0, name, dy=4.2, fontsize=size, color=colour, fontweight="bold")
    _style.above(ax, 0, _style.cut(line, room, SMALL), dy=1.1, color=INK)


def _checks(run: Mapping[str, Any]) -> str:
    return f"{int(run['validity_checks']):,} checks"


class _Grid(NamedTuple):
    """How panels of one shape are laid out, mm."""

    width: float
    height: float
    columns: int
    margins: Margins


def _grid(count: int, aspect: float, wide: bool, top: float = _TOP, gap: float = 4.0) -> _Grid:
    """A column where two panels fit side by side, or where flat ones stand below each other; else a page.

    wide: whether the figure has the width of a page.
    """
    flat = aspect < 0.5
    if wide:
        most = 6 if aspect > 1.6 else 4 if aspect > 0.5 else 2
        rows = math.ceil(count / most)
        columns, width = math.ceil(count / rows), PAGE
        if count == 1 or (count == 2 and aspect >= 0.8):
            width = COLUMN
    elif count == 1 or (flat and count <= 4):
        columns, width = 1, COLUMN
    elif flat:
        columns, width = 2, PAGE
    elif count == 2 and aspect >= 0.8:
        columns, width = 2, COLUMN
    else:
        columns, width = min(count, 4 if aspect > 1.1 else 3), PAGE
    rows = math.ceil(count / columns)
    margins = Margins(left=2, right=2, top=top, bottom=2, wide=gap, high=top)
    each = (width - 4 - gap * (columns - 1)) / columns
    high = min(each * aspect, 120.0, (_style.HIGHEST - 2 - top * rows) / rows)
    return _Grid(width, rows * (high + top) + 2, columns, margins)


def _panels(name: str, ax: Any, count: int, aspect: float, wide: bool, top: float = _TOP,
            gap: float = 4.0) -> List[Any]:
    axes = _style.given(ax, count, name)
    if axes is None:
        grid = _grid(count, aspect, wide, top, gap)
        axes = _style.place(name, grid.width, grid.height, count, grid.columns, grid.margins)
    for one in axes:
        one.set_anchor("SW")
    return axes


# World ---------------------------------------------------------------------------------------------------------------


def world(document: Document, *, problem: Optional[str] = None, strategies: Optional[Sequence[str]] = None,
          seed: Seed = None, level: Optional[int] = None, azimuth: Optional[float] = None,
          elevation: Optional[float] = None, ax: Any = None) -> Any:
    """Where did each strategy search, and what path did it find? A panel for each: the obstacles, the proposals of the
    robot's own level as dots (of more than 10,000 each second, each third, ...), its tree above them, the path with a
    white rim, and the robot along it. A ring is the start, a disc the goal. Of an arm the tip is traced, and its
    outlines lie between start and goal; the robots of a team have colours of their own. In space, what obstacles hide
    is fainter. Without runs: the world, and the robot at the start and at the goal, with the axes in metres.

    document:   what `read` takes. Without samples the world, the path and the robot are drawn alone.
    problem:    the name of a problem (default the first with a world).
    strategies: names of strategies (default the baseline, and the cheapest of the others).
    seed:       of the runs (default of each strategy its first solved run).
    level:      the number of a level: it is drawn in place of the robot's own, of one strategy (default the cheapest
                with guides). It needs samples.
    azimuth, elevation: of the camera in space, in degrees (default those of the document).
    ax:         axes to draw in, one for each strategy (default those of a new figure).

    Returns the axes: one, or an array of several. Raises `Error` for an unknown name, seed or level, for a problem
    without a world, and for another number of axes.
    """
    results = read(document)
    scene = chosen_scene(results, problem, azimuth, elevation)
    if level is not None:
        return _one_level(results, scene, strategies, seed, level, ax)
    names = results.chosen(strategies) if strategies is not None else _compared(results, scene)
    if not names and strategies is not None:
        raise Error(f"{results.file}: name at least one strategy")
    if not names:
        return _bare(scene, ax)
    runs = [chosen_run(results, scene.name, name, seed) for name in names]
    view = whole_view(scene, [path for path in map(path_of, runs) if path is not None])
    with _style.styled():
        axes = _panels("world", ax, len(names), view.aspect, False)
        for one, name, run in zip(axes, names, runs):
            colour = _style.look(results, name).colour
            path = path_of(run)
            view.begin(one, _bodies(scene, path, colour))
            levels = levels_of(results, run, scene) if has_samples(results, run) else None
            if levels:
                _draw_level(one, view, levels[0], colour, _colours(scene))
            if path is not None:
                _draw_path(one, view, scene, path)
            _draw_ends(one, view, scene, path)
            _heading(one, name, f"{_checks(run)}, {metres(run)}", colour, _style.size_of(one)[0])
    return _style.returned(axes)


def _compared(results: Results, scene: Scene) -> List[str]:
    """The baseline and the cheapest of the others, as far as they have runs on a problem; none without runs."""
    if not any(results.runs(scene.name, name) for name in results.strategies):
        return []
    first = best(results, scene.name)
    names = list(dict.fromkeys([results.baseline or first, first]))
    names += results.others[:1] if len(names) == 1 else []  # none of the others has a path
    return [name for name in dict.fromkeys(names) if results.runs(scene.name, name)]


def _bare(scene: Scene, ax: Any) -> Any:
    """A world without runs, with the robot at the start and at the goal."""
    view = view_of(scene)
    flat = scene.dimension == 2
    with _style.styled():
        axes = _style.given(ax, 1, "world")
        if axes is None:
            margins = Margins(left=9 if flat else 3, right=3, top=5.5, bottom=8.4 if flat else 5)
            wide = _style.COLUMN - margins.left - margins.right
            high = min(wide * view.aspect, 150.0)
            axes = _style.place("world", _style.COLUMN, high + margins.top + margins.bottom, 1, 1, margins)
        one = axes[0]
        one.set_anchor("SW")
        view.begin(one, _bodies(scene, None, _TEAM_GOAL))
        _draw_ends(one, view, scene)
        view.axes(one)
        _style.above(one, 0, _style.cut(scene.name, _style.size_of(one)[0]), dy=1.1, fontsize=_style.SIZE, color=INK,
                     fontweight="bold")
    return axes[0]


def _one_level(results: Results, scene: Scene, strategies: Optional[Sequence[str]], seed: Seed, number: int,
               ax: Any) -> Any:
    """A level of one run."""
    names = results.chosen(strategies)
    if strategies is None:
        guided = [name for name in names if results.guided(name)]
        names = [best(results, scene.name, guided=bool(guided))] if names else []
    if len(names) != 1:
        raise Error(f"{results.file}: a level is drawn of one strategy, got {len(names)}")
    run = chosen_run(results, scene.name, names[0], seed, samples=True)
    levels = levels_of(results, run, scene) or []
    if not 0 <= number < len(levels):
        known = ", ".join(f"{i} {one.name}" for i, one in enumerate(levels))
        raise Error(f"{results.file}: '{names[0]}' has no level {number}; there are: {known}")
    path = path_of(run)
    view = whole_view(scene, [] if path is None else [path])
    with _style.styled():
        axes = _panels("world", ax, 1, view.aspect, False)
        _draw_whole_level(axes[0], view, scene, results, run, levels, number, number == 0)
    return axes[0]


# Levels --------------------------------------------------------------------------------------------------------------


def _spelled(space: str) -> str:
    """The name of a space, with raised digits where they are the whole exponent."""
    digits = {"^2": "²", "^3": "³"}
    for plain, raised in digits.items():
        space = space.replace(plain + " ", raised + " ")
        if space.endswith(plain):
            space = space[:-2] + raised
    return space


def _level_colour(results: Results, strategy: str, number: int) -> str:
    own = _style.look(results, strategy).colour
    others = [colour for colour in ("#CC79A7", "#009E73", "#E69F00", "#56B4E9", "#D55E00", "#0072B2") if colour != own]
    return own if number == 0 else others[(number - 1) % len(others)]


def levels_of_world(document: Document, *, problem: Optional[str] = None, strategy: Optional[str] = None,
                    seed: Seed = None, azimuth: Optional[float] = None, elevation: Optional[float] = None,
                    ax: Any = None) -> Any:
    """What did each level search, and what did it hand up? A panel for each level, guides left of what they guide, the
    robot's own level last: its proposals, its tree or graph, and the last path that it found; above it its validity
    checks, and how often it searched. Twelve levels at most: those next to the robot's.

    document: what `read` takes. It needs samples: `trellis run` with `--samples DIR` or `--out DIR`.
    problem:  the name of a problem (default the first with a world).
    strategy: the name of a strategy (default the cheapest with guides).
    seed:     of the run (default the first solved one).
    azimuth, elevation: of the camera in space, in degrees (default those of the document).
    ax:       axes to draw in, one for each level (default those of a new figure: 178 mm wide, of two narrow ones 86).

    Returns the axes: one, or an array of several. Raises `Error` as `world` does, and where there are no samples.
    """
    results = read(document)
    scene = chosen_scene(results, problem, azimuth, elevation)
    name = best(results, scene.name, guided=True) if strategy is None else results.chosen([strategy])[0]
    run = chosen_run(results, scene.name, name, seed, samples=True)
    levels = levels_of(results, run, scene) or []
    shown = list(reversed(range(min(len(levels), _LEVELS))))
    path = path_of(run)
    view = whole_view(scene, [] if path is None else [path])
    with _style.styled():
        axes = _panels("levels_of_world", ax, len(shown), view.aspect, True, gap=6.0)
        for one, number in zip(axes, shown):
            _draw_whole_level(one, view, scene, results, run, levels, number, False)
    return _style.returned(axes)


def _draw_whole_level(one: Any, view: View, scene: Scene, results: Results, run: Run, levels: Sequence[Level],
                      number: int, robot: bool) -> None:
    """A level with its path and its heading, and the robot along it or not."""
    level, stored = levels[number], results.levels(run)
    colour = _level_colour(results, run["strategy"], number)
    path = path_of(run)
    view.begin(one, _bodies(scene, path, colour) if robot else [])
    _draw_level(one, view, level, colour, _colours(scene))
    if level.path is not None and len(level.path):
        _draw_path(one, view, scene, level.path, level)
    _draw_ends(one, view, scene, path)
    title = level.planner if number == 0 else _style.short_guide(level.name)
    line = _spelled(level.space_name)
    if number < len(stored):
        solves = stored[number]["solves"]
        line += f": {_checks(stored[number])}" + (f", {solves} searches" if solves > 1 else "")
    if not level.traces:
        line += ", no position to draw"
    guided = any(other.parent == number for other in levels)
    _heading(one, (">> " if guided else "") + title, line, INK if number else colour, _style.size_of(one)[0])


# Strip ---------------------------------------------------------------------------------------------------------------


def _swept(scene: Scene, view: View, rows: Array) -> Tuple[Array, Array]:
    """The ends, in the picture, of all that the robot sweeps at configurations, with a margin."""
    points = np.concatenate(_parts(scene, view, rows))
    lo, hi = points.min(0), points.max(0)
    margin = 0.06 * max(hi - lo)
    lo, hi = np.maximum(lo - margin, view.lo), np.minimum(hi + margin, view.hi)
    # Neither side is much shorter than the other.
    least = max(hi - lo) * (1 / 3 if scene.dimension == 2 else 0.6)
    for axis in range(2):
        if hi[axis] - lo[axis] < least:
            middle = (lo[axis] + hi[axis]) / 2
            lo[axis], hi[axis] = middle - least / 2, middle + least / 2
    return lo, hi


def strip(document: Document, *, problem: Optional[str] = None, strategy: Optional[str] = None, seed: Seed = None,
          frames: int = 6, azimuth: Optional[float] = None, elevation: Optional[float] = None, ax: Any = None) -> Any:
    """How does the robot move? Frames at equal steps along the path, of a team at equal times, from left to right: the
    robot filled, outlines of it since the frame before, and the trace of its reference point, of an arm of its tip. The
    frames show the part of the world that the robot sweeps.

    document: what `read` takes; it needs no samples.
    problem:  the name of a problem (default the first with a world).
    strategy: the name of a strategy (default the cheapest that is no baseline and has a path).
    seed:     of the run (default the first solved one).
    frames:   their number, at least 2 (default 6).
    azimuth, elevation: of the camera in space, in degrees (default those of the document).
    ax:       axes to draw in, one for each frame (default those of a new figure, 178 mm wide).

    Returns the axes, an array. Raises `Error` as `world` does, and for a run without a path.
    """
    if frames < 2:
        raise Error(f"strip: at least 2 frames are needed, got {frames}")
    results = read(document)
    scene = chosen_scene(results, problem, azimuth, elevation)
    name = best(results, scene.name) if strategy is None else results.chosen([strategy])[0]
    run = chosen_run(results, scene.name, name, seed, solved=True)
    path = path_of(run)
    assert path is not None
    at = moments_of(scene, run, path)
    timed = bool(scene.team) and bool(run.get("times"))
    moments = np.linspace(0, at[-1], frames)
    along = scene.space.along(path, at, np.linspace(0, at[-1], 60))
    view = view_of(scene, _swept(scene, view_of(scene), along))
    colour, colours = _style.look(results, name).colour, _colours(scene)
    with _style.styled():
        axes = _style.given(ax, frames, "strip")
        if axes is None:
            rows = 1 if view.aspect > 0.5 or frames < 4 else 2
            columns = math.ceil(frames / rows)
            each = (PAGE - 4 - 2.5 * (columns - 1)) / columns
            high = min(each * view.aspect, (_style.HIGHEST - 2 - 5 * rows) / rows)
            margins = Margins(left=2, right=2, top=5, bottom=2, wide=2.5, high=5)
            axes = _style.place("strip", PAGE, rows * (high + 5) + 2, frames, columns, margins)
        for k, one in enumerate(axes):
            one.set_anchor("SW")
            bodies = _frame(scene, path, at, moments, k, colour)
            view.begin(one, bodies)
            reached = np.linspace(0, moments[k], 2 + 60 * k)
            for trace in scene.traces:
                own = colours[trace.member] if trace.member < len(colours) else colour
                points = trace.points(scene.space.along(path, at, np.union1d(reached, at[at <= moments[k]])))
                if len(points) > 1:
                    view.path(one, points, own, 0.9, halo=False)
                if scene.robot is None or scene.robot.is_point:
                    view.mark(one, points[-1], own, INK)
            text = "start" if k == 0 else f"{moments[k]:.1f} s" if timed else (
                f"{k / (frames - 1):.0%}".replace("%", " %") + (" of the path" if k == 1 else ""))
            _style.above(one, 0, _style.cut(text, _style.size_of(one)[0], SMALL), dy=1.1, color=INK)
    return _style.returned(axes)


def _frame(scene: Scene, path: Array, at: Array, moments: Array, k: int, colour: str) -> List[Body]:
    """The robot of a frame, and outlines since the frame before."""
    robot = scene.robot
    if robot is None or robot.is_point:
        return []
    now = scene.space.along(path, at, moments[k:k + 1])[0]
    colours = _colours(scene)
    body = Body(robot, now, colour, INK if not scene.team or scene.dimension == 3 else colour, 0.5, 1.0, _plane.BODIES,
                colours)
    if k == 0 or (scene.team and scene.dimension == 3):
        return [body]
    before = scene.space.along(path, at, np.linspace(moments[k - 1], moments[k], 5)[:-1])
    if scene.dimension == 3:  # solids hide each other: two, nearly white
        before = before[[0, 2]]
        return [Body(robot, q, colour, _style.GREY, 0.3, 0.22, colours=colours) for q in before] + [body]
    return [Body(robot, q, None, colour, 0.35, 0.5, _plane.PATH - 0.5, colours) for q in before] + [body]


def supported_pictures(results: Results) -> Dict[str, List[Dict[str, str]]]:
    """The figures of worlds and motions that a document has data for, each with the arguments of all its pictures."""
    found: Dict[str, List[Dict[str, str]]] = {"world": [], "levels_of_world": [], "strip": []}
    for problem in pictured(results):
        names = [name for name in results.strategies if results.runs(problem, name)]
        if names or not any(results.runs(None, name) for name in results.strategies):
            found["world"].append({"problem": problem})
        for name in names:
            if results.guided(name) and any(has_samples(results, run) for run in results.runs(problem, name)):
                found["levels_of_world"].append({"problem": problem, "strategy": name})
        if any(path_of(run) is not None for name in names for run in results.runs(problem, name)):
            found["strip"].append({"problem": problem})
    return found

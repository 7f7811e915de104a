# SPDX-License-Identifier: MIT-0
"""What all figures share: style, sizes in millimetres, colours, marks, ticks and keys."""
from __future__ import annotations

import contextlib
import functools
import math
import re
import warnings
from typing import Any, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.lines import Line2D
from matplotlib.textpath import TextToPath
from matplotlib.ticker import FixedFormatter, FixedLocator, NullFormatter, NullLocator
from matplotlib.transforms import offset_copy

from ._document import Error, Results

MM = 1 / 25.4
POINT = 72 / 25.4  # points per millimetre
COLUMN, PAGE = 86.0, 178.0  # widths of a column and of a page, mm
HIGHEST = 230.0  # of a figure, mm
SIZE, SMALL = 7.0, 6.2  # of text, points
_CAPITAL = 0.729  # height of a capital, of the size of the text

INK, GREY, FAINT, BASELINE = "#222222", "#6b6f73", "#dfe2e5", "#55585c"
OKABE_ITO = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
MARKS = "sD^vPXo"
DASHES: Tuple[Any, ...] = (
    (0, (5, 1.5)),
    (0, (1.5, 1)),
    (0, (5, 1.2, 1.2, 1.2)),
    (0, (3, 1)),
    (0, (7, 1.5, 1, 1.5, 1, 1.5)),
    (0, (9, 2)),
)
TINT, LESS, MORE = "#0072B2", "#009E73", "#D55E00"

_STYLE = {
    "axes.axisbelow": True,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.labelpad": 2.5,
    "axes.labelsize": SIZE,
    "axes.linewidth": 0.5,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlepad": 3,
    "axes.titlesize": SIZE,
    "axes.titley": 1.0,
    "figure.dpi": 100,
    "font.family": "DejaVu Sans",
    "font.size": SIZE,
    "lines.linewidth": 1.1,
    "pdf.fonttype": 42,
    "savefig.dpi": 300,
    "svg.fonttype": "path",
    "svg.hashsalt": "trellis",
    "text.color": INK,
    "text.parse_math": False,
    "xtick.color": GREY,
    "xtick.labelcolor": INK,
    "xtick.labelsize": 6.5,
    "xtick.major.size": 2.2,
    "xtick.major.width": 0.5,
    "ytick.color": GREY,
    "ytick.labelcolor": INK,
    "ytick.labelsize": SIZE,
    "ytick.major.size": 2.2,
    "ytick.major.width": 0.5,
}


@contextlib.contextmanager
def styled() -> Iterator[None]:
    """The style of the figures, whatever the user's settings are; they are back afterwards."""
    with matplotlib.rc_context():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", matplotlib.MatplotlibDeprecationWarning)
            matplotlib.rcdefaults()
            known = {key: value for key, value in _STYLE.items() if key in matplotlib.rcParams}
            matplotlib.rcParams.update(known)
        yield


# Strategies ----------------------------------------------------------------------------------------------------------


class Look(NamedTuple):
    """How a strategy looks in every figure."""

    colour: str
    mark: str
    dash: Any


def nth(place: int) -> Look:
    """The look of the strategy at a place of the script; -1: the baseline. All of the first 49 differ."""
    if place < 0:
        return Look(BASELINE, "o", "-")
    turn = place // len(OKABE_ITO)
    mark = MARKS[(place + 3 * turn) % len(MARKS)]
    return Look(OKABE_ITO[place % len(OKABE_ITO)], mark, DASHES[place % len(DASHES)])


def look(results: Results, strategy: str) -> Look:
    """The look of a strategy; one without a baseline is solid."""
    found = nth(results.place(strategy))
    return found if results.baseline else found._replace(dash="-")


# Texts ---------------------------------------------------------------------------------------------------------------


@functools.lru_cache(maxsize=4096)
def _width(text: str, size: float) -> float:
    prop = FontProperties(family="DejaVu Sans", size=size)
    return float(TextToPath().get_text_width_height_descent(text, prop, False)[0])


def width_of(texts: Sequence[str], size: float = SIZE) -> float:
    """Millimetres that the longest of the texts takes; 0 of none."""
    return max((_width(text, size) for text in texts if text), default=0.0) / POINT


def cut(text: str, most: float, size: float = SIZE) -> str:
    """The text, or its beginning with an ellipsis where it is wider than `most` millimetres."""
    if width_of([text], size) <= most:
        return text
    while text and width_of([text + "…"], size) > most:
        text = text[:-1]
    return text.rstrip() + "…"


def short_guide(text: str) -> str:
    """A guide as written, with the first of its options in braces, and with numbers of three digits."""
    text = re.sub(r"\d+\.\d{3,}", lambda found: plain(float(f"{float(found.group()):.3g}")), text)
    begin = text.find("{")
    if begin < 0:
        return text
    depth = 0
    for i, char in enumerate(text):
        depth += (char in "({") - (char in ")}")
        if char == "," and depth == 1 and i > begin:
            return text[:i] + ", … }"
        if depth == 0 and i > begin:
            break
    return text


def signed(x: float) -> str:
    """A difference with two decimals and its sign."""
    return "–" if math.isnan(x) else f"{x:+.2f}".replace("-", "−")


def digits(x: float, count: int = 2) -> str:
    """A number with so many significant digits and without an exponent; "∞" and "–" for infinity and NaN."""
    if math.isnan(x):
        return "–"
    if math.isinf(x):
        return "∞" if x > 0 else "−∞"
    if x == 0:
        return "0"
    rounded = float(f"{x:.{count - 1}e}")
    decimals = max(0, count - 1 - math.floor(math.log10(abs(rounded))))
    return f"{rounded:,.{decimals}f}"


def counted(x: float) -> str:
    """A number of checks: whole up to a hundred thousand, then three digits with k, M or G."""
    if not math.isfinite(x):
        return digits(x)
    if x < 99999.5:
        return f"{x:,.0f}" if x >= 9.95 or x == round(x) else digits(x)
    return short(float(f"{x:.2e}"))


def short(x: float) -> str:
    """A label of an axis: 300, 1k, 1.5k, 2M."""
    if x == 0:
        return "0"
    for factor, unit in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if x >= factor:
            return f"{x / factor:g}{unit}"
    return plain(x)


def plain(x: float) -> str:
    """A label of an axis of ratios or times: without an exponent."""
    return f"{x:.10f}".rstrip("0").rstrip(".") if 1e-9 < x < 1e9 else f"{x:g}"


# Axes ----------------------------------------------------------------------------------------------------------------


class Margins(NamedTuple):
    """Millimetres about and between the axes of a figure."""

    left: float = 2.0
    right: float = 2.0
    top: float = 2.0
    bottom: float = 8.5
    wide: float = 4.0
    high: float = 8.0


def sheet(name: str, width: float, height: float) -> Any:
    """A new figure of this size in millimetres, without pyplot."""
    figure = Figure(figsize=(width * MM, height * MM))
    figure.set_label(name)
    return figure


def place(
    name: str, width: float, height: float, count: int = 1, columns: int = 1, margins: Margins = Margins()
) -> List[Any]:
    """Axes of a new figure of this size in millimetres, row by row: placed, so that text changes no size."""
    rows = math.ceil(count / columns)
    m = margins
    w = (width - m.left - m.right - m.wide * (columns - 1)) / columns
    h = (height - m.top - m.bottom - m.high * (rows - 1)) / rows
    figure = sheet(name, width, height)
    axes = []
    for i in range(count):
        row, column = divmod(i, columns)
        x = m.left + column * (w + m.wide)
        y = height - m.top - row * (h + m.high) - h
        axes.append(figure.add_axes([x / width, y / height, w / width, h / height], label=f"{name} {i}"))
    return axes


def given(ax: Any, count: int, name: str) -> Optional[List[Any]]:
    """The caller's axes, one for each panel; None where there are none.

    Raises `Error` for another number.
    """
    if ax is None:
        return None
    listed = [ax] if hasattr(ax, "get_xlim") else list(np.asarray(ax, dtype=object).ravel())
    if len(listed) != count:
        raise Error(f"{name}: {count} panels need as many axes, got {len(listed)}; or name one problem")
    for one in listed:
        for side in ("top", "right"):
            one.spines[side].set_visible(False)
        for spine in one.spines.values():
            spine.set(linewidth=0.5, edgecolor=GREY)
        one.set_axisbelow(True)
        one.tick_params(which="both", color=GREY, labelcolor=INK, width=0.5, length=2.2, labelsize=SIZE)
        one.tick_params(axis="x", labelsize=6.5)
    return listed


def returned(axes: Sequence[Any]) -> Any:
    """One axes as it is, several as an array."""
    if len(axes) == 1:
        return axes[0]
    array = np.empty(len(axes), dtype=object)
    array[:] = list(axes)
    return array


def size_of(ax: Any) -> Tuple[float, float]:
    """Width and height of axes, mm."""
    box = ax.get_position(original=True)
    figure = ax.figure
    return box.width * figure.get_figwidth() / MM, box.height * figure.get_figheight() / MM


def words(ax: Any, x: float, y: float, text: str, dx: float = 0.0, dy: float = 0.0, **options: Any) -> Any:
    """Text at a share of the axes' width, at a value of y, moved by millimetres. Its capitals are centred on y, so that
    commas and brackets move no number."""
    return ax.annotate(
        text,
        (x, y),
        xycoords=ax.get_yaxis_transform(),
        xytext=(dx * POINT, dy * POINT - _CAPITAL * SMALL / 2),
        textcoords="offset points",
        annotation_clip=False,
        **{"va": "baseline", "fontsize": SMALL, **options},
    )


def above(ax: Any, x: float, text: str, dx: float = 0.0, dy: float = 0.7, **options: Any) -> Any:
    """Text above the axes, at a share of their width, moved by millimetres."""
    return ax.annotate(
        text,
        (x, 1.0),
        xycoords="axes fraction",
        xytext=(dx * POINT, dy * POINT),
        textcoords="offset points",
        annotation_clip=False,
        **{"va": "baseline", "fontsize": SMALL, "color": GREY, **options},
    )


def below(axes: Sequence[Any], label: str, own: bool, margins: Optional[Margins] = None) -> None:
    """The label of the x axis: of single axes and of the caller's own, else one for all panels."""
    if not own or len(axes) == 1 or margins is None:
        for ax in axes:
            ax.set_xlabel(label, fontsize=SIZE, color=INK)
        return
    figure = axes[0].figure
    width, height = figure.get_figwidth() / MM, figure.get_figheight() / MM
    middle = (margins.left + width - margins.right) / 2
    figure.text(middle / width, 1.6 / height, label, ha="center", va="baseline")


_TICKS = ((1, 1.5, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,))


def _log_candidates(lo: float, hi: float, marks: Sequence[float]) -> List[float]:
    first, last = math.floor(math.log10(lo)) - 1, math.ceil(math.log10(hi)) + 1
    values = [float(f"{mark}e{power}") for power in range(first, last) for mark in marks]
    return [value for value in values if lo <= value * 1.0001 and value <= hi * 1.0001]


def _fits(values: Sequence[float], lo: float, hi: float, width: float, label: Any) -> bool:
    """Whether the labels of logarithmic ticks have a gap of 1.5 mm each."""
    at = [math.log(value / lo) / math.log(hi / lo) * width for value in values]
    size = [width_of([label(value)], 6.5) for value in values]
    return all(at[i + 1] - at[i] >= (size[i] + size[i + 1]) / 2 + 1.5 for i in range(len(at) - 1))


def log_ticks(lo: float, hi: float, width: float, label: Any = short, most: int = 7) -> List[float]:
    """The finest of the rows 1-1.5-2-3-5-7, 1-2-5, 1-3 and decades whose labels fit side by side: at least three, but
    for an axis that is too narrow for them.

    width: of the axis, mm.
    """
    rows = [_log_candidates(lo, hi, marks) for marks in _TICKS]
    for row in rows:
        if 3 <= len(row) <= most and _fits(row, lo, hi, width, label):
            return row
    # Too wide for all decades, or too narrow for three of a row: each second of them, each third, ...
    for row in reversed(rows):
        for step in range(2, len(row) // 2 + 1):
            some = row[(len(row) - 1) % step // 2 :: step]
            if 3 <= len(some) <= most and _fits(some, lo, hi, width, label):
                return some
    return next((row for row in reversed(rows) if len(row) >= 2 and _fits(row, lo, hi, width, label)), rows[-1][:1])


def log_axis(ax: Any, lo: float, hi: float, label: Any = short, extra: Optional[Tuple[float, str]] = None) -> None:
    """Makes x logarithmic from lo to hi, with ticks that have labels.

    extra: a further tick at the end, with its label.
    """
    ax.set_xscale("log")
    ax.set_xlim(lo, hi)
    width = size_of(ax)[0]
    last = hi if extra is None else extra[0] / (hi / extra[0])
    ticks = log_ticks(lo, last, width * math.log(last / lo) / math.log(hi / lo), label)
    labels = [label(tick) for tick in ticks]
    if extra is not None:
        ticks, labels = ticks + [extra[0]], labels + [extra[1]]
    ax.xaxis.set_major_locator(FixedLocator(ticks))
    ax.xaxis.set_major_formatter(FixedFormatter(labels))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.xaxis.set_minor_formatter(NullFormatter())


def round_ticks(lo: float, hi: float, most: int = 5) -> List[float]:
    """Multiples of 1, 2 or 5 times a power of ten, about `most` of them."""
    step = 1.0
    power = math.floor(math.log10(hi - lo)) - 2
    for step in (mark * 10.0 ** (power + k) for k in range(3) for mark in (1, 2, 5)):
        if (hi - lo) / step <= most:
            break
    return [k * step for k in range(math.ceil(lo / step), math.floor(hi / step) + 1)]


def linear_axis(ax: Any, lo: float, hi: float, places: Optional[Sequence[float]] = None) -> None:
    """Makes x linear from lo to hi, with ticks at round numbers, or at the places given."""
    ticks = round_ticks(lo, hi) if places is None else places
    labels = [f"{tick:.6g}".replace("-", "−") for tick in ticks]
    ax.set_xlim(lo, hi)
    ax.xaxis.set_major_locator(FixedLocator(ticks))
    ax.xaxis.set_major_formatter(FixedFormatter(labels))


def span(values: Sequence[float], pad: float, least: float) -> Tuple[float, float]:
    """The ends of a logarithmic axis about the finite positive values, at least a factor of `least` apart."""
    known = [value for value in values if math.isfinite(value) and value > 0]
    if not known:
        return 1.0, 10.0
    lo, hi = min(known) / pad, max(known) * pad
    if hi / lo < least:
        lo, hi = math.sqrt(lo * hi / least), math.sqrt(lo * hi * least)
    return lo, hi


def rows_axis(ax: Any, labels: Sequence[str], shown: bool = True) -> None:
    """Makes y rows from top to bottom, with their labels."""
    count = len(labels)
    ax.set_ylim(count - 0.45, -0.55)
    ax.set_yticks(range(count))
    ax.set_yticklabels(labels if shown else [])
    ax.tick_params(axis="y", length=0, pad=2.5)
    ax.spines["left"].set_visible(False)
    ax.grid(axis="x", color=FAINT, linewidth=0.5)


# Keys ----------------------------------------------------------------------------------------------------------------

_KEY_LINE = 3.6  # mm
_KEY_GAP = 4.5


class Entry(NamedTuple):
    """An entry of a key."""

    name: str
    look: Look


def _key_rows(entries: Sequence[Entry], width: float, sign: float) -> List[List[Tuple[float, Entry]]]:
    rows: List[List[Tuple[float, Entry]]] = [[]]
    x = 0.0
    for entry in entries:
        size = sign + width_of([entry.name])
        if rows[-1] and x + size > width:
            rows.append([])
            x = 0.0
        rows[-1].append((x, entry))
        x += size + _KEY_GAP
    return rows


def key_height(entries: Sequence[Entry], width: float, lines: bool) -> float:
    """Millimetres that a key of this width takes."""
    return len(_key_rows(entries, width, 7.5 if lines else 3.0)) * _KEY_LINE


def _sign(entry: Entry, lines: bool, x: Sequence[float], y: Sequence[float], **more: Any) -> Line2D:
    """The line, or the mark, that stands for a strategy in a key."""
    return Line2D(
        x,
        y,
        color=entry.look.colour,
        linewidth=1.3,
        linestyle=entry.look.dash if lines else "none",
        marker="none" if lines else entry.look.mark,
        markersize=3.8,
        markeredgewidth=0,
        **more,
    )


def key(figure: Any, entries: Sequence[Entry], left: float, width: float, lines: bool) -> None:
    """The strategies above the panels, where they cover no data: their lines, or their marks."""
    wide, high = figure.get_figwidth() / MM, figure.get_figheight() / MM
    sign = 7.5 if lines else 3.0
    for i, row in enumerate(_key_rows(entries, width, sign)):
        y = 1 - (2.6 + i * _KEY_LINE) / high
        for x, entry in row:
            ends = [left + x, left + x + 6] if lines else [left + x + 1]
            figure.add_artist(_sign(entry, lines, [end / wide for end in ends], [y] * len(ends)))
            figure.text((left + x + sign) / wide, y - _CAPITAL * SIZE / 2 / POINT / high, entry.name, ha="left")


def inner_key(ax: Any, entries: Sequence[Entry], lines: bool, up: float = 0.7) -> None:
    """The same in the caller's axes, so many millimetres above them."""
    handles = [_sign(entry, lines, [], [], label=entry.name) for entry in entries]
    ax.legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(0, 1),
        bbox_transform=offset_copy(ax.transAxes, ax.figure, 0, up * MM),
        ncol=min(4, len(handles)),
        frameon=False,
        fontsize=SIZE,
        borderaxespad=0,
        handlelength=2.4 if lines else 0.8,
        handletextpad=0.5,
        columnspacing=1.2,
    )

# SPDX-License-Identifier: MIT-0
"""The command `python3 -m trellis.figures`: figures and tables of documents of `trellis run --json`. It prints the path
of each file that it writes. A fault is a line on the standard error; the exit status is then 1, or 2 for wrong options.
"""
from __future__ import annotations

import argparse
import os
import signal
import sys
from typing import Any, List, Optional, Sequence

from .._command import Parser, fail
from ._document import Error, read
from ._save import FORMATS, check_figures, draw, saved

_TABLES = ("csv", "markdown", "latex")


def _parser() -> argparse.ArgumentParser:
    parser = Parser(prog="python3 -m trellis.figures", allow_abbrev=False,
                    description="Draws figures and writes tables of documents of `trellis run --json`.")
    parser.add_argument("documents", metavar="DOCUMENT", nargs="+",
                        help="a document; runs of several documents are joined")
    parser.add_argument("--out", metavar="DIR", help="the folder of the figures and tables")
    parser.add_argument("--file", metavar="PICTURE", help="one figure, as .svg, .pdf or .png, in place of --out")
    parser.add_argument("--figure", metavar="NAME", action="append", default=[],
                        help="this figure alone, without tables; again for several")
    parser.add_argument("--format", metavar="LIST", default=",".join(FORMATS), help="of svg, pdf and png (default all)")
    parser.add_argument("--baseline", metavar="NAME", help="the strategy to compare with")
    parser.add_argument("--by-name", action="store_true", help="strategies of one name in several documents may differ")
    parser.add_argument("--samples", metavar="DIR", help="the folder of samples, if the document does not name it")
    parser.add_argument("--problem", metavar="NAME", help="with --file: the problem")
    parser.add_argument("--strategy", metavar="NAME", action="append", help="with --file: a strategy")
    parser.add_argument("--seed", metavar="N", help="with --file: the seed of the runs of world, strip and schedule")
    parser.add_argument("--level", metavar="N", type=int, help="with --figure world: the level of a run")
    parser.add_argument("--azimuth", metavar="DEG", type=float, help="of the camera in space")
    parser.add_argument("--elevation", metavar="DEG", type=float, help="of the camera in space")
    parser.add_argument("--no-tables", action="store_true", help="figures alone")
    return parser


_PICTURED = ("world", "levels_of_world", "strip")


def _check(options: argparse.Namespace) -> None:
    """Raises `Error` for options that contradict each other."""
    if (options.out is None) == (options.file is None):
        raise Error("name a folder with --out, or a picture with --file")
    check_figures(options.figure)
    if options.file is None:
        for name in ("problem", "strategy", "seed"):
            if getattr(options, name) is not None:
                raise Error(f"--{name} needs --file")
        if options.level is not None and options.figure != ["world"]:
            raise Error("--level is of --figure world")
        return
    if len(options.figure) != 1:
        raise Error("--file needs one --figure")
    figure = options.figure[0]
    if options.level is not None and figure != "world":
        raise Error("--level is of --figure world")
    if options.seed is not None and figure not in (*_PICTURED, "schedule"):
        raise Error("--seed is of --figure world, levels_of_world, strip and schedule")


def _arguments(options: argparse.Namespace) -> "dict[str, Any]":
    """The arguments of the one figure of --file."""
    figure = options.figure[0]
    given = {"problem": options.problem, "seed": options.seed, "level": options.level}
    if options.strategy:
        alone = figure in ("levels_of_world", "strip", "schedule")
        if alone and len(options.strategy) > 1:
            raise Error(f"--figure {figure} draws one strategy")
        given["strategy" if alone else "strategies"] = options.strategy[0] if alone else options.strategy
    if figure in _PICTURED:
        given.update(azimuth=options.azimuth, elevation=options.elevation)
    return {name: value for name, value in given.items() if value is not None}


def _run(options: argparse.Namespace) -> None:
    results = read(options.documents, options.samples, baseline=options.baseline, by_name=options.by_name)
    if options.file is not None:
        print(draw(results, options.figure[0], options.file, **_arguments(options)), flush=True)
        return
    texts = () if options.no_tables else _TABLES
    for path in saved(results, options.out, options.format.split(","), None, options.figure or None, texts,
                      options.level, options.azimuth, options.elevation):
        print(path, flush=True)


def main(arguments: Optional[Sequence[str]] = None) -> None:
    """Runs the command with these arguments (default those of the process)."""
    options = _parser().parse_args(arguments)
    try:
        _check(options)
        for one in options.format.split(","):
            if one not in FORMATS:
                raise Error(f"--format: there is no format '{one}'; there are: {', '.join(FORMATS)}")
    except Error as fault:
        fail(str(fault), 2)
    try:
        _run(options)
    except Error as fault:
        fail(str(fault), 1)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except OSError as fault:
        fail(f"{fault.filename}: {fault.strerror}" if fault.filename else str(fault), 1)
    except ImportError as missing:
        fail(str(missing), 1)
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as fault:
        where: List[str] = options.documents
        fail(f"{', '.join(where)}: the document is damaged or incomplete ({type(fault).__name__}: {fault})", 1)


if __name__ == "__main__":
    # A Ctrl-C ends it without a traceback.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    main()

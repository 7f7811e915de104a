# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py TRELLIS PAGE EXAMPLES: runs the commands and the Python cells of a page in a fresh folder, and compares what
each cell prints with the text below it. Exits with 77, which ctest reports as skipped, without pandas or matplotlib."""
import contextlib
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SKIPPED = 77


def words(text):
    """The words of each line: versions of pandas differ in spaces at the ends of lines."""
    return [line.split() for line in text.strip().splitlines()]


def main():
    try:
        import matplotlib
        import pandas  # noqa: F401
    except ImportError as missing:
        print(f"skipped: {missing}; python3-pandas and python3-matplotlib are needed")
        return SKIPPED
    matplotlib.use("Agg")
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))
    trellis, page, examples = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
    blocks = re.findall(r"^```(sh|python|text)\n(.*?)^```$", page.read_text(), re.M | re.S)
    lines = sum(len(text.splitlines()) for language, text in blocks if language == "python")
    if not 0 < lines <= 15:
        print(f"{page}: the cells have {lines} lines; the page promises 15 at most")
        return 1
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        os.symlink(examples, "examples")
        environment = dict(os.environ, PATH=f"{trellis.parent}:{os.environ['PATH']}")
        names = {}
        printed = ""
        for language, text in blocks:
            if language == "sh":
                subprocess.run(["bash", "-e", "-c", text], check=True, env=environment)
            elif language == "python":
                output = io.StringIO()
                with contextlib.redirect_stdout(output):
                    exec(compile(text, str(page), "exec"), names)
                printed = output.getvalue()
            elif words(text) != words(printed):
                failures += 1
                print(f"{page}: the page shows\n{text}\nand the cell prints\n{printed}")
        if not pathlib.Path("checks.png").read_bytes().startswith(b"\x89PNG"):
            failures += 1
            print(f"{page}: checks.png is no picture")
        os.chdir("/")
    return 1 if failures else 0


sys.exit(main())

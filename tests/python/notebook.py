# SPDX-License-Identifier: GPL-3.0-or-later
"""notebook.py [--update] FILE...: runs the code cells of notebooks, and the Python blocks of pages in Markdown, in a
fresh folder for each file, and compares what they print with what is shown. --update writes it into the file instead.
Exits with 77, which ctest reports as skipped, without pandas."""
import contextlib
import io
import json
import os
import pathlib
import re
import sys
import tempfile

SKIPPED = 77


def words(text):
    """The words of each line: versions of pandas differ in spaces."""
    return [line.split() for line in text.strip().splitlines()]


def of_notebook(text):
    """Yields each cell's source and output, and receives what it prints; returns the new text."""
    notebook = json.loads(text)
    for cell in notebook["cells"]:
        if cell["cell_type"] != "code":
            continue
        shown = "".join("".join(output["text"]) for output in cell["outputs"])
        lines = (yield "".join(cell["source"]), shown).splitlines(keepends=True)
        cell["outputs"] = [{"name": "stdout", "output_type": "stream", "text": lines}] if lines else []
    return json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"


def of_page(text):
    """The same for the blocks of a page; what a block prints stands in the block of text below it."""
    parts = re.split(r"^(```(?:python|text)\n)(.*?)(^```$)", text, flags=re.M | re.S)
    for at in range(1, len(parts), 4):
        if parts[at] != "```python\n":
            continue
        below = at + 4 < len(parts) and parts[at + 4] == "```text\n"
        printed = yield parts[at + 1], parts[at + 5] if below else ""
        if below:
            parts[at + 5] = "".join(line.rstrip() + "\n" for line in printed.splitlines())
    return "".join(parts)


def run(path, update):
    """Returns how many cells print something else than what is shown."""
    cells = (of_notebook if path.suffix == ".ipynb" else of_page)(path.read_text(encoding="utf-8"))
    names = {}
    failures = 0
    number = 0
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            source, shown = next(cells)
            while True:
                number += 1
                output = io.StringIO()
                with contextlib.redirect_stdout(output):
                    exec(compile(source, f"{path.name}, cell {number}", "exec"), names)
                printed = output.getvalue()
                if words(shown) != words(printed) and not update:
                    failures += 1
                    print(f"{path.name}, cell {number}: it shows\n{shown}\nand the cell prints\n{printed}")
                source, shown = cells.send(printed)
        except StopIteration as end:
            text = end.value
        os.chdir("/")
    if number == 0:
        print(f"{path.name} has no cells")
        failures += 1
    if update:
        path.write_text(text, encoding="utf-8")
    return failures


def main():
    try:
        import pandas  # noqa: F401
    except ImportError as missing:
        print(f"skipped: {missing}; python3-pandas is needed")
        return SKIPPED
    arguments = sys.argv[1:]
    update = "--update" in arguments
    paths = [pathlib.Path(argument).resolve() for argument in arguments if argument != "--update"]
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        for path in [path for path in paths if re.search("import (matplotlib|figures)", path.read_text(encoding="utf-8"))]:
            print(f"skipped: {path.name}; python3-matplotlib is needed")
            paths.remove(path)
    return 1 if sum(run(path, update) for path in paths) else 0


sys.exit(main())

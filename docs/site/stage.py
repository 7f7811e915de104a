#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""stage.py ROOT FOLDER: writes what Sphinx reads, for scripts/docs.

Copies README.md, CHANGELOG.md, CONTRIBUTING.md and docs/ into FOLDER. Sources that the pages link to become pages of their own, so that
the site needs neither the repository nor a network. The navigation is the map in docs/README.md: Sphinx warns of a page
that the map lacks, and scripts/docs fails on a warning.
"""

import os
import pathlib
import re
import shutil
import sys

LINK = re.compile(r"(\]\()([^)\s#]+)(#[^)\s]*)?(\))")
LANGUAGES = {
    ".lua": "lua", ".cpp": "cpp", ".hpp": "cpp", ".txt": "cmake", ".cmake": "cmake", ".json": "json", ".sh": "bash",
    ".slurm": "bash", ".py": "python",
}
PAGES = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md"]
# Titles of the navigation for the tables of the map, by the heading of their first column.
CAPTIONS = {"begin here": "Begin here", "to look up": "Look up", "results": "Results", "for developers": "Developers"}


def outside_fences(text, change):
    """`text` with `change` made of its lines outside of fenced blocks."""
    lines, fence = [], None
    for line in text.split("\n"):
        mark = re.match(r"\s*(```+)", line)
        if mark and (fence is None or mark.group(1) == fence):
            fence = mark.group(1) if fence is None else None
        elif fence is None:
            line = change(line)
        lines.append(line)
    return "\n".join(lines)


class Stage:
    """Writes the pages of one site."""

    def __init__(self, root, folder):
        self.root, self.folder, self.sources = root, folder, set()

    def target(self, page, link):
        """The link from `page` (relative to the root) to a page, a picture or a source."""
        path = pathlib.PurePosixPath(os.path.normpath(page.parent / link))
        if path == pathlib.PurePosixPath("README.md"):
            path = pathlib.PurePosixPath("index.md")
        elif path.suffix not in (".md", ".svg", ".png"):
            where = self.root / path
            if not where.exists():
                sys.exit(f"{page}: a link leads to {link}, which does not exist")
            self.sources.add(path)
            path = path / "index.md" if where.is_dir() else path.with_name(path.name + ".md")
        return os.path.relpath(path, page.parent)

    def text(self, page):
        """The text of a page, with links as the site needs them and without comments."""
        text = (self.root / page).read_text(encoding="utf-8")

        def change(line):
            line = re.sub(r"<!--.*?-->", "", line)
            return LINK.sub(lambda m: m[0] if "://" in m[2] else m[1] + self.target(page, m[2]) + (m[3] or "") + m[4], line)

        return outside_fences(text, change)

    def write(self, path, text):
        place = self.folder / path
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text, encoding="utf-8")

    def navigation(self):
        """The tables of the map as tables of contents, each with its caption."""
        trees, caption, entries = [], None, []
        for line in (self.root / "docs/README.md").read_text(encoding="utf-8").splitlines() + ["|  | |"]:
            head = re.match(r"\| ([a-z ]*) \|", line)
            entry = re.match(r"\| \[([^\]]+)\]\(([^)]+)\.md\) \|", line)
            if entry:
                page = os.path.normpath(os.path.join("docs", entry[2]))
                entries.append(page)
            elif head:
                if caption:
                    trees.append((caption, entries))
                caption, entries = CAPTIONS.get(head[1], head[1]), []
        trees[0][1].insert(0, "docs/README")
        return "\n".join(
            "\n```{toctree}\n:hidden:\n:caption: " + caption + "\n\n" + "\n".join(entries) + "\n```\n"
            for caption, entries in trees)

    def source(self, path):
        """A page for a source, or for a folder: the list of its files."""
        where = self.root / path
        # No page of sources is found by the search: words of the documentation are meant.
        head = f"---\norphan: true\nnosearch: true\n---\n\n# {path}\n\n"
        if where.is_dir():
            rows = []
            for entry in sorted(where.iterdir(), key=lambda e: (e.is_file(), e.name)):
                if entry.name.startswith("."):
                    continue
                inner = path / entry.name
                known = inner in self.sources or entry.is_dir()
                if entry.is_dir():
                    self.sources.add(inner)
                rows.append(f"- [{entry.name}/]({entry.name}/index.md)" if entry.is_dir() else
                            f"- [{entry.name}]({entry.name}.md)" if known else f"- {entry.name}")
            self.write(path / "index.md", head + "\n".join(rows) + "\n")
            return
        text = where.read_text(encoding="utf-8")
        fence = "`" * (1 + max([2] + [len(run) for run in re.findall("`+", text)]))
        language = LANGUAGES.get(path.suffix) or ("bash" if text.startswith("#!") else "text")
        self.write(path.with_name(path.name + ".md"), f"{head}{fence}{language}\n{text.rstrip()}\n{fence}\n")

    def run(self):
        """Writes everything."""
        pages = [pathlib.PurePosixPath(page) for page in PAGES]
        pages += sorted(pathlib.PurePosixPath(p.relative_to(self.root)) for p in (self.root / "docs").rglob("*.md"))
        for page in pages:
            text = self.text(page)
            if str(page) == "README.md":
                page, text = pathlib.PurePosixPath("index.md"), text + self.navigation()
            elif str(page) == "docs/decisions/README.md":
                text += "\n```{toctree}\n:hidden:\n:glob:\n\n0*\n```\n"
            self.write(page, text)
        shutil.copytree(self.root / "docs/figures", self.folder / "docs/figures")
        # The scripts of a folder are worth reading whole: each gets a page where its folder is linked.
        for path in list(self.sources):
            if (self.root / path).is_dir() and path.parts[0] in ("examples", "stdlib"):
                for entry in (self.root / path).rglob("*"):
                    if entry.suffix in LANGUAGES and entry.is_file():
                        self.sources.add(pathlib.PurePosixPath(entry.relative_to(self.root)))
        done = set()
        while self.sources - done:
            for path in sorted(self.sources - done):
                done.add(path)
                self.source(path)


if __name__ == "__main__":
    Stage(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])).run()

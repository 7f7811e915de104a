# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures and tables of documents (trellis.figures). Environment: PYTHONPATH has the package, which needs no compiled
module, TRELLIS the program. Exits with 77, which ctest reports as skipped, without matplotlib or pandas."""
import csv
import importlib.util
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

MISSING = [name for name in ("numpy", "pandas", "matplotlib") if importlib.util.find_spec(name) is None]
if MISSING:
    print(f"skipped: there is no {', '.join(MISSING)}; python3-numpy, python3-pandas and python3-matplotlib are needed")
    sys.exit(77)

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from trellis import figures
from trellis.figures import _statistics, _style

PROGRAM = os.environ["TRELLIS"]
# One that writes numbers with a comma, where the system has one.
LOCALES = subprocess.run(["locale", "-a"], stdout=subprocess.PIPE, text=True, check=True).stdout.split()
LOCALE = next((name for name in LOCALES if name[:2] in ("de", "fr", "pt")), "C.UTF-8")
MM = 25.4

SCRIPTS = {
    # One problem, two strategies, guides that were left out, scores.
    "one": """
local p = rrt { step = 0.5 }
return experiment { problems = { scenes.trap() }, baseline = "rrt", seeds = 7,
  strategies = { rrt = p, nested = skeleton() >> lazy() >> p }, measure = tube { delta = 0.5 } }""",
    # Runs without a path, infinite medians and ratios, compositions beside their parts.
    "unsolved": """
local p = rrt { step = 0.5, proposals = 1500 }
return experiment { problems = { scenes.trap(), worlds.bug_trap() }, baseline = "rrt", seeds = 8, measure = false,
  strategies = { rrt = p, skeleton = skeleton() >> p, shrink = shrink(0.5) >> p,
                 both = skeleton() >> shrink(0.5) >> p }, ablation = 1 }""",
    # A correlation with its interval.
    "many": """
local p = rrt { step = 0.5 }
return experiment { problems = { scenes.trap(), scenes.cup(), scenes.simple_passage(), worlds.bug_trap(),
    worlds.dead_ends(), worlds.rooms { rooms = 3, seed = 1 } },
  baseline = "rrt", seeds = 5, ablation = 0, measure = tube { delta = 0.5 },
  strategies = { rrt = p, skeleton = skeleton() >> p, shrink = shrink(0.5) >> p,
                 nested = skeleton() >> lazy() >> p } }""",
    # An option over three numbers, without scores; as many strategies as colours repeat for.
    "options": """
local p = rrt { step = 0.5 }
local s = { rrt = p, lazy = lazy() >> p, connect = rrt_connect { step = 0.5 }, skeleton = skeleton() >> p }
for _, x in ipairs { 0.3, 0.5, 0.7, 0.8, 0.9 } do s["shrink by " .. x] = skeleton() >> shrink(x) >> p end
return experiment { problems = { scenes.trap(), scenes.simple_passage() }, strategies = s, baseline = "rrt", seeds = 6,
  measure = false, ablation = 0 }""",
    # No baseline, three seeds: no intervals.
    "alone": """
return experiment { problems = { scenes.trap() }, seeds = 3, measure = false, ablation = 0,
  strategies = { ["a name with $ and _"] = skeleton() >> rrt { step = 0.5 } } }""",
    # Strategies that `ablate` adds are in tables and in no figure.
    "ablate": """
local p = rrt { step = 0.5 }
return experiment { problems = { scenes.trap() }, baseline = "rrt", seeds = 6, ablate = true, measure = false,
  strategies = { rrt = p, nested = skeleton() >> lazy() >> p } }""",
}
DRAWN = {
    "one": ["costs", "success", "ratios", "levels", "waterfall"],
    "unsolved": ["costs", "success", "ratios", "levels"],
    "many": ["costs", "success", "ratios", "levels", "waterfall", "correlation"],
    "options": ["costs", "success", "ratios", "levels", "scales"],
    "alone": ["costs", "success"],
    "ablate": ["costs", "success", "ratios", "levels"],
}


def setUpModule():
    global PLACE, DOCUMENTS
    PLACE = tempfile.TemporaryDirectory()
    DOCUMENTS = {}
    for name, script in SCRIPTS.items():
        file = pathlib.Path(PLACE.name, f"{name}.lua")
        file.write_text(script, encoding="utf-8")
        DOCUMENTS[name] = str(file.with_suffix(".json"))
        subprocess.run([PROGRAM, "run", str(file), "--quiet", "--json", DOCUMENTS[name]], check=True,
                       stderr=subprocess.DEVNULL)


def tearDownModule():
    PLACE.cleanup()


def listed(axes):
    return list(axes) if isinstance(axes, np.ndarray) else [axes]


def texts_of(figure):
    """The visible texts of a figure with their boxes in pixels."""
    FigureCanvasAgg(figure)
    renderer = figure.canvas.get_renderer()
    figure.draw(renderer)
    found = []
    for text in figure.findobj(matplotlib.text.Text):
        if not text.get_visible() or not text.get_text().strip():
            continue
        box = text.get_window_extent(renderer)
        if box.width > 0:
            found.append((text.get_text(), box))
    return found


def faults_of(figure):
    """Texts that leave the figure, and pairs of texts that overlap."""
    faults = []
    texts = texts_of(figure)
    wide, high = figure.bbox.width, figure.bbox.height
    for words, box in texts:
        if box.x0 < -0.5 or box.y0 < -0.5 or box.x1 > wide + 0.5 or box.y1 > high + 0.5:
            faults.append(f"'{words}' leaves the figure")
    for i, (words, box) in enumerate(texts):
        for others, other in texts[i + 1:]:
            across = min(box.x1, other.x1) - max(box.x0, other.x0)
            along = min(box.y1, other.y1) - max(box.y0, other.y0)
            if across > 1 and along > 1.5:
                faults.append(f"'{words}' overlaps '{others}'")
    return faults


class Documents(unittest.TestCase):
    def test_no_compiled_module_is_loaded(self):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(figures.__file__).parent
            place = pathlib.Path(folder, "trellis")
            shutil.copytree(source, place / "figures", ignore=shutil.ignore_patterns("__pycache__"))
            shutil.copy(source.parent / "__init__.py", place)
            code = "import trellis, sys\nfrom trellis import figures\nassert trellis.figures is figures\n" \
                   f"assert figures.costs({DOCUMENTS['one']!r}) is not None\n" \
                   "assert 'run' in dir(trellis) and 'matplotlib.pyplot' not in sys.modules\n" \
                   "try: trellis.run\nexcept ImportError as missing: assert '_trellis' in str(missing)\n" \
                   "else: raise AssertionError('a module that is not there was loaded')\n"
            subprocess.run([sys.executable, "-B", "-c", code], check=True, env={**os.environ, "PYTHONPATH": folder})

    def test_a_path_a_dict_and_results_are_the_same(self):
        results = figures.read(DOCUMENTS["one"])
        self.assertIs(figures.read(results), results)
        with open(DOCUMENTS["one"], encoding="utf-8") as file:
            content = json.load(file)
        self.assertEqual(figures.read(content).strategies, results.strategies)
        self.assertEqual(figures.read(pathlib.Path(DOCUMENTS["one"])).strategies, results.strategies)

        class Result:
            document = content

        self.assertEqual(figures.read(Result()).strategies, results.strategies)

    def test_faults(self):
        with open(DOCUMENTS["one"], encoding="utf-8") as file:
            content = json.load(file)
        other = {**content, "trellis": {"version": "0.1.0", "format": 2}}
        text = pathlib.Path(PLACE.name, "text.json")
        text.write_text("not JSON", encoding="utf-8")
        for fault, call in {
            "format 2; figures read format 4": lambda: figures.read(other),
            "format 1; figures read format 4": lambda: figures.read({**content, "trellis": {"version": "0.0.1"}}),
            "no document of `trellis run --json`": lambda: figures.costs({"runs": []}),
            "text.json: this is no JSON document": lambda: figures.costs(str(text)),
            "a document is a path, a dict or a result, got int": lambda: figures.read(3),
            "there is no problem 'cup'; there are: trap": lambda: figures.costs(content, problem="cup"),
            "there is no strategy 'rtt'; there are: rrt, nested": lambda: figures.success(content, strategies=["rtt"]),
            "there is no cost 'money'": lambda: figures.costs(content, cost="money"),
            "2 panels need as many axes, got 1": lambda: figures.costs(DOCUMENTS["unsolved"],
                                                                       ax=Figure().add_subplot()),
            "ratios need a baseline": lambda: figures.ratios(DOCUMENTS["alone"]),
            "no guide was tested": lambda: figures.levels(DOCUMENTS["alone"]),
            "no level with a guide has nats": lambda: figures.waterfall(DOCUMENTS["options"]),
            "a correlation needs two problems": lambda: figures.correlation(content),
            "no three strategies differ": lambda: figures.scales(content),
            "there is no option 'x'; there are: scale of shrink": lambda: figures.scales(DOCUMENTS["options"],
                                                                                         option="x"),
            "there is no format 'gif'": lambda: figures.save(content, PLACE.name, formats=["gif"]),
            "there is no format 'html' of tables": lambda: figures.tables(content, "html"),
            "the figure has no name": lambda: figures.save(Figure(), PLACE.name),
        }.items():
            with self.subTest(fault), self.assertRaisesRegex(figures.Error, fault.replace("`", ".")):
                call()
        with self.assertRaises(OSError):
            figures.read("no-such.json")

    def test_order_and_looks(self):
        results = figures.read(DOCUMENTS["many"])
        self.assertEqual(results.strategies[0], "rrt")
        means = [sum(math.log(results.ratio(problem, name).value) for problem in results.problems)
                 for name in results.others]
        self.assertEqual(means, sorted(means))
        names = [strategy["name"] for strategy in results.document["experiment"]["strategies"]]
        looks = [_style.look(results, name) for name in names if name != "rrt"]
        self.assertEqual([look.colour for look in looks], list(_style.OKABE_ITO[:3]))
        self.assertEqual(_style.look(results, "rrt").colour, _style.BASELINE)
        self.assertEqual(len({(look.colour, look.mark) for look in map(_style.nth, range(49))}), 49)
        self.assertEqual(figures.read(DOCUMENTS["ablate"]).strategies, ["rrt", "nested"])


    def test_every_public_name_is_documented(self):
        for name in figures.__all__:
            value = getattr(figures, name)
            self.assertTrue(value.__doc__, name)
            for member, function in vars(value).items() if isinstance(value, type) else ():
                if not member.startswith("_") and callable(function):
                    self.assertTrue(function.__doc__, f"{name}.{member}")


class Numbers(unittest.TestCase):
    """They are those of `trellis report --report costs`."""

    def same(self, mine, theirs, what):
        theirs = float(theirs) if theirs else math.nan
        if not (mine == theirs or math.isnan(mine) and math.isnan(theirs)):
            self.assertTrue(math.isclose(mine, theirs, rel_tol=1e-12), f"{what}: {mine}, not {theirs}")

    def test_paired_costs(self):
        compared = 0
        for name, document in DOCUMENTS.items():
            frames = figures.tables(document)
            if "paired" not in frames:
                continue
            folder = pathlib.Path(PLACE.name, f"{name}-costs")
            subprocess.run([PROGRAM, "report", document, "--report", "costs", "--baseline", "rrt",
                            "--out", str(folder)], check=True, stdout=subprocess.DEVNULL)
            with open(folder / "table.csv", encoding="utf-8") as file:
                theirs = {tuple(row[key] for key in ("problem", "strategy", "against", "quantity")): row
                          for row in csv.DictReader(file)}
            mine = {(row["problem"], row["strategy"], row["against"], row["quantity"]): row
                    for row in frames["paired"].to_dict("records")}
            self.assertEqual(set(mine), set(theirs))
            for key, row in mine.items():
                self.assertEqual(row["reference"], theirs[key]["reference"])
                for column in ("runs", "solved", "reference_solved", "both_solved", "median", "reference_median",
                               "ratio_of_medians", "ratio_of_totals", "paired_ratio", "lo", "hi", "sign_p", "holm_p",
                               "effect"):
                    self.same(float(row[column]), theirs[key][column], (name, key, column))
                    compared += 1
            if "correlation" in frames:
                self.correlation(frames["correlation"], (folder / "table.md").read_text(encoding="utf-8"))
        self.assertGreater(compared, 1000)

    def correlation(self, frame, page):
        """Rank correlations and intervals of the bootstrap, as printed."""
        rows = page[page.index("| nats above uniform"):].split("\n\n")[0].splitlines()[2:]
        for row, line in zip(frame.to_dict("records"), rows):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            self.assertEqual(cells[0], row["nats"])
            for role, cell in zip(("nodes", "proposals"), cells[1:]):
                printed = f"{row[role]:+.2f}"
                if not math.isnan(row[f"{role}_lo"]):
                    printed += f" [{row[role + '_lo']:+.2f}, {row[role + '_hi']:+.2f}]"
                self.assertEqual(printed.replace("-0.00", "+0.00"), cell.replace("-0.00", "+0.00"))
        self.assertEqual(len(rows), len(frame))

    def test_medians_and_intervals_of_the_summary(self):
        for name, document in DOCUMENTS.items():
            results = figures.read(document)
            for problem in results.problems:
                for strategy in results.strategies:
                    given = results.median(problem, strategy)
                    found = _statistics.median_interval(list(results.costs(problem, strategy)))
                    for end in ("value", "lo", "hi"):
                        self.same(getattr(found, end), getattr(given, end), (name, problem, strategy, end))
                    entry = results.summary(problem, strategy)["success"]
                    solved, runs = results.solved(problem, strategy)
                    lo, hi = _statistics.wilson(np.array([solved]), runs)
                    self.assertAlmostEqual(lo[0], entry["lo"], places=12)
                    self.assertAlmostEqual(hi[0], entry["hi"], places=12)

    def test_a_costs_figure_shows_them(self):
        results = figures.read(DOCUMENTS["one"])
        ax = figures.costs(results)
        for row, strategy in enumerate(results.strategies):
            value = results.median("trap", strategy)
            found = [line.get_xdata() for line in ax.get_lines()
                     if len(line.get_xdata()) == 2 and abs(float(np.mean(line.get_ydata())) - row) < 1e-9]
            self.assertIn([value.lo, value.hi], [list(ends) for ends in found])
            self.assertIn([value.value] * 2, [list(ends) for ends in found])
        printed = {text.get_text() for text in ax.texts}
        self.assertIn("7/7", printed)
        self.assertIn(f"{results.median('trap', 'rrt').value:,.0f}", printed)

    def test_levels_are_verdicts(self):
        results = figures.read(DOCUMENTS["one"])
        frame = figures.tables(results)["levels"]
        entry = results.summary("trap", "nested")
        for row, level in zip(frame.to_dict("records"), entry["levels"][1:]):
            verdict = level["verdict"]
            self.assertEqual((row["guide"], row["verdict"]), (level["name"], verdict["verdict"]))
            self.same(1 / row["ratio"], verdict["ratio"]["median"]["hi"], "median")
            self.assertEqual(row["at_least"], verdict["ratio"]["median"]["lo"] != verdict["ratio"]["median"]["hi"])

    def test_students_distribution(self):
        for freedom, quantile in ((1, 12.7062047362), (2, 4.3026527297), (5, 2.5705818356), (10, 2.2281388520),
                                  (30, 2.0422724563)):
            self.assertAlmostEqual(_statistics._student_quantile(0.975, freedom), quantile, places=8)


class Pictures(unittest.TestCase):
    def test_every_supported_figure(self):
        for name, document in DOCUMENTS.items():
            self.assertEqual(figures.supported(document), DRAWN[name], name)

    def test_texts_lie_in_the_figure_and_do_not_overlap(self):
        for name, document in DOCUMENTS.items():
            for drawn in DRAWN[name]:
                with self.subTest(f"{drawn} of {name}"), _style.styled():
                    axes = getattr(figures, drawn)(document)
                    self.assertEqual(faults_of(listed(axes)[0].figure), [])

    def test_sizes_in_millimetres(self):
        sizes = {("one", "costs"): (86, 24), ("one", "success"): (86, 52), ("one", "levels"): (86, 24),
                 ("many", "costs"): (178, 62), ("many", "success"): (178, 90)}
        for (name, drawn), (width, height) in sizes.items():
            figure = listed(getattr(figures, drawn)(DOCUMENTS[name]))[0].figure
            found = figure.get_size_inches() * MM
            self.assertAlmostEqual(found[0], width, places=6)
            self.assertLess(abs(found[1] - height), 2, (name, drawn, found))
        for name, document in DOCUMENTS.items():
            for drawn in DRAWN[name]:
                found = listed(getattr(figures, drawn)(document))[0].figure.get_size_inches() * MM
                self.assertIn(round(found[0], 6), (86, 178))
                self.assertLessEqual(found[1], 230)

    def test_ticks(self):
        for lo, hi, width in ((1, 8, 30), (300, 2.5e5, 33), (0.02, 13, 50), (1e-4, 1e4, 45), (4e3, 1.2e5, 60),
                              (1, 1e12, 40)):
            ticks = _style.log_ticks(lo, hi, width)
            self.assertGreaterEqual(len(ticks), 3, (lo, hi))
            self.assertLessEqual(len(ticks), 7)
            leading = {round(tick / 10 ** math.floor(math.log10(tick) + 1e-9), 6) for tick in ticks}
            self.assertTrue(any(leading <= set(marks) for marks in _style._TICKS), ticks)

    def test_axes_of_the_caller(self):
        figure = Figure(figsize=(7, 7))
        axes = figure.subplots(4, 2)
        document = DOCUMENTS["unsolved"]
        before = dict(matplotlib.rcParams)
        self.assertEqual(list(figures.costs(document, ax=axes[0])), list(axes[0]))
        self.assertEqual(list(figures.success(document, ax=list(axes[1]))), list(axes[1]))
        self.assertIs(figures.ratios(document, ax=axes[2, 0]), axes[2, 0])
        self.assertIs(figures.levels(document, problem="trap", ax=axes[2, 1]), axes[2, 1])
        self.assertIs(figures.costs(document, together=True, ax=axes[3, 0]), axes[3, 0])
        self.assertIs(figures.scales(DOCUMENTS["options"], ax=axes[3, 1]), axes[3, 1])
        self.assertEqual(dict(matplotlib.rcParams), before)
        self.assertEqual(axes[0, 0].get_title(loc="left"), "trap")
        self.assertEqual(axes[3, 0].get_title(loc="left"), "all 2 problems")


class Files(unittest.TestCase):
    RC = "backend: svg\nfont.size: 23\nsvg.fonttype: none\nsvg.hashsalt: other\nsavefig.dpi: 31\naxes.grid: True\n" \
         "text.color: red\naxes.facecolor: yellow\nsavefig.transparent: True\nsavefig.bbox: tight\n" \
         "pdf.compression: 0\n" \
         "axes.formatter.use_locale: True\nlines.linestyle: --\nfont.family: serif\npath.sketch: 1, 100, 2\n"

    def saved(self, name, place, **environment):
        code = f"import os\nos.makedirs({place!r})\nfrom trellis import figures\n" \
               f"figures.save({DOCUMENTS[name]!r}, {place!r})\n"
        subprocess.run([sys.executable, "-B", "-W", "ignore", "-c", code], check=True,
                       env={**os.environ, **environment}, cwd=PLACE.name)
        return {path.name: path.read_bytes() for path in sorted(pathlib.Path(place).iterdir())}

    def test_the_same_document_gives_the_same_bytes(self):
        settings = pathlib.Path(PLACE.name, "matplotlibrc")
        settings.write_text(self.RC, encoding="utf-8")
        for name in ("one", "options"):
            here = self.saved(name, os.path.join(PLACE.name, f"{name}-a"), PYTHONHASHSEED="1", TZ="UTC", LC_ALL="C",
                              MPLBACKEND="agg", MATPLOTLIBRC="/nowhere")
            there = self.saved(name, os.path.join(PLACE.name, f"{name}-b"), PYTHONHASHSEED="2", TZ="Asia/Kathmandu",
                               LC_ALL=LOCALE, MPLBACKEND="template", MATPLOTLIBRC=str(settings),
                               SOURCE_DATE_EPOCH="0")
            self.assertEqual(list(here), list(there))
            self.assertEqual({file for file in here if here[file] != there[file]}, set())
            kinds = {"svg": b"<?xml", "pdf": b"%PDF", "png": b"\x89PNG"}
            for drawn in DRAWN[name]:
                for ending, head in kinds.items():
                    self.assertTrue(here[f"{drawn}.{ending}"].startswith(head))

    def test_one_figure(self):
        ax = figures.costs(DOCUMENTS["one"])
        folder = pathlib.Path(PLACE.name, "some", "where")
        written = figures.save(ax, folder, ["pdf", "svg"])
        self.assertEqual(written, [folder / "costs.pdf", folder / "costs.svg"])
        panels = figures.costs(DOCUMENTS["unsolved"])
        self.assertEqual(figures.save(panels, folder, ["png"], name="mine"), [folder / "mine.png"])
        self.assertEqual(figures.save(ax.figure, str(folder), ["svg"]), [folder / "costs.svg"])
        self.assertEqual((folder / "costs.svg").read_bytes().count(b"<dc:date>"), 0)

    def test_tables(self):
        texts = {form: figures.tables(DOCUMENTS["one"], form) for form in ("csv", "markdown", "latex")}
        for form in texts:
            self.assertEqual(list(texts[form]), ["costs", "levels", "paired"])
        rows = list(csv.DictReader(texts["csv"]["costs"].splitlines()))
        self.assertEqual([row["strategy"] for row in rows], ["rrt", "nested"])
        results = figures.read(DOCUMENTS["one"])
        self.assertEqual(float(rows[1]["ratio"]), results.ratio("trap", "nested").value)
        self.assertIn("| trap | nested | 7/7 |", texts["markdown"]["costs"])
        self.assertTrue(texts["latex"]["costs"].startswith("\\begin{tabular}{llrrrrrr}\n\\toprule\n"))
        self.assertIn("a name with \\$ and \\_", figures.tables(DOCUMENTS["alone"], "latex")["costs"])
        infinite = figures.tables(DOCUMENTS["unsolved"])["costs"]
        row = infinite[(infinite.problem == "bug_trap") & (infinite.strategy == "rrt")]
        self.assertTrue(np.isinf(row.checks).all())


if __name__ == "__main__":
    unittest.main()

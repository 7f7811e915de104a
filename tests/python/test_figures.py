# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures and tables of documents (trellis.figures). Environment: PYTHONPATH has the package, which needs no compiled
module, TRELLIS the program. Exits with 77, which ctest reports as skipped, without matplotlib or pandas."""
import importlib.util
import csv
import json
import math
import os
import pathlib
import re
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
from trellis.figures import _plane, _scenes, _space, _statistics, _style, _teams

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
    # Worlds and motions, with samples: bodies, arms, teams, and space.
    "plane": """
local p = rrt { step = 0.5 }
return experiment { problems = { scenes.trap() }, baseline = "rrt", seeds = 2, measure = false, ablation = 0,
  strategies = { rrt = p, nested = skeleton() >> lazy() >> p } }""",
    "arm": """
local p = rrt_connect { step = 0.3 }
return experiment { problems = { problem { name = "gap", start = { 0.3, 0.2, 0.1 }, goal = { 2.8, -0.3, 0.2 },
    robot = robot.arm { links = {1.5, 1.5, 1.5}, base = {5, 1} },
    world = world { bounds = {0, 0, 10, 10}, box {4.5, 3, 5.5, 6}, box {0, 8, 5, 9}, box {5, 8, 10, 9} } } },
  strategies = { rrt_connect = p, skeleton = skeleton() >> p }, baseline = "rrt_connect", seeds = 1, measure = false,
  ablation = 0 }""",
    "team": """
local p = rrt_connect { bound = 0 }
return experiment { problems = { problem { name = "a/b c", robot = robots { robot.disc(0.5), robot.rectangle(1, 0.6) },
    world = world { bounds = {0, 0, 10, 6}, box {4.5, 0, 5.5, 1} },
    start = { {1, 3}, {9, 3, 0} }, goal = { {9, 3}, {1, 3, 0} } } },
  strategies = { alone = rrt_connect {}, prioritise = prioritise() >> p }, baseline = "alone", seeds = 1,
  measure = false, ablation = 0 }""",
    "space": """
local p = rrt_connect { step = 1 }
return experiment { problems = { problem { name = "slot", robot = robot.rigid { box {-0.8, -0.5, -0.1, 0.8, 0.5, 0.1} },
    world = world { bounds = {0, 0, 0, 10, 10, 10}, box {4, 0, 0, 6, 10, 3}, box {4, 0, 7, 6, 5, 10},
                    box {4, 5, 7, 6, 10, 10} },
    start = pose {1, 5, 5}, goal = pose {9, 5, 5, axis = {1, 0, 0}, angle = 1} } },
  strategies = { rrt_connect = p, workspace = workspace() >> p }, baseline = "rrt_connect", seeds = 1, measure = false,
  ablation = 0 }""",
    # Strategies that `ablate` adds are in tables and in no figure.
    "ablate": """
local p = rrt { step = 0.5 }
return experiment { problems = { scenes.trap() }, baseline = "rrt", seeds = 6, ablate = true, measure = false,
  strategies = { rrt = p, nested = skeleton() >> lazy() >> p } }""",
}
WITH_SAMPLES = ("plane", "arm", "team", "space")
DRAWN = {
    "one": ["costs", "success", "ratios", "levels", "waterfall", "profile", "world", "strip"],
    "unsolved": ["costs", "success", "ratios", "levels", "world", "strip"],
    "many": ["costs", "success", "ratios", "levels", "waterfall", "correlation", "profile", "world", "strip"],
    "options": ["costs", "success", "ratios", "levels", "scales", "world", "strip"],
    "alone": ["costs", "success", "world", "strip"],
    "plane": ["costs", "success", "ratios", "world", "levels_of_world", "strip"],
    "arm": ["costs", "success", "ratios", "levels", "world", "levels_of_world", "strip"],
    "team": ["costs", "success", "ratios", "world", "levels_of_world", "strip", "schedule"],
    "space": ["costs", "success", "ratios", "world", "levels_of_world", "strip"],
    "ablate": ["costs", "success", "ratios", "levels", "world", "strip"],
}


def setUpModule():
    global PLACE, DOCUMENTS
    PLACE = tempfile.TemporaryDirectory()
    DOCUMENTS = {}
    for name, script in SCRIPTS.items():
        file = pathlib.Path(PLACE.name, f"{name}.lua")
        file.write_text(script, encoding="utf-8")
        DOCUMENTS[name] = str(file.with_suffix(".json"))
        samples = ["--samples", str(file.with_name(f"{name}-samples"))] if name in WITH_SAMPLES else []
        subprocess.run([PROGRAM, "run", str(file), "--quiet", "--json", DOCUMENTS[name], *samples], check=True,
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
            for module in ("__init__.py", "columns.py"):
                shutil.copy(source.parent / module, place)
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
        lone = {**content, "experiment": {**content["experiment"], "strategies": [
            {**one, "guided": False} for one in content["experiment"]["strategies"]]}}
        other = {**content, "trellis": {"version": "0.1.0", "format": 2}}
        text = pathlib.Path(PLACE.name, "text.json")
        text.write_text("not JSON", encoding="utf-8")
        for fault, call in {
            "format 2; figures read format 5": lambda: figures.read(other),
            "format 1; figures read format 5": lambda: figures.read({**content, "trellis": {"version": "0.0.1"}}),
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
            "there is no run of 'rrt' on 'trap' with seed 99": lambda: figures.world(content, seed=99),
            "there are no samples of 'nested' on 'trap': run it with --samples DIR, --out DIR, in Python samples=DIR":
                lambda: figures.levels_of_world(content),
            "index.json is missing: name the folder of `trellis run --samples`":
                lambda: figures.levels_of_world(figures.read(DOCUMENTS["plane"], samples="/nowhere")),
            "no strategy has guides": lambda: figures.levels_of_world(lone),
            "no run of 'rrt' on 'bug_trap' has a path":
                lambda: figures.strip(DOCUMENTS["unsolved"], problem="bug_trap", strategy="rrt"),
            "strip: at least 2 frames are needed, got 1": lambda: figures.strip(content, frames=1),
            "no run of a team has a path with times": lambda: figures.schedule(content),
            "'trap' has no team, which a schedule needs": lambda: figures.schedule(content, problem="trap"),
            "no problem has a world that can be drawn": lambda: figures.world({**content, "scenes": []}),
            "'trap' has no world that can be drawn": lambda: figures.world({**content, "scenes": []}, problem="trap"),
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
            results = figures.read(document)
            frames = figures.tables(results)
            if "paired" not in frames:
                continue
            rows = {(row["problem"], row["strategy"], row["against"], row["quantity"]): row
                    for row in frames["paired"].to_dict("records")}
            # Beside the baseline they are those that the program compared.
            for entry in results.document["comparisons"]:
                row = rows.get((entry["problem"], entry["strategy"], "baseline", "validity_checks"))
                if row is None or entry.get("ablation"):
                    continue
                for end, column in (("value", "paired_ratio"), ("lo", "lo"), ("hi", "hi")):
                    theirs = entry["ratio"].get(end)
                    self.same(float(row[column]), "" if theirs is None else str(theirs), (name, entry["strategy"], end))
                    compared += 1
            # Beside another reference they are those of a document whose baseline it is.
            for (problem, strategy, against, quantity), row in rows.items():
                if against == "baseline" or row["reference"] not in results.strategies:
                    continue
                other = figures.tables(figures.read(document, baseline=row["reference"]))["paired"]
                same = other[(other["problem"] == problem) & (other["strategy"] == strategy)
                             & (other["against"] == "baseline") & (other["quantity"] == quantity)].to_dict("records")
                for column in ("runs", "solved", "reference_solved", "both_solved", "median", "reference_median",
                               "ratio_of_medians", "ratio_of_totals", "paired_ratio", "lo", "hi", "sign_p", "effect"):
                    self.same(float(row[column]), str(same[0][column]), (name, problem, strategy, against, column))
                    compared += 1
            if "correlation" in frames:
                self.correlation(frames["correlation"], document)
        self.assertGreater(compared, 200)

    def test_known_paired_costs(self):
        """Solved at half the cost, unsolved beside solved, and neither."""
        mine = {1: 50.0, 2: 30.0, 3: math.inf, 4: math.inf, 5: 100.0}
        found = _statistics.paired_costs(mine, {1: 100.0, 2: 60.0, 3: 80.0, 4: math.inf, 5: 100.0, 9: 1.0})
        self.assertEqual((found.pairs, found.reference_solved, found.both_solved), (5, 4, 3))
        self.assertEqual((found.median, found.reference_median, found.ratio.value), (100.0, 100.0, 1.0))
        self.assertEqual((found.ratio_of_medians, found.effect), (1.0, 0.2))
        self.assertTrue(math.isnan(found.ratio_of_totals))

    def correlation(self, frame, document):
        """Rank correlations and intervals of the bootstrap, as the program prints them."""
        text = subprocess.run([PROGRAM, "report", document, "--report", "costs", "--width", "200"], check=True,
                              stdout=subprocess.PIPE, text=True).stdout
        rows = text[text.index("\nnats above uniform"):].strip().splitlines()[-len(frame):]
        for row, line in zip(frame.to_dict("records"), rows):
            cells = re.split(r"\s{2,}", line.strip())
            self.assertEqual(cells[0], row["nats"])
            for role, cell in zip(("nodes", "proposals"), cells[1:]):
                printed = "-" if math.isnan(row[role]) else f"{row[role]:+.2f}"
                if not math.isnan(row[f"{role}_lo"]):
                    printed += f" [{row[role + '_lo']:+.2f}, {row[role + '_hi']:+.2f}]"
                self.assertEqual(printed.replace("-0.00", "+0.00"), cell.replace("-0.00", "+0.00"))

    def test_medians_and_intervals_of_the_summary(self):
        for name, document in DOCUMENTS.items():
            results = figures.read(document)
            for problem in results.problems:
                for strategy in results.strategies:
                    given = results.median(problem, strategy)
                    found = _statistics.median_interval(list(results.costs(problem, strategy)))
                    for end in ("value", "lo", "hi"):
                        self.same(getattr(found, end), getattr(given, end), (name, problem, strategy, end))
                    # Of costs that the summary does not have, too.
                    seconds = _statistics.median_interval(list(results.costs(problem, strategy, "cpu_s")))
                    self.assertEqual(repr(results.median(problem, strategy, "cpu_s").value), repr(seconds.value))
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
        more = Figure(figsize=(7, 7)).subplots(4, 3)
        self.assertEqual(list(figures.world(DOCUMENTS["plane"], ax=more[0, :2])), list(more[0, :2]))
        self.assertIs(figures.world(document, problem="trap", strategies=["both"], ax=more[0, 2]), more[0, 2])
        self.assertEqual(list(figures.levels_of_world(DOCUMENTS["plane"], ax=more[1])), list(more[1]))
        self.assertEqual(list(figures.strip(DOCUMENTS["space"], frames=3, ax=more[2])), list(more[2]))
        self.assertEqual(list(figures.schedule(DOCUMENTS["team"], ax=more[3, :2])), list(more[3, :2]))
        self.assertEqual(dict(matplotlib.rcParams), before)
        self.assertEqual(axes[0, 0].get_title(loc="left"), "trap")
        self.assertEqual(axes[3, 0].get_title(loc="left"), "all 2 problems")


def box_of(lo, hi):
    """The corners and triangles of a box."""
    corners = np.array([[(lo, hi)[i >> k & 1][k] for k in range(3)] for i in range(8)], float)
    sides = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
    return corners, np.array([[a, b, c] for a, b, c, _ in sides] + [[a, c, d] for a, _, c, d in sides])


def varint(values):
    """Packs whole numbers as the program does."""
    import base64
    out = bytearray()
    for value in values:
        while value > 127:
            out.append(value & 127 | 128)
            value >>= 7
        out.append(value)
    return base64.b64encode(bytes(out)).decode()


class Worlds(unittest.TestCase):
    def lines(self, ax, points):
        """Whether a line of the axes has exactly these points."""
        return any(len(line.get_xdata()) == len(points) and np.allclose(line.get_xydata(), points)
                   for line in ax.get_lines())

    def test_a_world_shows_path_tree_and_samples(self):
        results = figures.read(DOCUMENTS["plane"])
        axes = figures.world(results)
        for ax, name in zip(axes, ("rrt", "nested")):
            run = next(run for run in results.runs("trap", name) if run["solved"])
            self.assertTrue(self.lines(ax, np.array(run["path"])[:, :2]))
            texts = {text.get_text() for text in ax.texts}
            self.assertTrue({name, f"{run['validity_checks']:,} checks, {run['length']:.1f} m"} <= texts, texts)
            level = _scenes.levels_of(results, run, _scenes.scene_of(results, "trap"))[0]
            self.assertTrue(self.lines(ax, level.proposals[:, :2]))
            self.assertGreater(len(level.edges), 0)
            ends = {tuple(np.round(end, 9)) for end in level.nodes[level.edges][..., :2].reshape(-1, 2)}
            drawn = {tuple(np.round(end, 9)) for patch in ax.findobj(matplotlib.patches.PathPatch)
                     for end in patch.get_path().vertices}
            self.assertTrue(ends <= drawn)
        last = results.runs("trap", "nested")[-1]
        ax = figures.world(results, strategies=["nested"], seed=last["seed"])
        self.assertTrue(self.lines(ax, np.array(last["path"])[:, :2]))

    def test_a_world_without_samples(self):
        with open(DOCUMENTS["plane"], encoding="utf-8") as file:
            content = json.load(file)
        self.assertNotIn("levels_of_world", figures.supported(content))
        self.assertIn("world", figures.supported(content))
        ax = figures.world(content, strategies=["rrt"])
        self.assertTrue(self.lines(ax, np.array(content["runs"][0]["path"])[:, :2])
                        or self.lines(ax, np.array(figures.read(content).runs("trap", "rrt")[0]["path"])[:, :2]))
        again = figures.read(content, samples=pathlib.Path(PLACE.name, "plane-samples"))
        self.assertIn("levels_of_world", figures.supported(again))
        self.assertEqual(len(figures.levels_of_world(again)), 3)

    def test_levels_from_guide_to_robot(self):
        results = figures.read(DOCUMENTS["plane"])
        axes = figures.levels_of_world(results)
        run = results.runs("trap", "nested")[0]
        for ax, entry in zip(axes, reversed(results.levels(run))):
            texts = " ".join(text.get_text() for text in ax.texts)
            self.assertIn(f": {entry['validity_checks']:,} checks", texts)
        self.assertEqual([ax.texts[0].get_text() for ax in axes], ["skeleton()", ">> lazy()", ">> rrt"])

    def test_samples_are_those_of_the_text_files(self):
        """The packed ones have 16 bits a coordinate."""
        results = figures.read(DOCUMENTS["plane"])
        run = results.runs("trap", "rrt")[0]
        level = _scenes.levels_of(results, run, _scenes.scene_of(results, "trap"))[0]
        file = pathlib.Path(PLACE.name, "plane-samples", "trap", "rrt", f"seed-{run['seed']}", "samples.csv")
        rows = [row for row in csv.DictReader(file.read_text(encoding="utf-8").splitlines()) if row["level"] == "0"]
        for role, packed in (("tree", level.nodes), ("expansion", level.proposals)):
            stored = np.array([[float(row[name]) for name in ("q1", "q2", "q3")] for row in rows if row["role"] == role])
            self.assertEqual(stored.shape, packed.shape)
            error = np.abs(stored - packed) / (level.space.hi - level.space.lo)
            self.assertLessEqual(error.max(), 0.5001 / 65535)

    def test_strip_moves_from_start_to_goal(self):
        results = figures.read(DOCUMENTS["arm"])
        scene = _scenes.scene_of(results, "gap")
        axes = figures.strip(results, strategy="skeleton")
        self.assertEqual(len(axes), 6)
        path = np.array(results.runs("gap", "skeleton")[0]["path"])
        ends = [line.get_xydata() for line in axes[-1].get_lines() if len(line.get_xdata()) > 50]
        self.assertTrue(np.allclose(ends[0][0], scene.robot.tip(path[:1])[0]))
        self.assertTrue(np.allclose(ends[0][-1], scene.robot.tip(path[-1:])[0]))
        texts = [ax.texts[0].get_text() for ax in axes]
        self.assertEqual(texts, ["start", "20 % of the path", "40 %", "60 %", "80 %", "100 %"])

    def test_sizes_of_worlds(self):
        sizes = {("plane", "world"): 86, ("plane", "levels_of_world"): 178, ("plane", "strip"): 178,
                 ("team", "schedule"): 86, ("space", "world"): 86}
        for (name, drawn), width in sizes.items():
            found = listed(getattr(figures, drawn)(DOCUMENTS[name]))[0].figure.get_size_inches() * MM
            self.assertAlmostEqual(found[0], width, places=6)
            self.assertLess(found[1], 120)
        height = figures.schedule(DOCUMENTS["team"])[0].figure.get_size_inches()[1] * MM
        self.assertAlmostEqual(height, 40, places=6)

    def test_files_of_worlds(self):
        with tempfile.TemporaryDirectory() as folder:
            written = figures.save(DOCUMENTS["team"], folder, ["png"], texts=[])
            self.assertEqual([path.name for path in written][-4:], [
                "world-a_b_c.png", "levels_of_world-a_b_c-prioritise.png", "strip-a_b_c.png", "schedule-a_b_c.png"])


class Geometry(unittest.TestCase):
    def test_packed_numbers(self):
        values = [0, 1, 127, 128, 300, 16383, 16384, 2**31 + 5]
        self.assertEqual(list(_scenes.varints(varint(values))), values)
        self.assertEqual(list(_scenes.signed(np.arange(5))), [0, -1, 1, -2, 2])
        self.assertEqual(len(_scenes.varints("")), 0)

    def test_the_outline_of_touching_obstacles_has_no_seam(self):
        boxes = [[0, 0, 1, 0, 1, 2, 0, 2], [1, 0, 3, 0, 3, 1, 1, 1], [0.2, 0.2, 0.4, 0.2, 0.4, 0.4, 0.2, 0.4]]
        segments = _plane.outline(_plane.rings_of(boxes, 10), 10)
        lengths = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
        self.assertAlmostEqual(lengths.sum(), 3 + 1 + 2 + 1 + 1 + 2, places=6)
        middle = segments.mean(1)
        self.assertFalse(((np.abs(middle[:, 0] - 1) < 1e-9) & (middle[:, 1] < 1)).any())
        # A disc that a box covers by half.
        rings = _plane.rings_of([[0, 0, 4, 0, 4, 4, 0, 4], [4, 2, 1]], 10)
        segments = _plane.outline(rings, 10)
        lengths = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
        self.assertAlmostEqual(lengths.sum(), 16 - 2 + math.pi, delta=0.01)

    def test_the_depth_buffer_is_exact_visibility(self):
        """Points and triangles at random: which triangles cover a point is computed one by one."""
        draw = np.random.RandomState(3)
        corners = draw.uniform(0, 1, (12, 3, 3))
        buffer = _space.DepthBuffer(np.zeros(2), 1.0, 400)
        buffer.add(corners[:5])
        buffer.add(corners[5:])
        points = draw.uniform(0, 1, (4000, 3))
        visible = np.ones(len(points), bool)
        clear = np.ones(len(points), bool)
        for a, b, c in corners:
            area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
            weights = []
            for p, q in ((b, c), (c, a), (a, b)):
                cross = (q[0] - p[0]) * (points[:, 1] - p[1]) - (q[1] - p[1]) * (points[:, 0] - p[0])
                weights.append(cross / area)
                clear &= np.abs(cross) / np.hypot(*(q - p)[:2]) > 2 / 400
            inside = np.min(weights, axis=0) > 0
            z = weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]
            visible &= ~(inside & (z > points[:, 2]))
            clear &= ~inside | (np.abs(z - points[:, 2]) > 1e-3)
        self.assertGreater(clear.sum(), 2000)
        self.assertTrue(0.2 < visible[clear].mean() < 0.9)
        self.assertTrue((buffer.seen(points) == visible)[clear].all())

    def test_lines_end_where_a_triangle_hides_them(self):
        buffer = _space.DepthBuffer(np.zeros(2), 1.0, 500)
        buffer.add([[[0.3, 0.1, 0.5], [0.7, 0.1, 0.5], [0.5, 0.9, 0.5]]])
        seen, hidden = buffer.split([[[0.1, 0.5, 0.2], [0.9, 0.5, 0.2]], [[0.1, 0.5, 0.7], [0.9, 0.5, 0.7]]])
        self.assertEqual(len(hidden), 1)
        self.assertTrue(np.allclose(np.sort(hidden[0, :, 0]), [0.4, 0.6], atol=2 / 500))
        lengths = np.linalg.norm(seen[:, 1] - seen[:, 0], axis=1)
        self.assertAlmostEqual(lengths.sum(), 1.6 - 0.2, delta=4 / 500)

    def test_the_tip_of_an_arm(self):
        robot = _scenes.scene_of(figures.read(DOCUMENTS["arm"]), "gap").robot
        for q in ([0, 0, 0], [0.3, -1, 2], [3, 0.5, -0.5]):
            tip = 5 + 1j + sum(1.5 * np.exp(1j * angle) for angle in np.cumsum(q))
            self.assertTrue(np.allclose(robot.tip(np.array([q], float))[0], [tip.real, tip.imag]))

    def test_robots_of_links_and_joints(self):
        """Every kind of joint, by matrices."""
        corners, triangles = box_of((0, 0, 0), (1, 1, 1))
        import base64
        count = 7
        surfaces = {"vertices": base64.b64encode(np.tile(corners, (count, 1)).astype("<f4").tobytes()).decode(),
                    "parts": varint([8, 12, 0, 1] * count), "triangles": varint(list(triangles.ravel()) * count),
                    "edges": ""}
        half = math.sqrt(0.5)
        still, tilted = [0.1, 0.2, 0.3, 0, 0, 0, 1], [0.5, 0, 0.1, 0, half, 0, half]
        joints = [("fixed", still, (1, 0, 0), -1, 1, 0), ("floating", still, (1, 0, 0), 0, 1, 0),
                  ("planar", tilted, (0, 0, 1), 7, 1, 0), ("prismatic", still, (0, 1, 0), 10, 1, 0.2),
                  ("revolute", tilted, (0, 0, 1), 11, 1, 0), ("continuous", still, (1, 0, 0), 11, -2, 0.1),
                  ("sliding in a plane", still, (0, 0, 1), 12, 1, 0)]
        raw = {"kind": "tree", "dimension": 14, "radius": 1, "base": [1, 2, 3, 0, 0, half, half], "surfaces": surfaces,
               "bodies": [{"parent": max(0, i - 1), "origin": origin, "kind": kind, "axis": list(axis), "column": column,
                           "multiplier": multiplier, "offset": offset}
                          for i, (kind, origin, axis, column, multiplier, offset) in enumerate(joints)],
               "tip": [6, 0.1, 0.2, 0.3], "tips": [[6, 0.1, 0.2, 0.3]]}
        robot = _scenes.robot_of(raw)

        def matrix(x, y, z, qx, qy, qz, qw):
            m = np.eye(4)
            m[:3, :3] = [[1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qz * qw), 2 * (qx * qz + qy * qw)],
                         [2 * (qx * qy + qz * qw), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qx * qw)],
                         [2 * (qx * qz - qy * qw), 2 * (qy * qz + qx * qw), 1 - 2 * (qx * qx + qy * qy)]]
            m[:3, 3] = x, y, z
            return m

        def turn(axis, angle):
            return matrix(0, 0, 0, *(math.sin(angle / 2) * np.array(axis)), math.cos(angle / 2))

        draw = np.random.RandomState(1)
        for _ in range(5):
            q = draw.uniform(-1, 1, 14)
            q[3:7] /= np.linalg.norm(q[3:7])
            # Across z the planner's first direction is x, the second y.
            moves = [matrix(*q[:7]), matrix(q[7], q[8], 0, 0, 0, 0, 1) @ turn((0, 0, 1), q[9]),
                     matrix(0, q[10] + 0.2, 0, 0, 0, 0, 1), turn((0, 0, 1), q[11]), turn((1, 0, 0), 0.1 - 2 * q[11]),
                     matrix(q[12], q[13], 0, 0, 0, 0, 1)]
            frame = matrix(*raw["base"])
            for (_, origin, *_), move in zip(joints[1:], moves):
                frame = frame @ matrix(*origin) @ move
            expected = (frame @ [0.1, 0.2, 0.3, 1])[:3]
            self.assertTrue(np.allclose(robot.tip(q[None])[0], expected))
            placed = robot.placed(q).surfaces.vertices[-8:]
            self.assertTrue(np.allclose(placed, corners @ frame[:3, :3].T + frame[:3, 3]))

    def test_straight_motions_take_the_short_way(self):
        space = _scenes.Space([["x", 0, 10, 0, 1], ["theta", -math.pi, math.pi, 1, 0.5]])
        a, b = np.array([[1.0, 3.0]]), np.array([[3.0, -3.0]])
        middle = space.between(a, b, np.array([0.5]))[0]
        self.assertAlmostEqual(abs(space.difference(np.array([0, math.pi]), middle)[1]), 0, places=9)
        self.assertAlmostEqual(space.distances(a, b)[0], math.hypot(2, 0.5 * (2 * math.pi - 6)))
        turns = _scenes.Space([[name, -1, 1, 0, 1] for name in "xyzw"], [0])
        half = turns.between(np.array([[0, 0, 0, 1.0]]), np.array([[0, 0, -1.0, 0]]), np.array([0.5]))[0]
        self.assertTrue(np.allclose(np.abs(half), [0, 0, math.sqrt(0.5), math.sqrt(0.5)]))

    def test_distances_of_bodies(self):
        draw = np.random.RandomState(2)
        # Boxes along the axes: the distance is known.
        lo = draw.uniform(-2, 2, (200, 2, 3))
        size = draw.uniform(0.1, 1.5, (200, 2, 3))
        unit = np.array([[i >> k & 1 for k in range(3)] for i in range(8)])
        first, second = (lo[:, k, None] + unit * size[:, k, None] for k in (0, 1))
        gap = np.maximum(0, np.maximum(lo[:, 0] - lo[:, 1] - size[:, 1], lo[:, 1] - lo[:, 0] - size[:, 0]))
        self.assertTrue(np.allclose(_teams.distances(first, second), np.linalg.norm(gap, axis=1), atol=1e-7))
        self.assertTrue(0 < (gap == 0).all(1).sum() < 200)
        # Turned segments of the plane: by their points.
        ends = draw.uniform(-1, 1, (50, 4, 3)) * [1, 1, 0]
        share = np.linspace(0, 1, 401)[:, None]
        for row in ends:
            p, q = (row[k] + share * (row[k + 1] - row[k]) for k in (0, 2))
            expected = np.linalg.norm(p[:, None] - q[None], axis=2).min()
            self.assertAlmostEqual(_teams.distances(row[None, :2], row[None, 2:])[0], expected, delta=0.006)


class Schedules(unittest.TestCase):
    def test_lanes_and_gaps(self):
        results = figures.read(DOCUMENTS["team"])
        scene = _scenes.scene_of(results, "a/b c")
        run = next(run for run in results.runs("a/b c", "prioritise") if run["solved"])
        lanes, low = figures.schedule(results, strategy="prioritise")
        at, path = np.array(run["times"]["at"]), np.array(run["path"])
        self.assertEqual([text.get_text() for text in lanes.get_yticklabels()], ["robot 1", "robot 2"])
        # The area of a lane is the way of its robot, in units of the fastest.
        ways = [scene.space.distances(path[:-1], path[1:], member.columns).sum() for member in scene.team]
        areas = []
        for lane in lanes.collections:
            x, y = lane.get_paths()[0].vertices.T
            areas.append(abs(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) / 2)
        self.assertAlmostEqual(areas[0] / areas[1], ways[0] / ways[1], places=6)
        curve = next(line for line in low.get_lines() if len(line.get_xdata()) > 2)
        x, y = curve.get_xdata(), curve.get_ydata()
        # The disc and the rectangle, by points of its boundary.
        rows = scene.space.along(path, at, x)
        edge = np.linspace(-1, 1, 401)
        ones = np.ones_like(edge)
        boundary = np.concatenate([np.stack(side, 1) for side in ((edge * 0.5, ones * 0.3), (edge * 0.5, -ones * 0.3),
                                                                  (ones * 0.5, edge * 0.3), (-ones * 0.5, edge * 0.3))])
        for q, gap in list(zip(rows, y))[::10]:
            c, s = math.cos(q[4]), math.sin(q[4])
            points = boundary @ np.array([[c, s], [-s, c]]) + q[2:4]
            self.assertAlmostEqual(gap, np.linalg.norm(points - q[:2], axis=1).min() - 0.5, delta=0.003)
        self.assertGreaterEqual(y.min(), 0)


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
        for name in ("one", "options", "plane", "team", "space"):
            here = self.saved(name, os.path.join(PLACE.name, f"{name}-a"), PYTHONHASHSEED="1", TZ="UTC", LC_ALL="C",
                              MPLBACKEND="agg", MATPLOTLIBRC="/nowhere")
            there = self.saved(name, os.path.join(PLACE.name, f"{name}-b"), PYTHONHASHSEED="2", TZ="Asia/Kathmandu",
                               LC_ALL=LOCALE, MPLBACKEND="template", MATPLOTLIBRC=str(settings),
                               SOURCE_DATE_EPOCH="0")
            self.assertEqual(list(here), list(there))
            self.assertEqual({file for file in here if here[file] != there[file]}, set())
            kinds = {"svg": b"<?xml", "pdf": b"%PDF", "png": b"\x89PNG"}
            for drawn in DRAWN[name]:
                files = [file for file in here if file.split(".")[0].split("-")[0] == drawn]
                self.assertTrue({file.split(".")[-1] for file in files} >= set(kinds), drawn)
                for file in files:
                    self.assertTrue(here[file].startswith(kinds.get(file.split(".")[-1], b"")), file)

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
            self.assertEqual(list(texts[form]), ["costs", "levels", "paired", "efficiency"])
        # All seeds together, as the document has them.
        efficiency = figures.tables(DOCUMENTS["one"])["efficiency"]
        self.assertEqual(set(efficiency.samples), {"nodes", "proposals"})
        for row in efficiency.itertuples():
            self.assertAlmostEqual(row.mass + row.spread, row.SE, places=5)
            self.assertTrue(row.SE_lo <= row.SE <= row.SE_hi)
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

    def test_frames(self):
        document = json.loads(pathlib.Path(DOCUMENTS["one"]).read_text(encoding="utf-8"))
        runs, levels = (figures.frame(DOCUMENTS["one"], name) for name in ("runs", "levels"))
        self.assertEqual(len(runs), len(document["runs"]))
        self.assertEqual(len(levels), document["levels"]["rows"])
        # The levels of a run say what the run spent.
        spent = levels.groupby(["problem", "strategy", "seed"])["validity_checks"].sum()
        for run in document["runs"]:
            self.assertLessEqual(spent[run["problem"], run["strategy"], run["seed"]], run["validity_checks"])
        self.assertIn("SE", figures.frame(DOCUMENTS["one"], "measure").columns)
        self.assertEqual(set(figures.frame(DOCUMENTS["one"], "setups").columns) - {"set_up_work", "queries"},
                         {"problem", "strategy", "set_up_s", "shared_set_up_s"})
        with self.assertRaisesRegex(figures.Error, "there is no table 'level'.*did you mean 'levels'"):
            figures.frame(DOCUMENTS["one"], "level")


if __name__ == "__main__":
    unittest.main()

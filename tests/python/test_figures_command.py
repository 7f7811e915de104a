# SPDX-License-Identifier: GPL-3.0-or-later
"""python3 -m trellis.figures, documents that are joined, and those without runs. Environment: PYTHONPATH has the
package, TRELLIS the program. Exits with 77, which ctest reports as skipped, without matplotlib or pandas."""
import contextlib
import copy
import importlib.util
import io
import json
import math
import os
import pathlib
import re
import statistics
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

from trellis import figures
from trellis.columns import rows
from trellis.figures import __main__ as main
from trellis.figures import _compare, _paths, _scenes, _statistics

from test_figures import faults_of, listed

PROGRAM = os.environ["TRELLIS"]
SCRIPTS = {
    # Scores, compositions beside their parts, runs without a path.
    "scored": """
local p = rrt { step = 0.5, proposals = 3000 }
return experiment { problems = { scenes.trap(), worlds.bug_trap() }, baseline = "rrt", seeds = 8,
  measure = tube { delta = 0.5 }, ablation = 1,
  strategies = { rrt = p, skeleton = skeleton() >> p, shrink = shrink(0.5) >> p,
                 both = skeleton() >> shrink(0.5) >> p } }""",
    # Paths that get shorter, and planners that do not improve theirs.
    "anytime": """
return experiment { problems = { scenes.trap() }, baseline = "rrt", seeds = 6, measure = false, ablation = 0,
  strategies = { rrt = rrt { step = 0.5 }, rrt_star = rrt_star { step = 0.5, proposals = 1500 },
                 informed = informed() >> rrt_star { step = 0.5, proposals = 1500 } } }""",
    # The planner that guides have is not the baseline.
    "planners": """
local p = rrt { step = 0.5 }
return experiment { problems = { scenes.trap(), scenes.simple_passage(), scenes.cup() }, baseline = "rrt_connect",
  seeds = 5, measure = false, ablation = 0,
  strategies = { rrt_connect = rrt_connect { step = 0.5 }, rrt = p, skeleton = skeleton() >> p,
                 lazy = lazy() >> p, nested = skeleton() >> lazy() >> p } }""",
    "space": """
return experiment { problems = { problem { name = "slot", robot = robot.rigid { box {-0.8, -0.5, -0.1, 0.8, 0.5, 0.1} },
    world = world { bounds = {0, 0, -2, 10, 10, 10}, box {4, 0, 0, 6, 10, 3}, box {4, 0, 7, 6, 10, 10} },
    start = pose {1, 5, 5}, goal = pose {9, 5, 5, axis = {1, 0, 0}, angle = 1} } },
  strategies = { workspace = workspace() >> rrt_connect { step = 1 } }, seeds = 1, measure = false, ablation = 0 }""",
    "arm": """
return experiment { problems = { problem { name = "gap", start = { 0.3, 0.2, 0.1 }, goal = { 2.8, -0.3, 0.2 },
    robot = robot.arm { links = {1.5, 1.5, 1.5}, base = {5, 1} },
    world = world { bounds = {0, 0, 10, 10}, box {4.5, 3, 5.5, 6}, box {0, 8, 5, 9}, box {5, 8, 10, 9} } } },
  strategies = { rrt_connect = rrt_connect { step = 0.3 } }, seeds = 1, measure = false, ablation = 0 }""",
}
WITH_SAMPLES = ("scored", "space")
# The runs of "scored" in two documents.
PARTS = (["--seeds", "3"], ["--seed", "4", "--seeds", "5"])


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


    for k, seeds in enumerate(PARTS):
        subprocess.run([PROGRAM, "run", str(pathlib.Path(PLACE.name, "scored.lua")), *seeds, "--quiet", "--json",
                        str(pathlib.Path(PLACE.name, f"part-{k}.json")), "--samples",
                        str(pathlib.Path(PLACE.name, f"part-{k}-samples"))], check=True, stderr=subprocess.DEVNULL)


def tearDownModule():
    PLACE.cleanup()


def content_of(name):
    with open(DOCUMENTS[name], encoding="utf-8") as file:
        return json.load(file)


def written(content, name):
    path = pathlib.Path(PLACE.name, name)
    path.write_text(json.dumps(content), encoding="utf-8")
    return str(path)


def halves(name, keep):
    """The document's runs in two files: those for which `keep` is true, and the others."""
    files = []
    for k, wanted in enumerate((True, False)):
        content = content_of(name)
        content["runs"] = [run for run in content["runs"] if keep(run) is wanted]
        content["experiment"]["seeds"] = sorted({run["seed"] for run in content["runs"]})
        files.append(written(content, f"{name}-part-{k}.json"))
    return files


def parts_of():
    return [str(pathlib.Path(PLACE.name, f"part-{k}.json")) for k in range(len(PARTS))]


class Joined(unittest.TestCase):
    def test_halves_are_the_whole(self):
        whole = figures.read(DOCUMENTS["scored"])
        joined = figures.read(parts_of())
        self.assertEqual((joined.problems, joined.strategies, joined.baseline),
                         (whole.problems, whole.strategies, whole.baseline))
        for problem in [*whole.problems, None]:
            for name in whole.strategies:
                for cost in ("validity_checks", "motion_checks"):
                    for end in ("value", "lo", "hi"):
                        a, b = (getattr(one.median(problem, name, cost), end) for one in (whole, joined))
                        self.assertTrue(a == b or math.isclose(a, b), (problem, name, cost, end, a, b))
                for end in ("value", "lo", "hi"):
                    a, b = (getattr(one.ratio(problem, name), end) for one in (whole, joined))
                    self.assertTrue(a == b or math.isclose(a, b) or name == "rrt", (problem, name, end, a, b))
                if name != "rrt":
                    a, b = (one.comparison(problem, name)["holm_p"] for one in (whole, joined))
                    self.assertAlmostEqual(a, b, places=12)
        # Figures of levels and of the measure are of one document.
        self.assertEqual(figures.supported(joined), ["costs", "success", "ratios", "correlation", "profile", "world",
                                                     "levels_of_world", "strip"])
        self.assertEqual({text.get_text() for text in figures.costs(joined)[0].texts},
                         {text.get_text() for text in figures.costs(whole)[0].texts})

    def test_they_are_those_of_the_program(self):
        """The median ratio of each strategy over the problems, and the rank correlations."""
        parts = parts_of()
        found = figures.tables(parts)
        rows = [row for row in found["paired"].to_dict("records")
                if row["against"] == "baseline" and row["quantity"] == "validity_checks"]
        text = subprocess.run([PROGRAM, "report", *parts, "--report", "costs", "--width", "200"], check=True,
                              stdout=subprocess.PIPE, text=True).stdout
        for name in {row["strategy"] for row in rows}:
            some = [row for row in rows if row["strategy"] == name]
            printed = re.search(rf"^{re.escape(name)}\s+(\S+)\s+(\S+)\s+(\S+)\s", text, re.MULTILINE)
            self.assertEqual(printed[1], f"{sum(row['solved'] for row in some)}/{sum(row['runs'] for row in some)}")
            for cell, value in ((printed[2], statistics.median(row["paired_ratio"] for row in some)),
                                (printed[3], max(row["paired_ratio"] for row in some))):
                self.assertTrue(math.isclose(float(cell), value, rel_tol=0.06), (name, cell, value))
        lines = text[text.index("\nnats above uniform"):].strip().splitlines()[-len(found["correlation"]):]
        printed = [re.split(r"\s{2,}", line.strip()) for line in lines]
        self.assertEqual([row[:2] for row in printed],
                         [[row["nats"], f"{row['nodes']:+.2f}"] for row in found["correlation"].to_dict("records")])
        # The halves have the costs of the whole; a baseline may be named.
        whole = figures.tables(DOCUMENTS["scored"])["paired"]
        self.assertEqual(list(map(repr, rows)), [
            repr(row) for row in whole.to_dict("records")
            if row["against"] == "baseline" and row["quantity"] == "validity_checks"])
        other = figures.tables(figures.read(DOCUMENTS["scored"], baseline="skeleton"))["paired"]
        self.assertEqual(set(other[other["against"] == "baseline"]["reference"]), {"skeleton"})

    def test_strategies_of_two_documents(self):
        parts = halves("scored", lambda run: run["strategy"] in ("rrt", "skeleton"))
        for path, names in zip(parts, (("rrt", "skeleton"), ("shrink", "both"))):
            content = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
            content["experiment"]["strategies"] = [one for one in content["experiment"]["strategies"]
                                                   if one["name"] in names]
            for key in ("summary", "comparisons"):
                content[key] = [one for one in content[key] if one["strategy"] in names]
            pathlib.Path(path).write_text(json.dumps(content), encoding="utf-8")
        whole, joined = figures.read(DOCUMENTS["scored"]), figures.read(parts)
        self.assertEqual(joined.strategies, whole.strategies)
        for name in whole.others:
            self.assertEqual(joined.ratio("trap", name).value, whole.ratio("trap", name).value)
        # A verdict is of one problem in one document.
        rows = [[row for row in figures.tables(one)["levels"].to_dict("records") if row["problem"] == "trap"]
                for one in (whole, joined)]
        self.assertEqual(rows[0], rows[1])

    def test_samples_of_several_documents(self):
        parts = parts_of()
        joined = figures.read(parts)
        for seed in (2, 7):
            run = next(run for run in joined.runs("trap", "both") if run["seed"] == seed)
            self.assertEqual(len(_scenes.levels_of(joined, run, _scenes.scene_of(joined, "trap"))), 3)
        with self.assertRaisesRegex(figures.Error, "samples are of one document"):
            figures.read(parts, samples=PLACE.name)

    def test_faults(self):
        parts = parts_of()
        other = content_of("scored")
        other["experiment"]["strategies"][0]["text"] = "rrt { step = 9 }"
        other["runs"] = [run for run in other["runs"] if run["seed"] > 3]
        name = other["experiment"]["strategies"][0]["name"]
        changed = written(other, "changed.json")
        for fault, call in {
            "seed 1 of '[a-z]*' on 'trap' is there twice": lambda: figures.read([parts[0], parts[0]]),
            f"'{name}' is rrt {{ step = 9 }} here and .* in another file; --by-name":
                lambda: figures.read([parts[0], changed]),
            r"there is no strategy 'skeletn' \(did you mean 'skeleton'\?\); there are: ":
                lambda: figures.read(parts, baseline="skeletn"),
            "name at least one document": lambda: figures.read([]),
        }.items():
            with self.subTest(fault), self.assertRaisesRegex(figures.Error, fault):
                call()
        self.assertEqual(len(figures.read([parts[0], changed], by_name=True).runs("trap", name)), 8)
        self.assertIs(figures.read([whole := figures.read(parts[0])]), whole)
        self.assertEqual(figures.read(parts[0], baseline="shrink").strategies[0], "shrink")


class References(unittest.TestCase):
    """Ratios beside other strategies than the baseline."""

    def test_ratios_are_those_of_the_tables(self):
        results = figures.read(DOCUMENTS["planners"])
        paired = figures.tables(results)["paired"]
        paired = paired[paired.quantity == "validity_checks"]
        for against, names in (("own_planner", {"skeleton", "lazy", "nested"}), ("best_part", {"nested"})):
            found = _compare.ratios_of(results, against)
            self.assertEqual({name for _, name in found.ratio}, names)
            for row in paired[paired.against == against].to_dict("records"):
                self.assertEqual(found.of(row["problem"], row["strategy"]).value, row["paired_ratio"])
                self.assertEqual(found.shown[row["problem"], row["strategy"]], row["holm_p"] < 0.05)
            for name in names:  # all seeds of all problems, each beside its reference there
                every = []
                for row in paired[(paired.against == against) & (paired.strategy == name)].to_dict("records"):
                    mine, theirs = (results.costs(row["problem"], one) for one in (name, row["reference"]))
                    every += list(mine / theirs)
                self.assertAlmostEqual(found.of(None, name).value, _statistics.median(every), places=12)

    def test_dots_of_problems(self):
        results = figures.read(DOCUMENTS["planners"])
        for against, names in (("baseline", results.others), ("own_planner", ["skeleton", "lazy", "nested"]),
                               ("best_part", ["nested"])):
            ax = figures.ratios(results, against=against, together=True)
            self.assertEqual(faults_of(ax.figure), [])
            labels = [text.get_text() for text in ax.get_yticklabels()]
            self.assertEqual(set(labels), set(names))
            found = _compare.ratios_of(results, against)
            light = [line for line in ax.get_lines() if line.get_alpha() == 0.4]
            self.assertEqual(len(light), 3 * len(names))
            drawn = {(round(float(line.get_ydata()[0])), round(float(line.get_xdata()[0]), 12)) for line in light}
            self.assertEqual(drawn, {(labels.index(name), round(found.of(problem, name).value, 12))
                                     for name in names for problem in results.problems})
        self.assertNotIn(0.4, [line.get_alpha() for line in figures.ratios(results).get_lines()])

    def test_ratios_of_cpu_time(self):
        results = figures.read(DOCUMENTS["planners"])
        paired = figures.tables(results)["paired"]
        paired = paired[paired.quantity == "cpu_s"]
        for against in _compare.AGAINST:
            found = _compare.ratios_of(results, against, "cpu_s")
            for row in paired[paired.against == against].to_dict("records"):
                self.assertEqual(found.of(row["problem"], row["strategy"]).value, row["paired_ratio"])
        ax = figures.ratios(results, cost="cpu_s", together=True)
        self.assertEqual(faults_of(ax.figure), [])
        self.assertEqual(ax.get_xlabel(), "CPU time ÷ that of rrt_connect, same seeds")

    def test_strategies_tuned_on_a_problem_have_rings(self):
        content = content_of("planners")
        content["experiment"]["problems"][0].update(group="own", tuned=True)
        ax = figures.ratios(content, together=True)
        light = [line for line in ax.get_lines() if line.get_alpha() == 0.4]
        self.assertEqual(sum(line.get_markerfacecolor() == "none" for line in light), 4)
        self.assertEqual(len(light), 12)

    def test_faults(self):
        for fault, call in {
            "there is no cost 'time_s'; there are: validity_checks, cpu_s":
                lambda: figures.ratios(DOCUMENTS["planners"], cost="time_s"),
            "there is no reference 'part'; there are: baseline, own_planner, best_part":
                lambda: figures.ratios(DOCUMENTS["planners"], against="part"),
            "ratios beside best_part need a strategy with two guides":
                lambda: figures.ratios(DOCUMENTS["anytime"], against="best_part"),
        }.items():
            with self.subTest(fault), self.assertRaisesRegex(figures.Error, fault):
                call()


class Paths(unittest.TestCase):
    def test_lengths(self):
        results = figures.read(DOCUMENTS["anytime"])
        self.assertEqual(set(_paths.anytime(results)), {"rrt_star", "informed"})
        ax = figures.length(results)
        self.assertEqual(faults_of(ax.figure), [])
        self.assertEqual(len(ax.collections), 2)  # bands of two strategies
        lines = ax.get_lines()
        self.assertEqual(len(lines), 2)
        ends = set()
        for name in ("rrt_star", "informed"):
            curve = _paths.length_curve(results, "trap", name)
            runs = results.runs("trap", name)
            self.assertLessEqual(len(curve.at), 200)
            for at, found in list(zip(curve.at, curve.length))[::20]:
                known = [min((one["length"] for one in run["improvements"] if one["checks"] <= at), default=math.inf)
                         for run in runs]
                self.assertEqual(found.value, _statistics.median(known))
            ends.add(_statistics.median([([math.inf] + [one["length"] for one in run["improvements"]])[-1]
                                         for run in runs]))
            self.assertEqual(curve.spent, max(run["validity_checks"] for run in runs))
        self.assertEqual({line.get_ydata()[-1] for line in lines}, ends)
        self.assertEqual(figures.length(results, cost="cpu_s").get_xlabel(), "CPU time, ms")
        with self.assertRaisesRegex(figures.Error, "no strategy improves its path"):
            figures.length(DOCUMENTS["planners"])

    def test_profiles(self):
        results = figures.read(DOCUMENTS["scored"])
        self.assertEqual(_paths.profiled(results), ["trap", "bug_trap"])
        found = _paths.profile_of(results, "trap", "rrt", "tree")
        self.assertAlmostEqual(sum(part.value for part in found.samples), 1, 3)  # of ten thousandths
        self.assertAlmostEqual(sum(found.target), 1, 3)
        # Runs in as many parts: means and Student's interval of them.
        content = content_of("scored")
        shares = ([0.1, 0.2, 0.3, 0.4], [0.4, 0.3, 0.2, 0.1], [0.25] * 4, [0.2, 0.2, 0.2, 0.4], [0.1, 0.1, 0.4, 0.4])
        chosen = [i for i, run in enumerate(content["runs"]) if run["problem"] == "trap" and run["strategy"] == "rrt"][:5]
        content["runs"] = [content["runs"][i] for i in chosen]
        its = [row for row in rows(content["measure"]) if row["run"] in chosen and row["level"] == 0
               and (row["space"], row["path"], row["role"]) == ("root", "self", "tree")]
        for row, samples in zip(its, shares):
            row.update({"run": chosen.index(row["run"]), "along.target": [2500] * 4,
                        "along.samples": [round(1e4 * share) for share in samples]})
        content["measure"] = {"rows": len(its), **{key: [row[key] for row in its] for key in its[0]}}
        found = _paths.profile_of(figures.read(content), "trap", "rrt", "tree")
        for k, part in enumerate(found.samples):
            column = [its[k] for its in shares]
            half = 2.7764451051977987 * np.std(column, ddof=1) / math.sqrt(5)
            self.assertAlmostEqual(part.value, np.mean(column))
            self.assertAlmostEqual(part.hi - part.lo, 2 * half)
        # Eight parts beside four become four, as the smaller number is the median.
        self.assertEqual([round(x, 12) for x in _paths._spread([0.1, 0.2, 0.3, 0.4, 0, 0, 0, 0], 4)], [0.3, 0.7, 0, 0])
        self.assertEqual([round(x, 12) for x in _paths._spread([0.6, 0.4], 3)], [0.4, 1 / 3 + 0, 0.266666666667][:1]
                         + [round(0.2 + 0.4 / 3, 12), round(0.8 / 3, 12)])
        axes = figures.profile(results, problem="trap")
        self.assertEqual(faults_of(axes[0].figure), [])
        titles = [ax.get_title(loc="left") for ax in axes]
        self.assertEqual(titles[:2], ["rrt: nodes", "rrt: proposals"])
        place = {key: results.pooled("trap", "rrt")["tree"][f"bottleneck.{key}"] for key in ("at", "length")}
        marks = [line for line in axes[0].get_lines() if line.get_marker() == "^" and line.get_ydata()[0] == 0]
        self.assertAlmostEqual(marks[0].get_xdata()[0], 100 * place["at"] / place["length"])
        self.assertIn(f"thinnest at {place['at']:.3g} m"[:16], axes[0].texts[0].get_text())
        with self.assertRaisesRegex(figures.Error, "no run has scores along its path"):
            figures.profile(DOCUMENTS["planners"])


def bare(name):
    """A document of the worlds alone."""
    content = content_of(name)
    problem = content["experiment"]["problems"][0]
    return {"trellis": content["trellis"], "experiment": {"problems": [problem], "strategies": [], "seeds": []},
            "worlds": content["worlds"], "robots": content["robots"],
            "scenes": [one for one in content["scenes"] if one["problem"] == problem["name"]], "runs": []}


class WorldsAlone(unittest.TestCase):
    def test_the_plane(self):
        for name in ("scored", "arm"):
            content = bare(name)
            self.assertEqual(figures.supported(content), ["world"])
            ax = figures.world(content)
            self.assertEqual(faults_of(ax.figure), [])
            self.assertEqual(ax.get_xlabel(), "x, m")
            lo_x, lo_y, hi_x, hi_y = content["worlds"][0]["bounds"]
            self.assertEqual((ax.get_xlim(), ax.get_ylim()), ((lo_x, hi_x), (lo_y, hi_y)))
        scene = _scenes.scene_of(figures.read(content), "gap")
        marks = [tuple(line.get_xydata()[0]) for line in ax.get_lines() if line.get_marker() == "o"]
        expected = [tuple(scene.robot.tip(np.array([q]))[0]) for q in (scene.goals[0], scene.start)]
        self.assertTrue(np.allclose(marks, expected))
        # The robot's outline at the goal is filled, that at the start white.
        faces = {matplotlib.colors.to_hex(patch.get_facecolor()) for patch in ax.findobj(matplotlib.patches.PathPatch)
                 if patch.get_fill()}
        self.assertTrue({"#ffffff", "#0072b2"} <= faces, faces)

    def test_space(self):
        ax = figures.world(bare("space"))
        self.assertEqual(faults_of(ax.figure), [])
        texts = {text.get_text() for text in ax.texts}
        self.assertEqual(texts, {"slot", "x 0 – 10 m", "y 0 – 10 m", "z −2 – 10 m"})
        without = bare("space")
        without["experiment"]["problems"][0].update(start=None, goal=None)
        without["scenes"][0].update(robot=None)
        self.assertEqual([line for line in figures.world(without).get_lines() if line.get_marker() == "o"], [])

    def test_a_camera(self):
        results = figures.read(DOCUMENTS["space"])
        seen = [figures.svg(figures.world(results, **view))
                for view in ({}, {"azimuth": 20}, {"azimuth": 20, "elevation": 70})]
        self.assertEqual(len(set(seen)), 3)
        old = _scenes.scene_of(results, "slot").world["view"]
        self.assertEqual(figures.svg(figures.world(results, azimuth=old[0], elevation=old[1])), seen[0])
        self.assertEqual(figures.svg(figures.world(results)), seen[0])

    def test_a_level(self):
        results = figures.read(DOCUMENTS["scored"])
        whole = figures.levels_of_world(results, problem="trap", strategy="both")
        for number, expected in enumerate(reversed(list(whole))):
            ax = figures.world(results, problem="trap", strategies=["both"], level=number)
            self.assertEqual(faults_of(ax.figure), [])
            self.assertEqual([text.get_text() for text in ax.texts], [text.get_text() for text in expected.texts])
        # One run, as of a session: without summary, comparisons, baseline and seeds.
        content = content_of("scored")
        least = {key: content[key] for key in ("trellis", "worlds", "robots", "scenes", "samples")}
        chosen = next(i for i, run in enumerate(content["runs"])
                      if run["strategy"] == "both" and run["problem"] == "trap")
        least["runs"] = [content["runs"][chosen]]
        for name in ("levels", "measure"):
            its = [{**row, "run": 0} for row in rows(content[name]) if row["run"] == chosen]
            least[name] = {"rows": len(its), **{key: [row[key] for row in its] for key in its[0]}}
        least["experiment"] = {"problems": content["experiment"]["problems"][:1], "strategies": [
            {key: one[key] for key in ("name", "text", "guided")} for one in content["experiment"]["strategies"]
            if one["name"] == "both"]}
        session = figures.read(written(least, "session.json"))
        ax = figures.world(session, level=2)
        self.assertEqual([text.get_text() for text in ax.texts], [text.get_text() for text in list(whole)[0].texts])
        self.assertEqual(figures.supported(session),
                         ["costs", "success", "profile", "world", "levels_of_world", "strip"])
        for fault, call in {
            "'both' has no level 3; there are: 0 root, 1 shrink.0.5., 2 skeleton..":
                lambda: figures.world(results, problem="trap", strategies=["both"], level=3),
            "a level is drawn of one strategy, got 2":
                lambda: figures.world(results, strategies=["both", "rrt"], level=1),
            "there are no samples": lambda: figures.world(DOCUMENTS["planners"], level=0),
            "there is no strategy": lambda: figures.strip(bare("scored")),
        }.items():
            with self.subTest(fault), self.assertRaisesRegex(figures.Error, fault):
                call()


def fault_of(*arguments):
    """The status and the line of the command, which writes nothing else; without a process."""
    stderr, stdout = io.StringIO(), io.StringIO()
    here = os.getcwd()
    os.chdir(PLACE.name)
    try:
        with contextlib.redirect_stderr(stderr), contextlib.redirect_stdout(stdout):
            main.main([str(one) for one in arguments])
    except SystemExit as ended:
        return ended.code, stdout.getvalue(), stderr.getvalue()
    finally:
        os.chdir(here)
    return 0, stdout.getvalue(), stderr.getvalue()


def command(*arguments, **environment):
    return subprocess.run([sys.executable, "-B", "-m", "trellis.figures", *map(str, arguments)], cwd=PLACE.name,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False,
                          env={**os.environ, **environment})


class Command(unittest.TestCase):
    def test_files_are_those_of_save(self):
        folder = pathlib.Path(PLACE.name, "saved")
        expected = [path.name for path in figures.save(DOCUMENTS["scored"], folder)]
        found = command("scored.json", "--out", "of the command")
        self.assertEqual((found.returncode, found.stderr), (0, ""))
        self.assertEqual(found.stdout.splitlines(), [f"of the command/{name}" for name in expected])
        place = pathlib.Path(PLACE.name, "of the command")
        self.assertEqual(sorted(path.name for path in place.iterdir()), sorted(expected))
        for name in expected:
            self.assertEqual((place / name).read_bytes(), (folder / name).read_bytes(), name)
        self.assertTrue({"costs.svg", "ratios-best_part.pdf", "profile-trap.png", "world-bug_trap.svg", "paired.tex",
                         "levels_of_world-trap-both.pdf"} <= set(expected), expected)

    def test_one_figure(self):
        found = command("planners.json", "--out", "one", "--figure", "ratios", "--figure", "world", "--format", "svg")
        self.assertEqual(found.stdout.splitlines(), [f"one/{name}.svg" for name in (
            "ratios", "ratios-own_planner", "ratios-best_part", "world-trap", "world-simple_passage", "world-cup")])
        # None of the files is left where a figure cannot be drawn.
        found = command("planners.json", "--out", "none", "--figure", "ratios", "--figure", "length")
        self.assertEqual((found.returncode, found.stdout), (1, ""))
        self.assertFalse(pathlib.Path(PLACE.name, "none").exists())

    def test_pictures(self):
        for name, options in {"a.svg": ["--level", "1", "--problem", "trap", "--strategy", "both", "--seed", "2"],
                              "b.png": [], "c.PDF": ["--strategy", "rrt"]}.items():
            found = command("scored.json", "--figure", "world", "--file", name, *options)
            self.assertEqual((found.returncode, found.stdout, found.stderr), (0, f"{name}\n", ""))
        text = pathlib.Path(PLACE.name, "a.svg").read_text(encoding="utf-8")
        ax = figures.world(DOCUMENTS["scored"], problem="trap", strategies=["both"], level=1, seed=2)
        self.assertEqual(text[text.index("<svg"):], figures.svg(ax))
        found = command("space.json", "--figure", "world", "--file", "d.svg", "--azimuth", "20", "--elevation", "70")
        text = pathlib.Path(PLACE.name, "d.svg").read_text(encoding="utf-8")
        ax = figures.world(DOCUMENTS["space"], azimuth=20, elevation=70)
        self.assertEqual(text[text.index("<svg"):], figures.svg(ax))
        found = command(written(bare("arm"), "alone.json"), "--figure", "world", "--file", "e.png")
        self.assertEqual(found.returncode, 0, found.stderr)

    def test_joined_documents(self):
        parts = halves("planners", lambda run: run["seed"] <= 2)
        found = command(*parts, "--out", "both", "--figure", "costs", "--baseline", "rrt", "--format", "svg")
        self.assertEqual((found.returncode, found.stdout), (0, "both/costs.svg\n"), found.stderr)
        text = pathlib.Path(PLACE.name, "both", "costs.svg").read_text(encoding="utf-8")
        self.assertEqual(text[text.index("<svg"):], figures.svg(figures.costs(figures.read(parts, baseline="rrt"))))

    def test_faults_are_one_line(self):
        written({"trellis": {"format": 5}, "experiment": {}}, "empty.json")
        written([1, 2], "list.json")
        pathlib.Path(PLACE.name, "text.json").write_text("no JSON", encoding="utf-8")
        pathlib.Path(PLACE.name, "a file").write_text("", encoding="utf-8")
        for status, fault, arguments in (
            (2, "the following arguments are required: DOCUMENT", []),
            (2, "name a folder with --out, or a picture with --file", ["planners.json"]),
            (2, "name a folder with --out, or a picture with --file",
             ["planners.json", "--out", "x", "--file", "x.svg"]),
            (2, "unrecognized arguments: --colour", ["planners.json", "--out", "x", "--colour"]),
            (2, "there is no figure 'cost' (did you mean 'costs'?); there are: costs, success, length, ratios, levels, "
                "waterfall, correlation, scales, profile, world, levels_of_world, strip, schedule",
             ["planners.json", "--out", "x", "--figure", "cost"]),
            (2, "--format: there is no format 'gif'; there are: svg, pdf, png",
             ["planners.json", "--out", "x", "--format", "svg,gif"]),
            (2, "--file needs one --figure", ["planners.json", "--file", "x.svg"]),
            (2, "--level is of --figure world", ["planners.json", "--out", "x", "--level", "1"]),
            (2, "--seed needs --file", ["planners.json", "--out", "x", "--seed", "1"]),
            (2, "argument --level: invalid int value: 'one'", ["planners.json", "--out", "x", "--level", "one"]),
            (1, "none.json: No such file or directory", ["none.json", "--out", "x"]),
            (1, "text.json: this is no JSON document (Expecting value: line 1 column 1 (char 0))",
             ["text.json", "--out", "x"]),
            (1, "list.json: this is no document of `trellis run --json`", ["list.json", "--out", "x"]),
            (1, "empty.json: the document is damaged or incomplete (KeyError: 'problems')",
             ["empty.json", "--out", "x"]),
            (1, "planners.json: no run of a team has a path with times",
             ["planners.json", "--out", "x", "--figure", "schedule"]),
            (1, "planners.json: no strategy improves its path, as rrt_star does",
             ["planners.json", "--out", "x", "--figure", "length"]),
            (1, "planners.json: no run has scores along its path; run it with a measure",
             ["planners.json", "--out", "x", "--figure", "profile"]),
            (1, "space.json: no guide was tested; run with --ablation 2",
             ["space.json", "--out", "x", "--figure", "levels"]),
            (1, "planners.json: there is no run of 'rrt' on 'trap' with seed 9",
             ["planners.json", "--file", "x.svg", "--figure", "world", "--strategy", "rrt", "--seed", "9"]),
            (1, "x.gif: the ending says the format; there are: .svg, .pdf, .png",
             ["planners.json", "--file", "x.gif", "--figure", "world"]),
            (1, "a file/x.svg: Not a directory", ["planners.json", "--file", "a file/x.svg", "--figure", "world"]),
            (1, "a file: File exists", ["planners.json", "--out", "a file", "--figure", "costs"]),
            (1, "baseline: there is no strategy 'rtt' (did you mean 'rrt'?); there are: ",
             ["planners.json", "--out", "x", "--baseline", "rtt"]),
        ):
            with self.subTest(arguments):
                found, stdout, stderr = fault_of(*arguments)
                self.assertEqual((found, stdout), (status, ""), stderr)
                self.assertEqual(stderr.count("\n"), 1, stderr)
                self.assertTrue(stderr.startswith(fault) if fault.endswith(" ") else stderr == fault + "\n", stderr)
        found = command("planners.json", "--out", "x", "--figure", "schedule")
        self.assertEqual((found.returncode, found.stdout, found.stderr),
                         (1, "", "planners.json: no run of a team has a path with times\n"))

    def test_a_damaged_document_is_a_fault(self):
        """Each part is left out or has another type: drawn all the same, or a line."""
        content = content_of("scored")
        content["runs"] = content["runs"][:2]
        places = [("experiment",), ("experiment", "strategies"), ("experiment", "problems", 0), ("worlds",),
                  ("worlds", 0), ("worlds", 0, "bounds"), ("robots", 0), ("scenes", 0), ("scenes", 0, "axes"), ("runs",),
                  ("runs", 0),
                  ("runs", 0, "path"), ("runs", 0, "levels"), ("summary",), ("summary", 0, "levels"),
                  ("summary", 0, "validity_checks"), ("comparisons", 0), ("comparisons", 0, "validity_checks")]
        for place in places:
            for value in (None, 3, [[]]):
                damaged = copy.deepcopy(content)
                inner = damaged
                for key in place[:-1]:
                    inner = inner[key]
                inner[place[-1]] = value
                path = written(damaged, "damaged.json")
                with self.subTest((place, value)):
                    status, _, stderr = fault_of(path, "--out", "damaged", "--format", "svg", "--figure", "costs",
                                                 "--figure", "ratios", "--figure", "world")
                    self.assertEqual((status, stderr.count("\n")), (1, 1) if status else (0, 0), stderr)

    def test_without_matplotlib(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "matplotlib.py").write_text("raise ImportError('it is not there')\n", encoding="utf-8")
            path = os.pathsep.join([folder, os.environ.get("PYTHONPATH", "")])
            found = command("planners.json", "--out", "x", PYTHONPATH=path)
            self.assertEqual((found.returncode, found.stdout, found.stderr),
                             (1, "", "figures need matplotlib (Debian: python3-matplotlib)\n"))

    def test_pandas_is_for_frames_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "pandas.py").write_text("raise ImportError('it is not there')\n", encoding="utf-8")
            path = os.pathsep.join([folder, os.environ.get("PYTHONPATH", "")])
            found = command("planners.json", "--out", "tables", "--format", "svg", PYTHONPATH=path)
            self.assertEqual((found.returncode, found.stderr), (0, ""))
        for name in ("scored", "planners", "anytime"):
            frames, texts = figures.tables(DOCUMENTS[name]), figures.tables(DOCUMENTS[name], "csv")
            for table, frame in frames.items():
                self.assertEqual(texts[table], frame.to_csv(index=False, lineterminator="\n"), (name, table))

    def test_bytes_do_not_depend_on_the_system(self):
        settings = pathlib.Path(PLACE.name, "matplotlibrc")
        settings.write_text("font.size: 23\nsvg.hashsalt: other\nsavefig.dpi: 31\naxes.grid: True\n", encoding="utf-8")
        for name, drawn in (("scored", "profile"), ("anytime", "length"), ("planners", "ratios"), ("space", "world")):
            files = []
            for k, environment in enumerate(({"MPLBACKEND": "agg", "PYTHONHASHSEED": "1", "TZ": "UTC"},
                                             {"MPLBACKEND": "template", "PYTHONHASHSEED": "2", "TZ": "Asia/Kathmandu",
                                              "MATPLOTLIBRC": str(settings)})):
                found = command(f"{name}.json", "--out", f"{name}-{k}", "--figure", drawn, **environment)
                self.assertEqual(found.returncode, 0, found.stderr)
                place = pathlib.Path(PLACE.name, f"{name}-{k}")
                files.append({path.name: path.read_bytes() for path in place.iterdir()})
            self.assertGreaterEqual(len(files[0]), 3)
            self.assertEqual(files[0], files[1])


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Exports of runs (trellis.export). Environment: PYTHONPATH has the package, which needs nothing but Python, TRELLIS the
program."""
import json
import math
import os
import pathlib
import sqlite3
import subprocess
import sys
import tempfile
import unittest

from trellis import export
from trellis.columns import rows

PROGRAM = os.environ["TRELLIS"]
SCRIPT = """
local function named(p, name)
  return problem { name = name, world = p.world, robot = p.robot, start = p.start, goal = p.goal }
end
return experiment { seeds = 3, ablation = 0, measure = tube { points = 256, pool = 1024 },
  problems = { named(scenes.cup(), "a/b, \\"c\\" é"), named(scenes.cup(), "a-b, 'c' é"), scenes.trap() },
  strategies = { ["-it's, \\"so\\" é"] = rrt { proposals = 40 }, nested = skeleton() >> rrt { step = 0.5 },
                 star = rrt_star { step = 0.5, proposals = 1500 } } }"""


def setUpModule():
    global PLACE, FOLDER, DOCUMENT
    PLACE = tempfile.TemporaryDirectory()
    script = pathlib.Path(PLACE.name, "it.lua")
    script.write_text(SCRIPT, encoding="utf-8")
    FOLDER = pathlib.Path(PLACE.name, "results")
    subprocess.run([PROGRAM, "run", str(script), "--quiet", "--out", str(FOLDER)], check=True, stderr=subprocess.DEVNULL)
    DOCUMENT = json.loads((FOLDER / "results.json").read_text(encoding="utf-8"))


def tearDownModule():
    PLACE.cleanup()


def place(name):
    return pathlib.Path(PLACE.name, name)


def asked(file, query):
    database = sqlite3.connect(file)
    database.row_factory = sqlite3.Row
    try:
        return database.execute(query).fetchall()
    finally:
        database.close()


def database(name="all.db", results=None):
    file = place(name)
    export.sqlite(FOLDER if results is None else results, file)
    return file


class Sqlite(unittest.TestCase):
    def test_a_row_of_each_run(self):
        file = database()
        self.assertEqual(asked(file, "SELECT count(*) FROM pragma_foreign_key_check")[0][0], 0)
        self.assertEqual([asked(file, f"PRAGMA {name}")[0][0] for name in ("application_id", "user_version")],
                         [export.APPLICATION, export.VERSION_OF_TABLES])
        found = asked(file, "SELECT run.*, problem.name, strategy.name FROM run JOIN problem ON "
                            "problem.id = run.problem JOIN strategy ON strategy.id = run.strategy ORDER BY run.id")
        self.assertEqual(len(found), len(DOCUMENT["runs"]))
        self.assertTrue({True, False} <= {run["solved"] for run in DOCUMENT["runs"]})
        for row, run in zip(found, DOCUMENT["runs"]):
            self.assertEqual(tuple(row)[-2:], (run["problem"], run["strategy"]))
            for name in ("seed", "status", "solved", "certified", "validity_checks", "work", "time_s", "cpu_s", "length",
                         "clearance", "refuted_paths"):
                self.assertEqual(row[name], run[name], name)
            record = json.loads(row["record"])
            self.assertEqual({key: record[key] for key in run}, run)
        levels = rows(DOCUMENT["levels"])
        stored = asked(file, "SELECT * FROM level ORDER BY run, level")
        self.assertEqual(len(stored), len(levels))
        for row, level in zip(stored, levels):
            self.assertEqual(row["run"], level["run"] + 1)
            for name in ("level", "parent", "key", "name", "space", "planner", "proposals", "nodes", "status", "solved"):
                self.assertEqual(row[name], level[name], name)

    def test_scores_are_those_that_reports_print(self):
        header, *lines = (FOLDER / "runs.csv").read_text(encoding="utf-8").splitlines()
        names = header.split(",")
        compared = 0
        for line, row in zip(lines, asked(database(), "SELECT * FROM level WHERE level = 0 ORDER BY run")):
            if '"' in line:
                continue
            cells = dict(zip(names, line.split(",")))
            for role in ("tree", "expansion"):
                self.assertEqual(row[f"{role}_SE"] is None, cells[f"{role}_SE"] == "")
                if cells[f"{role}_SE"]:
                    self.assertAlmostEqual(row[f"{role}_SE"], float(cells[f"{role}_SE"]), places=5)
                    self.assertAlmostEqual(row[f"root_{role}_above_uniform"],
                                           float(cells[f"{role}_D_uniform"]) - float(cells[f"{role}_SE"]), places=5)
                    compared += 1
        self.assertGreater(compared, 0)

    def test_an_estimate_beyond_its_bound(self):
        measured = {"SE": 0.1, "D_uniform": 2.0, "D_mass_lower95": 0.35, "D_perfect": 0.05, "estimator": "knn"}
        least = -math.log(0.95 * math.exp(-0.35) + 0.05 * math.exp(-2.0))
        self.assertAlmostEqual(export._bounded(measured)["SE"], least)
        self.assertAlmostEqual(export._bounded(measured)["above_uniform"], 2.0 - least)
        self.assertEqual(export._bounded({**measured, "estimator": "exact"})["SE"], 0.1)
        self.assertEqual(export._bounded({**measured, "SE": -0.4, "D_perfect": None})["SE"], 0.0)

    def test_planner_arena(self):
        file = database()
        # Parameters of problems would follow the twelfth column of experiments.
        self.assertEqual(asked(file, "SELECT count(*) FROM pragma_table_info('experiments')")[0][0], 12)
        joined = asked(file, "SELECT count(*) FROM runs JOIN experiments ON experiments.id = runs.experimentid JOIN "
                             "plannerConfigs ON plannerConfigs.id = runs.plannerid JOIN enums ON enums.name = 'status' AND "
                             "enums.value = runs.status WHERE runs.solved = (enums.description = 'Exact solution')")
        self.assertEqual(joined[0][0], len(DOCUMENT["runs"]))
        steps = sum(len(run["improvements"]) for run in DOCUMENT["runs"])
        self.assertEqual(asked(file, "SELECT count(*) FROM progress")[0][0], steps)
        self.assertGreater(steps, sum(run["solved"] for run in DOCUMENT["runs"]))
        self.assertEqual(asked(file, "SELECT DISTINCT version FROM experiments")[0][0],
                         "Trellis " + DOCUMENT["trellis"]["version"])

    def test_a_manifest_adds_hashes(self):
        manifest = json.loads((FOLDER / "manifest.json").read_text(encoding="utf-8"))
        row = asked(database(), "SELECT * FROM experiment")[0]
        self.assertEqual((row["script_hash"], json.loads(row["files"]), row["options"]),
                         (manifest["script_hash"], manifest["files"], manifest["options"]))
        self.assertEqual({row["name"]: row["world"] for row in asked(database(), "SELECT * FROM problem")},
                         manifest["worlds"])
        alone = database("alone.db", DOCUMENT)
        self.assertIsNone(asked(alone, "SELECT script_hash FROM experiment")[0][0])
        self.assertEqual(asked(alone, "SELECT count(*) FROM level")[0][0], DOCUMENT["levels"]["rows"])

    def test_what_it_replaces(self):
        file = database("own.db")
        database("own.db")
        before = file.read_bytes()
        with self.assertRaises(export.Error):
            export.sqlite({**DOCUMENT, "trellis": {"format": 4}}, file)
        self.assertEqual(file.read_bytes(), before)
        other = place("other.db")
        sqlite3.connect(other).execute("CREATE TABLE mine (x)").connection.close()
        text = place("text ?#%.db")
        text.write_text("some text", encoding="utf-8")
        for one in (other, text):
            content = one.read_bytes()
            with self.assertRaisesRegex(export.Error, "Trellis did not write this file; it is left as it is"):
                export.sqlite(FOLDER, one)
            self.assertEqual(one.read_bytes(), content)
        broken = json.loads(json.dumps(DOCUMENT))
        del broken["runs"][-1]["cpu_s"]
        with self.assertRaises(KeyError):
            export.sqlite(broken, file)
        self.assertEqual(file.read_bytes(), before)
        self.assertEqual([name for name in os.listdir(PLACE.name) if ".part-" in name], [])


class Pdt(unittest.TestCase):
    def test_steps_of_each_run(self):
        export.pdt(FOLDER, place("pdt"))
        names = {"a/b, \"c\" é": "a-b,--c--é", "a-b, 'c' é": "a-b,--c--é-2", "trap": "trap"}
        self.assertEqual(sorted(os.listdir(place("pdt"))), sorted(f"{name}.csv" for name in names.values()))
        for problem, name in names.items():
            lines = place(f"pdt/{name}.csv").read_text(encoding="utf-8").splitlines()
            runs = [run for run in DOCUMENT["runs"] if run["problem"] == problem]
            self.assertEqual(len(lines), 2 * len(runs))
            ends = set()
            for times, costs, run in zip(lines[::2], lines[1::2], runs):
                label = "\"'-it's, \"\"so\"\" é\"" if run["strategy"].startswith("-") else run["strategy"]
                self.assertTrue(times.startswith(label + ", ") and costs.startswith(label + ", "))
                at, cost = ([float(cell) for cell in line[len(label) + 2:].split(", ")] for line in (times, costs))
                self.assertEqual(len(at), len(cost))
                self.assertEqual(at, sorted(set(at)))
                self.assertEqual(cost, sorted(cost, reverse=True))
                if run["solved"]:
                    self.assertEqual(cost[-1], run["improvements"][-1]["length"])
                else:
                    self.assertEqual(set(cost), {math.inf})
                ends.add(at[-1])
            self.assertEqual(len(ends), 1)

    def test_a_step_has_a_point_before_it(self):
        run = {"solved": True, "improvements": [{"cpu_s": 0.5, "length": 9.0}, {"cpu_s": 0.5, "length": 8.0},
                                                {"cpu_s": 1.0, "length": 7.0}]}
        points = list(export._steps(run, 2.0))
        self.assertEqual([cost for _, cost in points], [math.inf, 8.0, 8.0, 7.0, 7.0, 7.0])
        self.assertEqual([time for time, _ in points],
                         [export._before(0.5), 0.5, export._before(1.0), 1.0, export._before(2.0), 2.0])
        self.assertTrue(0.49999999999999 < export._before(0.5) < 0.5)

    def test_cells_and_numbers(self):
        for text, cell in (("rrt", "rrt"), ("-1.5e3", "-1.5e3"), ("-inf", "-inf"), ("-x", "\"'-x\""), ("=a", "\"'=a\""),
                           ('a"b', '"a""b"'), ("a,b", '"a,b"'), ("+1", "\"'+1\"")):
            self.assertEqual(export._cell(text), cell)
        self.assertEqual([export._digits(x) for x in (1.0, 0.1, 1e-7, math.inf)], ["1", "0.1", "1e-07", "inf"])


class Command(unittest.TestCase):
    def command(self, *arguments):
        return subprocess.run([sys.executable, "-m", "trellis.export", *map(str, arguments)], capture_output=True,
                              text=True, cwd=PLACE.name, check=False)

    def test_both_forms(self):
        self.assertEqual(self.command("results", "--to", "sqlite", "command.db").returncode, 0)
        self.assertEqual(asked(place("command.db"), "SELECT record FROM run ORDER BY id")[0][0],
                         asked(database(), "SELECT record FROM run ORDER BY id")[0][0])
        self.assertEqual(self.command("--to", "pdt", "--", "results/results.json", "-pdt").returncode, 0)
        self.assertEqual(len(os.listdir(place("-pdt"))), 3)

    def test_faults_are_a_line(self):
        place("broken.json").write_text('{"trellis": {"format": 5}, "experiment": {}}', encoding="utf-8")
        for arguments, status, text in (
                (("results", "--to", "xml", "out"), 2, "invalid choice"),
                (("nothing", "--to", "pdt", "out"), 1, "nothing: No such file or directory"),
                (("it.lua", "--to", "pdt", "out"), 1, "it.lua: this is no JSON"),
                (("broken.json", "--to", "pdt", "out"), 1, "broken.json: the document is damaged or incomplete"),
                (("results", "--to", "sqlite", "no/folder.db"), 1, "no/folder.db")):
            outcome = self.command(*arguments)
            self.assertEqual((outcome.returncode, outcome.stdout), (status, ""), outcome.stderr)
            self.assertIn(text, outcome.stderr)
            self.assertEqual(outcome.stderr.count("\n"), 1)

    def test_the_program_merges(self):
        def merged(*arguments, **more):
            return subprocess.run([PROGRAM, "merge", *arguments], capture_output=True, text=True, cwd=PLACE.name,
                                  check=False, **more)

        outcome = merged("results", "--out", "both", "--sqlite", "merged.db", "--pdt", "merged")
        self.assertEqual((outcome.stdout, outcome.stderr), ("27 runs of 1 folder in 'both', 'merged.db', 'merged'\n", ""))
        for query in ("SELECT * FROM level ORDER BY run, level", "SELECT * FROM runs ORDER BY id"):
            self.assertEqual([tuple(row) for row in asked(place("merged.db"), query)],
                             [tuple(row) for row in asked(database(), query)])
        self.assertEqual(len(os.listdir(place("merged"))), 3)
        place("mine.db").write_text("mine", encoding="utf-8")
        outcome = merged("results", "--sqlite", "mine.db")
        self.assertEqual((outcome.returncode, outcome.stderr),
                         (2, "trellis: mine.db: Trellis did not write this file; it is left as it is\n"))
        outcome = merged("results", "--sqlite", "none.db", env={**os.environ, "TRELLIS_PYTHON": "no-python"})
        self.assertEqual(outcome.returncode, 2)
        self.assertIn("install python3 (Debian), or set TRELLIS_PYTHON", outcome.stderr)
        self.assertEqual(merged("results").stderr,
                         "trellis: merge: name an output: --out FOLDER, --csv FILE, --sqlite FILE or --pdt FOLDER\n")


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Documents of results against docs/schema/results.json. Skipped without jsonschema (Debian: python3-jsonschema)."""
import copy
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import jsonschema
except ImportError:
    print("skipped: jsonschema is not installed (Debian: python3-jsonschema)")
    sys.exit(77)

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))
from trellis import columns  # noqa: E402

TRELLIS = os.environ["TRELLIS"]
ROOT = pathlib.Path(__file__).resolve().parents[2]
SCHEMA = json.loads((ROOT / "docs" / "schema" / "results.json").read_text())

PLANE = """
local w = world { bounds = { 0, 0, 10, 10 }, box { 4, 0, 6, 4.75 }, disc { 5, 8, 1 } }
return experiment {
  problems = { problem { name = "plane", world = w, robot = robot.rectangle(0.6, 0.2), start = { 1, 1, 0 }, goal = { 9, 1, 0 } } },
  strategies = { alone = rrt_connect {}, nested = skeleton() >> shrink(0.5) >> rrt {} },
  seeds = 3,
}
"""


def run(script, *options):
    """The document of a script, in a folder that remains until the process ends."""
    folder = tempfile.mkdtemp(prefix="trellis-document-", dir=FOLDER.name)
    source = script
    if isinstance(script, str):
        source = pathlib.Path(folder, "script.lua")
        source.write_text(script)
    results = pathlib.Path(folder, "results.json")
    subprocess.run([TRELLIS, "run", source, "--quiet", "--json", results, *options], check=True, cwd=folder,
                   capture_output=True, text=True)
    return results, json.loads(results.read_text())


class Schema(unittest.TestCase):
    def check(self, document):
        jsonschema.Draft7Validator(SCHEMA).validate(document)

    def test_documents_of_all_kinds_of_robots(self):
        jsonschema.Draft7Validator.check_schema(SCHEMA)
        for script in (PLANE, ROOT / "examples" / "space.lua", ROOT / "examples" / "mixed_team.lua",
                       ROOT / "examples" / "team_of_cars.lua"):
            with self.subTest(script=str(script)[:40]):
                document = run(script, "--seeds", "1")[1]
                self.check(document)
                self.assertEqual(len(document["scenes"]), len(document["experiment"]["problems"]))
                self.assertGreater(len(document["worlds"]), 0)

    def test_other_documents_are_refused(self):
        document = run(PLANE)[1]
        self.check(document)
        for damage in (lambda d: d.pop("worlds"), lambda d: d["worlds"][0].pop("bounds"),
                       lambda d: d["runs"][0].pop("seed"), lambda d: d.update(more=1),
                       lambda d: d["runs"][0].update(time_s="fast"), lambda d: d["robots"][0].update(kind="car"),
                       lambda d: d["scenes"][0].update(world=-1), lambda d: d["trellis"].update(format=4), lambda d: d["levels"].pop("rows"),
                       lambda d: d["levels"].update(nodes="many"), lambda d: d["measure"].update(N=-1)):
            other = copy.deepcopy(document)
            damage(other)
            with self.assertRaises(jsonschema.ValidationError):
                self.check(other)

    def test_tables_have_a_row_for_each_level_and_set(self):
        document = run(PLANE)[1]
        levels, measure = (columns.rows(document[name]) for name in ("levels", "measure"))
        self.assertEqual([(row["run"], row["level"]) for row in levels], [(0, 0), (1, 0), (2, 0)] + [
            (run, level) for run in (3, 4, 5) for level in (0, 1, 2)])
        self.assertEqual({row["name"] for row in levels}, {"root", "shrink(0.5)", "skeleton()"})
        sources = levels[0]["sources"]
        self.assertEqual(sum(count for _, count in sources), levels[0]["proposals"])
        sets = {(row["run"], row["level"], row["space"], row["path"], row["role"]) for row in measure}
        self.assertEqual(len(sets), len(measure))
        self.assertIn((3, 2, "root", "self", "tree"), sets)
        setups = columns.rows(document["setups"])
        self.assertEqual([row["strategy"] for row in setups], ["nested"])
        self.assertGreater(setups[0]["shared_set_up_s"], 0)
        # Whichever run computed it, each reports what it took.
        shared = [one["shared_set_up_s"] for one in document["runs"][3:]]
        self.assertEqual(shared, [shared[0]] * 3)

    def test_samples_are_where_the_document_says(self):
        with tempfile.TemporaryDirectory() as folder:
            results, document = run(PLANE, "--samples", folder)
            index = json.loads((results.parent / document["samples"] / "index.json").read_text())
            self.assertEqual([(r["problem"], r["strategy"], int(r["seed"])) for r in index["runs"]],
                             [(r["problem"], r["strategy"], r["seed"]) for r in document["runs"]])
            self.assertEqual(index["robots"][:len(document["robots"])], document["robots"])
            table = columns.rows(document["levels"])
            for entry, of in zip(index["runs"], document["runs"]):
                levels = json.loads(pathlib.Path(folder, entry["file"]).read_text())["levels"]
                rows = [row for row in table if row["run"] == document["runs"].index(of)]
                self.assertEqual([l["name"] for l in levels], [row["name"] for row in rows])
                self.assertEqual([l["all"] for l in levels], [[row["proposals"], row["nodes"]] for row in rows])
        self.assertIsNone(run(PLANE)[1]["samples"])

    def test_a_folder_of_results_has_samples_and_its_document_makes_the_page(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder, "out")
            run(PLANE, "--out", out)
            document = json.loads((out / "results.json").read_text())
            self.check(document)
            self.assertEqual(document["samples"], "samples")
            page = pathlib.Path(folder, "page.html")
            subprocess.run([TRELLIS, "report", out, "--html", page], check=True, capture_output=True)
            # The page of the run itself has the same runs for replay.
            def samples(path):
                return [line for line in path.read_text().splitlines() if 'id="run-' in line]
            self.assertEqual(len(samples(page)), len(document["runs"]))
            self.assertEqual(samples(page), samples(out / "report.html"))


if __name__ == "__main__":
    FOLDER = tempfile.TemporaryDirectory(prefix="trellis-documents-")
    unittest.main()

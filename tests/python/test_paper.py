# SPDX-License-Identifier: GPL-3.0-or-later
"""examples/paper/compare.py and examples/paper_grid.py, on results whose comparison is known."""
import contextlib
import io
import json
import math
import pathlib
import random
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples"))

import paper_grid  # noqa: E402
from paper import compare  # noqa: E402

# SE of the tree of each strategy in the problem trap, by seed.
VALUES = {"rrt": (1.0, 1.1, 1.2, 1.3, 1.4), "irc": (2.0, 2.1, 2.3, 2.5, 2.6), "dr_rrt": (0.5, 0.6, 0.7)}


def columns(table):
    """Returns rows as a table of the document."""
    return {"rows": len(table), **{name: [row[name] for row in table] for name in (table[0] if table else ())}}


def results(folder):
    """Writes the document of a run that compare.py reads."""
    runs, measure = [], []
    for strategy, values in VALUES.items():
        for seed, value in enumerate(values):
            for path in ("self", "cross"):
                measure.append({"run": len(runs), "level": 0, "role": "tree", "path": path, "estimator": "knn", "SE": value,
                                "SE_lo": value - 0.1, "SE_hi": value + 0.1, "D_uniform": 2.5, "D_perfect": 0.0,
                                "above_uniform": 2.5 - value, "N": 100 * (seed + 1)})
            runs.append({"problem": "trap", "strategy": strategy, "seed": seed, "solved": strategy != "irc"})
    # Of all seeds together the trees of rrt are blank, and those of irc worse than their runs say.
    pooled = [{"problem": "trap", "strategy": strategy, "key": "0", "role": "tree", "estimator": "knn", "SE": 2.0,
               "SE_lo": lo, "SE_hi": hi, "D_uniform": 2.5} for strategy, lo, hi in (("rrt", 2.0, 3.1), ("irc", 2.9, 3.4))]
    document = {"experiment": {"problems": [{"name": "trap"}], "strategies": [{"name": name} for name in VALUES],
                               "seeds": [0, 1, 2, 3, 4], "measure": {"estimators": ["knn"]}},
                "runs": runs, "measure": columns(measure), "pooled": columns(pooled)}
    (folder / "results.json").write_text(json.dumps(document), encoding="utf-8")


def printed(program, folder):
    """Returns what a program prints about a folder."""
    text, before = io.StringIO(), sys.argv
    sys.argv = [program.__name__, str(folder)]
    try:
        with contextlib.redirect_stdout(text):
            program.main()
    finally:
        sys.argv = before
    return text.getvalue()


class Comparison(unittest.TestCase):
    """The comparison with the published figures."""

    def test_figures_ranks_and_sentences(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            results(folder)
            text = printed(compare, folder)
        # Student's interval of the ends: 1.1 and 1.3, both 0.2 wider.
        end = 2.7764451051977987 * math.sqrt(0.025 / 5)
        own = f"{1.1 - end:.2f} to {1.3 + end:.2f}"
        self.assertIn(f"| rrt | {own}<br>NA |\n", text)
        self.assertIn("| dr\\_rrt | 0.50 to 0.70<br>NA |\n", text)  # three runs have no interval
        self.assertIn("**trap**: no run of irc found a path;", text)
        self.assertIn(f"| rrt | tree | 9.589 | blank | {own} | {own} |\n", text)
        self.assertIn("| rrt | expansion | 7.547 | NA | NA | NA |\n", text)
        self.assertIn("| trap | irc | tree | -0.90 to -0.40 | ", text)
        self.assertIn("| knn | own path | tree | 0.87 (3) |\n", text.split("## Beside")[0])  # with N: 300, 300, 200
        # Published: irc 4.8, rrt 9.6, dr_rrt 38.8; here dr_rrt, rrt, irc.
        self.assertIn("| headline | own path | tree | -1.00 (3) |\n", text)
        # Student's interval of the differences 1, 1, 1.1, 1.2, 1.2; three differences have none.
        half = 2.7764451051977987 * 0.1 / math.sqrt(5)
        self.assertIn(f"| headline | own path | yes: +1.10 ± {half:.2f} | NA |\n", text)
        self.assertIn("| headline | own path | -0.50 | NA |\n", text)
        self.assertIn("| published |  | **no**: -4.74 | yes: +14.06 |\n", text)
        self.assertNotIn("simple_passage", text.replace("\\", ""))

    def test_students_quantile(self):
        for degrees, known in ((1, 12.706205), (2, 4.302653), (9, 2.262157), (14, 2.144787)):
            self.assertAlmostEqual(compare.student_quantile(degrees), known, places=5)

    def test_rank_correlation(self):
        self.assertAlmostEqual(compare.correlation([1, 2, 3, 4], [1, 4, 9, 16]), 1.0)
        self.assertAlmostEqual(compare.correlation([1, 2, 2, 3], [3, 2, 2, 1]), -1.0)
        self.assertTrue(math.isnan(compare.correlation([1, 2], [1, 2])))
        self.assertTrue(math.isnan(compare.correlation([1, 1, 1], [1, 2, 3])))


class Grid(unittest.TestCase):
    """The divergence by a plain grid."""

    def test_divergence_of_cells(self):
        target = {(0, 0): 0.5, (1, 0): 0.5}
        self.assertAlmostEqual(paper_grid.divergence(target, target, 1e-10), 0.0)
        self.assertAlmostEqual(paper_grid.divergence(target, {(0, 0): 1.0}, 1e-10),
                               0.5 * math.log(0.5) + 0.5 * math.log(0.5 / 1e-10))

    def test_methods_of_a_folder(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            draw = random.Random(1)
            for method in ("rrt", "irc"):
                for seed in (1, 2, 3):
                    place = folder / "samples" / "cup" / method / f"seed-{seed}"
                    place.mkdir(parents=True)
                    (place / "path.csv").write_text("q1,q2,q3\n1,5,0\n9,5,0\n", encoding="utf-8")
                    rows = [f"0,{role},{i},1,{draw.uniform(0, 10)},{draw.uniform(0, 10)},0"
                            for role in compare.ROLES for i in range(50)]
                    (place / "samples.csv").write_text(
                        "level,role,index,accepted,q1,q2,q3\n" + "\n".join(rows) + "\n", encoding="utf-8")
            text = printed(paper_grid, folder)
        self.assertIn("| cup | samples | published | all seeds together, floor 1e-100 |", text)
        self.assertIn("\n| irc | expansion | 9.443 |", text)
        self.assertIn("\n| cup | tree | 2 | NA |", text)
        self.assertNotIn("trap", text)


if __name__ == "__main__":
    unittest.main()

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


def results(folder):
    """Writes the files of a run that compare.py reads."""
    runs = []
    measure = {"rows": 0, **{name: [] for name in ("run", "level", "role", "path", "estimator", "SE")}}
    rows = ["problem,strategy,role,path,estimator,quantity,value,lo,hi,n,infinite"]
    for strategy, values in VALUES.items():
        middle = sum(values) / len(values)
        for path in ("own", "cross"):
            rows.append(f"trap,{strategy},tree,{path},headline,SE,{middle},{middle - 0.1},{middle + 0.1},3,0")
            rows.append(f"trap,{strategy},expansion,{path},headline,SE,,,,0,0")
        for seed, value in enumerate(values):
            for path in ("self", "cross"):
                row = {"run": len(runs), "level": 0, "role": "tree", "path": path, "estimator": "knn", "SE": value}
                measure["rows"] += 1
                for name, cell in row.items():
                    measure[name].append(cell)
            runs.append({"problem": "trap", "strategy": strategy, "seed": seed})
    document = {"experiment": {"problems": [{"name": "trap"}], "strategies": [{"name": name} for name in VALUES]},
                "runs": runs, "measure": measure, "pooled": {"rows": 0}}
    (folder / "results.json").write_text(json.dumps(document), encoding="utf-8")
    (folder / "table.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


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
        self.assertIn("| rrt | tree | 9.589 | 1.10 to 1.30 | 1.10 to 1.30 |\n", text)
        self.assertIn("| rrt | expansion | 7.547 | NA | NA |\n", text)
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

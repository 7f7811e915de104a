# SPDX-License-Identifier: GPL-3.0-or-later
"""trellis.Sampler: a guide that a planner in Python draws from."""
import math
import os
import pathlib
import signal
import subprocess
import sys
import threading
import unittest

try:
    import numpy as np
except ImportError:
    print("skipped: numpy is not installed")
    sys.exit(77)

import trellis

ROOT = pathlib.Path(__file__).resolve().parents[2]
TRAP = trellis.problem("scenes.trap()")


class Draws(unittest.TestCase):
    def test_the_same_answers_give_the_same_draws(self):
        found = []
        for _ in range(2):
            sampler = trellis.Sampler("skeleton() >> shrink(0.5)", TRAP, 3)
            rows = []
            for i in range(60):
                draw = sampler.draw()
                rows.append(draw.q)
                if i % 3 == 0:
                    sampler.rejected(draw, TRAP.start, draw.q, draw.q)
                else:
                    sampler.accepted(draw, draw.q, 0, reached=True)
            found.append(np.array(rows))
        np.testing.assert_array_equal(*found)
        self.assertEqual(sampler.state, "found")
        self.assertEqual([level["name"] for level in sampler.levels], ["root", "shrink(0.5)", "skeleton()"])
        self.assertEqual(sampler.levels[0]["proposals"].shape, (60, 3))
        self.assertEqual(sampler.levels[0]["nodes"].shape, (41, 3))
        self.assertEqual(sampler.levels[0]["parents"].tolist(), [0] * 41)
        self.assertEqual(sampler.levels[0]["names"], ["x", "y", "theta"])

    def test_values_as_guides(self):
        guide = trellis.guide("skeleton()")
        one, two = trellis.Sampler(guide, TRAP), trellis.Sampler("skeleton()", TRAP)
        np.testing.assert_array_equal(one.draw().q, two.draw().q)
        self.assertIn("skeleton()", repr(one))

    def test_draws_in_bulk_advance_to_the_goal(self):
        sampler = trellis.Sampler("skeleton()", TRAP, uniform=0.0, optimistic=True)
        rows = sampler.draw_many(300)
        self.assertEqual(rows.shape, (300, 3))
        self.assertLess(np.linalg.norm(rows[:, :2] - np.array(TRAP.goals[0])[:2], axis=1).min(), 0.5)
        with self.assertRaisesRegex(trellis.Error, "optimistic"):
            trellis.Sampler("skeleton()", TRAP).draw_many(3)

    def test_a_grant_pauses_the_searches(self):
        sampler = trellis.Sampler("shrink(0.5)", TRAP, uniform=0.0, grant=1)
        self.assertFalse(sampler.draw().guided)
        self.assertEqual(sampler.state, "searching")
        self.assertEqual(sampler.allow(10 ** 9), "found")
        self.assertTrue(sampler.draw().guided)
        self.assertGreater(sampler.checks, 0)

    def test_density(self):
        sampler = trellis.Sampler("skeleton()", TRAP, uniform=0.5)
        values = sampler.density(np.array([TRAP.start, [9.9, 0.1, 3.0]]))
        volume = math.prod((hi - lo) * w for lo, hi, w in zip(TRAP.lo, TRAP.hi, TRAP.weights))
        self.assertAlmostEqual(values[1], 0.5 / volume)
        self.assertGreaterEqual(values[0], values[1])
        with self.assertRaisesRegex(trellis.Error, r"shape \(N, 3\)"):
            sampler.density([0.0, 0.0, 0.0])

    def test_two_trees(self):
        sampler = trellis.Sampler("skeleton()", TRAP)
        self.assertEqual(sampler.root(), 0)
        self.assertEqual(sampler.root("goal"), 1)
        draw = sampler.draw("goal")
        node = sampler.accepted(draw, draw.q, 1, reached=True, side="goal")
        self.assertEqual(node, 2)
        self.assertEqual(sampler.node(draw.q), 2)
        self.assertIsNone(sampler.node([5.0, 5.0, 0.0]))
        self.assertIsInstance(sampler.worth_connecting(draw.q, TRAP.start), bool)
        self.assertGreaterEqual(sampler.edge_factor(draw.q, TRAP.start), 1.0)
        sampler.path_found(20.0)
        sampler.cleared()
        self.assertIsNone(sampler.node(draw.q))


class Faults(unittest.TestCase):
    def test_messages(self):
        sampler = trellis.Sampler("skeleton()", TRAP)
        draw = sampler.draw()
        for call, text in [
            (lambda: trellis.Sampler("skelton()", TRAP), "skeleton"),
            (lambda: trellis.Sampler("rrt()", TRAP), "this is no guide"),
            (lambda: trellis.Sampler("skeleton()", TRAP, step=-1), "'step' is -1"),
            (lambda: trellis.Sampler("skeleton()", TRAP, uniform=2), "'uniform' is 2"),
            (lambda: trellis.Sampler("couple()", TRAP).draw(), "couple"),
            (lambda: sampler.draw("left"), 'a side is "start" or "goal", got "left"'),
            (lambda: sampler.accepted(draw, draw.q[:2], 0), "2 coordinates"),
            (lambda: sampler.accepted(draw, draw.q * math.nan, 0), "not finite"),
            (lambda: sampler.accepted(draw, draw.q, 5), "no node 5"),
            (lambda: sampler.rejected(None, draw.q), "second end"),
            (lambda: sampler.joined(9), "no node 9"),
            (lambda: trellis.Recorder.of(sampler, "edges"), "proposals"),
        ]:
            with self.assertRaisesRegex(trellis.Error, text):
                call()
        unsuited = trellis.Sampler("couple()", TRAP)
        for _ in range(3):
            with self.assertRaisesRegex(trellis.Error, "couple"):
                unsuited.draw()
        self.assertEqual(unsuited.state, "untried")
        for call in (sampler.worth_connecting, sampler.edge_factor):
            with self.assertRaisesRegex(trellis.Error, "1 coordinates"):
                call([1.0], TRAP.start)
        sampler.accepted(draw, draw.q, 0, reached=True)
        with self.assertRaisesRegex(trellis.Error, "draw 1 has an answer"):
            sampler.rejected(draw)

    def test_ctrl_c_ends_a_search(self):
        # S has no path and a search without end.
        text = """problem { name = "walled", world = world { bounds = {0, 0, 10, 10}, box { 4, 0, 5, 10 } },
                  robot = robot.disc(0.2), start = {1, 5}, goal = {9, 5} }"""
        sampler = trellis.Sampler("identity { planner = rrt { proposals = 1e9 } }", trellis.problem(text))
        timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            sampler.draw()
        timer.join()


class Planner(unittest.TestCase):
    def test_scores(self):
        sampler = trellis.Sampler("skeleton()", TRAP, uniform=0.0, optimistic=True)
        drawn = sampler.draw_many(100)
        for samples, n in (("proposals", 100), ("nodes", 1)):
            recorder = trellis.Recorder.of(sampler, samples)
            self.assertEqual(len(recorder), n)
        path = [TRAP.start, [5.0, 9.0, 0.0], TRAP.goals[0]]
        own = trellis.Recorder.of(TRAP)
        own.add(drawn)
        self.assertEqual(trellis.Recorder.of(sampler).measure(path, delta=0.5).document,
                         own.measure(path, delta=0.5).document)

    def test_valid_takes_rows(self):
        rows = np.array([TRAP.start, [5.0, 1.0, 0.0], [50.0, 1.0, 0.0]])
        self.assertEqual(TRAP.valid(rows).tolist(), [TRAP.valid(row) for row in rows])
        self.assertEqual(TRAP.valid(rows).tolist(), [True, False, False])
        with self.assertRaisesRegex(trellis.Error, "3 coordinates, got 2"):
            TRAP.valid(rows[:, :2])

    def test_the_example_finds_paths(self):
        run = subprocess.run([sys.executable, "-B", ROOT / "examples/python/rrt.py", "scenes.cup()"], text=True,
                             capture_output=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)
        plain, guided = run.stdout.splitlines()[:2]
        self.assertRegex(plain, r"^uniform\(\): \d+ checks, 10 of 10 solved$")
        self.assertRegex(guided, r"^skeleton\(\): \d+ checks, 10 of 10 solved$")
        self.assertLess(int(guided.split()[1]), 0.5 * int(plain.split()[1]))


if __name__ == "__main__":
    unittest.main()

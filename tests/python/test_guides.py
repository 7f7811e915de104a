# SPDX-License-Identifier: GPL-3.0-or-later
"""trellis.guide of a function: a guide in Python."""
import copy
import pickle
import sys
import unittest

try:
    import numpy as np
except ImportError:
    print("skipped: numpy is not installed")
    sys.exit(77)

import trellis
from trellis import lazy, rrt, rrt_connect, scenes, skeleton, worlds

TRAP = scenes.trap()


def uniform(known):
    """Uniform draws.

    As `uniform()` has them.
    """
    return known.rng.uniform(known.lo, known.hi, (known.count, len(known.lo)))


class Guides(unittest.TestCase):
    def test_a_function_guides(self):
        @trellis.guide
        def corridor(known):
            """Draws in the wide passage, and at both ends."""
            far = np.array([*([x, 9.0] for x in (2.0, 3.5, 4.5, 5.0, 5.5, 7.0)), known.goals[0][:2]])
            at = far[known.rng.integers(len(far), size=known.count)]
            q = np.hstack([at, np.zeros((known.count, 1))])
            return q + known.rng.normal(0.0, [0.3, 0.1, 0.3], q.shape)

        self.assertIsInstance(corridor, trellis.Guide)
        self.assertEqual(str(corridor), "corridor")
        result = trellis.run({"rrt": rrt(), "guided": corridor >> rrt(bound=0)}, TRAP, seeds=10, baseline="rrt")
        solved = result.runs.groupby("strategy")["solved"].sum()
        checks = result.runs.groupby("strategy")["validity_checks"].median()
        self.assertEqual(solved["guided"], 10)
        self.assertLess(checks["guided"], 0.5 * checks["rrt"])

    def test_runs_are_deterministic_and_compose(self):
        mine = trellis.guide(uniform)
        for strategy in (mine >> rrt(), mine >> rrt_connect(), skeleton() + mine >> rrt(), mine >> lazy() >> rrt(),
                         trellis.sequence(skeleton(), mine) >> rrt(), trellis.blend(mine, skeleton()) >> rrt(bound=0)):
            with self.subTest(str(strategy)):
                one, two = (trellis.run(strategy, TRAP, seeds=4, jobs=jobs).runs for jobs in (1, 2))
                for column in ("solved", "validity_checks", "length"):
                    self.assertEqual(one[column].tolist(), two[column].tolist())
        sampler = [trellis.Sampler(mine, TRAP, 5, uniform=0.0) for _ in range(2)]
        for _ in range(20):
            np.testing.assert_array_equal(sampler[0].draw().q, sampler[1].draw().q)

    def test_what_is_known(self):
        seen = []

        def watch(known):
            seen.append({name: getattr(known, name) for name in
                         ("q", "fate", "node", "blocked_at", "mine", "start", "goals", "names", "lo", "hi", "weights", "count")})
            seen[-1]["valid"] = known.valid(np.array([TRAP.start, [5.0, 1.0, 0.0]]))
            return uniform(known)

        sampler = trellis.Sampler(trellis.guide(watch), TRAP, 1, uniform=0.0)
        for i in range(30):
            draw = sampler.draw()
            if i in (20, 25):
                sampler.accepted(draw, draw.q, 0, reached=True)
            else:
                sampler.rejected(draw, TRAP.start, draw.q, draw.q)
        # It has read what is known, so that a node ends its draws.
        self.assertEqual([call["count"] for call in seen], [8, 16, 8, 8])
        self.assertEqual([len(call["q"]) for call in seen], [0, 8, 21, 26])
        last = seen[-1]
        self.assertEqual(np.flatnonzero(last["fate"]).tolist(), [20, 25])
        self.assertTrue(last["mine"].all())
        self.assertTrue(np.isnan(last["node"][:20]).all() and np.isnan(last["blocked_at"][20]).all())
        np.testing.assert_array_equal(last["node"][25], last["q"][25])
        np.testing.assert_array_equal(last["blocked_at"][:20], last["q"][:20])
        np.testing.assert_array_equal(last["start"], TRAP.start)
        np.testing.assert_array_equal(last["goals"], TRAP.goals)
        self.assertEqual((last["names"], last["lo"].tolist(), last["hi"].tolist()), (TRAP.names, TRAP.lo, TRAP.hi))
        self.assertEqual(last["valid"].tolist(), [True, False])
        self.assertEqual(sampler.checks, 2 * 4)

    def test_a_function_that_reads_no_results_is_called_less_and_less(self):
        counts = []
        sampler = trellis.Sampler(trellis.guide(lambda known: counts.append(known.count) or uniform(known), name="own"), TRAP)
        for _ in range(1500):
            draw = sampler.draw()
            sampler.accepted(draw, draw.q, 0, reached=True)
        self.assertEqual(counts, [8, 16, 32, 64, 128, 256, 512, 512])

    def test_a_function_may_check_under_bounded_loss(self):
        def valid(known):
            rows = known.rng.uniform(known.lo, known.hi, (4000, len(known.lo)))
            return rows[known.valid(rows)]

        runs = trellis.run({"alone": rrt(), "own": trellis.guide(valid) >> rrt()}, TRAP, seeds=6, baseline="alone").runs
        checks = runs.set_index(["strategy", "seed"])["validity_checks"]
        self.assertTrue(runs["solved"].all())
        # One call is one step.
        self.assertTrue((checks["own"] <= 2 * checks["alone"] + 864 + 4000).all())
        self.assertTrue((checks["own"] > 4000).all())

    def test_draws_beyond_the_bounds_are_reflected(self):
        far = trellis.guide(lambda known: np.array([[-1.0, 11.0, 0.5]]), name="far")
        self.assertEqual(trellis.Sampler(far, TRAP, uniform=0.0).draw().q.tolist(), [1.0, 9.0, 0.5])

    def test_faults(self):
        def fails(known):
            raise ValueError("no idea")

        kept = []
        for function, fault in [
            (fails, r"guide 'fails': ValueError: no idea \(.*test_guides.py, line \d+\)"),
            (lambda known: None, "an array of shape \\(N, 3\\), N at least 1; got NoneType"),
            (lambda known: np.zeros((4, 2)), "got shape \\(4, 2\\)"),
            (lambda known: np.zeros((0, 3)), "got shape \\(0, 3\\)"),
            (lambda known: np.full((2, 3), np.nan), "row 1 has a coordinate that is not finite"),
            (lambda known: known.valid(np.zeros(3)), "known.valid takes an array of shape \\(N, 3\\)"),
        ]:
            with self.subTest(fault), self.assertRaisesRegex(trellis.Error, fault):
                name = "" if function is fails else "own"
                trellis.run(trellis.guide(function, name=name) >> rrt(bound=0), TRAP, seeds=1)
        trellis.Sampler(trellis.guide(lambda known: kept.append(known) or uniform(known), name="own"), TRAP).draw()
        with self.assertRaisesRegex(trellis.Error, "valid during the call"):
            kept[0].q
        for call, fault in [(lambda: trellis.guide(uniform, cost=-1), "'cost' must be"),
                            (lambda: trellis.guide(lambda known: 0), "'name' must be a name"),
                            (lambda: trellis.guide(3), "an expression in the language is a text, got 3"),
                            (lambda: trellis.guide(rrt()), "an expression in the language is a text")]:
            with self.assertRaisesRegex(trellis.Error, fault):
                call()
        with self.assertRaises((trellis.Error, pickle.PicklingError, TypeError)):
            pickle.dumps(trellis.guide(uniform))

    def test_values(self):
        one, two = trellis.guide(uniform), trellis.guide(uniform)
        self.assertEqual(one, one)
        self.assertNotEqual(one, two)
        self.assertEqual(copy.copy(one), one)
        named = trellis.guide(name="other", cost=1e-3)(uniform)
        self.assertEqual(str(named), "other")

    def test_the_stated_cost_counts_as_work(self):
        def work(cost):
            runs = trellis.run(trellis.guide(uniform, cost=cost) >> rrt(bound=0), worlds.maze(cells=4, seed=1), seeds=3).runs
            return runs["work"].median()

        self.assertGreater(work(1e-3), 2 * work(0))

    def test_bounded_loss_holds_for_a_guide_that_misleads(self):
        away = trellis.guide(lambda known: np.tile(np.array([[0.5, 0.5, 0.0]]), (known.count, 1)), name="away")
        alone = trellis.run(rrt(), TRAP, seeds=6).runs["validity_checks"]
        guided = trellis.run(away >> rrt(), TRAP, seeds=6).runs
        self.assertTrue(guided["solved"].all())
        self.assertTrue((guided["validity_checks"] <= 2 * alone + 864).all())


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""The language in Python. Environment: PYTHONPATH has the built package, TRELLIS the program."""
import copy
import importlib.util
import inspect
import json
import math
import os
import pathlib
import pickle
import subprocess
import threading
import types
import unittest
import warnings

import trellis
from trellis import _trellis

PROGRAM = os.environ["TRELLIS"]
HAS_NUMPY = importlib.util.find_spec("numpy") is not None
SOURCE = pathlib.Path(__file__).resolve().parents[2]
WORDS = {name: getattr(trellis, name) for name in dir(trellis) if not name.startswith("_") and name != "figures"}

# In Python, and as a script writes it.
STRATEGIES = [
    ("rrt()", "rrt {}"),
    ("rrt(step=0.5, bound=0)", "rrt { step = 0.5, bound = 0 }"),
    ("rrt({'step': 0.25})", "rrt { step = 0.25 }"),
    ("rrt(proposals=20000, checks=math.inf)", "rrt { proposals = 2e4, checks = math.huge }"),
    ("rrt(goal_bias=0, uniform=0, bound=0)", "rrt { goal_bias = 0, uniform = 0, bound = 0 }"),
    ("rrt_connect(step=1, grow='in_turn')", "rrt_connect { step = 1, grow = 'in_turn' }"),
    ("rrt_star()", "rrt_star {}"),
    ("prm()", "prm()"),
    ("prm_star(proposals=5000, improve=5000)", "prm_star { proposals = 5000, improve = 5000 }"),
    ("lazy_prm()", "lazy_prm {}"),
    ("lazy_prm_star()", "lazy_prm_star {}"),
    ("lazy_rrg_star()", "lazy_rrg_star {}"),
    ("kinodynamic_rrt(extend='curves', proposals=20000)", "kinodynamic_rrt { extend = 'curves', proposals = 20000 }"),
    ("skeleton() >> rrt()", "skeleton() >> rrt()"),
    ("skeleton() >> lazy() >> rrt(step=0.5)", "skeleton() >> lazy() >> rrt { step = 0.5 }"),
    ("skeleton() >> shrink(0.5) >> lazy() >> rrt()", "skeleton() >> shrink(0.5) >> lazy() >> rrt {}"),
    ("skeleton() >> (shrink(0.5) >> rrt())", "skeleton() >> (shrink(0.5) >> rrt {})"),
    ("skeleton(follow='regions') >> rrt()", "skeleton { follow = 'regions' } >> rrt {}"),
    ("skeleton(clearance=0.2, prune=False) >> rrt()", "skeleton { clearance = 0.2, prune = false } >> rrt {}"),
    ("skeleton() >> split(rrt(), depth=2)", "skeleton() >> split { rrt {}, depth = 2 }"),
    ("split(skeleton() >> rrt())", "split { skeleton() >> rrt {} }"),
    ("workspace(planner=prm()) >> rrt()", "workspace { planner = prm {} } >> rrt {}"),
    ("workspace() >> shrink(0.5) >> rrt_connect(step=1)", "workspace() >> shrink(0.5) >> rrt_connect { step = 1 }"),
    ("shrink(0.5) >> skeleton() >> rrt()", "shrink(0.5) >> skeleton() >> rrt {}"),
    ("shrink(0.5, evidence=50) >> rrt()", "shrink { 0.5, evidence = 50 } >> rrt {}"),
    ("shrink(scale=0.5, paths=3, follow='tube') >> rrt()", "shrink { 0.5, paths = 3, follow = 'tube' } >> rrt {}"),
    ("lazy() >> rrt(step=1, bound=0)", "lazy() >> rrt { step = 1, bound = 0 }"),
    ("identity(follow='tube', radius=0.5) >> rrt()", "identity { follow = 'tube', radius = 0.5 } >> rrt {}"),
    ("identity(paths=3, follow='waypoints') >> rrt()", "identity { paths = 3, follow = 'waypoints' } >> rrt {}"),
    ("joints('q1', 'q2') >> rrt()", "joints('q1', 'q2') >> rrt {}"),
    ("joints(axes=['q1']) >> rrt()", "joints { axes = {'q1'} } >> rrt {}"),
    ("joints(first=1) >> joints(first=2) >> rrt()", "joints { first = 1 } >> joints { first = 2 } >> rrt {}"),
    ("joints(slices=32) >> rrt_connect(step=0.3)", "joints { slices = 32 } >> rrt_connect { step = 0.3 }"),
    ("pca(dimensions=2, samples=50) >> rrt()", "pca { dimensions = 2, samples = 50 } >> rrt {}"),
    ("widen(0.1) >> rrt()", "widen(0.1) >> rrt {}"),
    ("drop('door', 'wall') >> rrt()", "drop { 'door', 'wall' } >> rrt {}"),
    ("aggregate() >> rrt()", "aggregate() >> rrt {}"),
    ("holonomic() >> kinodynamic_rrt()", "holonomic() >> kinodynamic_rrt {}"),
    ("decomposition() >> rrt()", "decomposition() >> rrt {}"),
    ("state_cells() >> rrt(step=0.5)", "state_cells() >> rrt { step = 0.5 }"),
    ("gaussian(0.5) >> prm()", "gaussian(0.5) >> prm {}"),
    ("bridge_test(0.5) >> prm()", "bridge_test(0.5) >> prm {}"),
    ("goal_bias(0.3) >> rrt()", "goal_bias(0.3) >> rrt {}"),
    ("information_gain(10) >> rrt()", "information_gain(10) >> rrt {}"),
    ("informed() >> lazy_prm_star(bound=0)", "informed() >> lazy_prm_star { bound = 0 }"),
    ("halton() >> prm()", "halton() >> prm {}"),
    ("team(1, 5) >> rrt()", "team { 1, 5 } >> rrt {}"),
    ("prioritise(2, 1) >> rrt()", "prioritise { 2, 1 } >> rrt {}"),
    ("prioritise() >> couple(where='path') >> rrt_connect()", "prioritise() >> couple { where = 'path' } >> rrt_connect {}"),
    ("decouple(tries=4) >> rrt()", "decouple { tries = 4 } >> rrt {}"),
    ("strategies.irc(scales=[0.25, 0.5, 0.75])", "strategies.irc { scales = {0.25, 0.5, 0.75} }"),
    ("strategies.irc(planner=rrt_connect())", "strategies.irc { planner = rrt_connect {} }"),
    ("strategies.dr_rrt()", "strategies.dr_rrt()"),
    ("strategies.vonasek()", "strategies.vonasek()"),
    ("strategies.nested()", "strategies.nested()"),
    ("strategies.relaxation(scales=[0.5]) >> prm()", "strategies.relaxation { scales = {0.5} } >> prm {}"),
    ("strategies.several(paths=2) >> rrt()", "strategies.several { paths = 2 } >> rrt {}"),
    (
        "blend(strategies.regions(), strategies.several(paths=2), uniform()) >> prm()",
        "blend { strategies.regions(), strategies.several { paths = 2 }, uniform() } >> prm {}",
    ),
]
GUIDES = [
    ("skeleton() >> lazy()", "skeleton() >> lazy()"),
    ("0.3 * skeleton()", "0.3 * skeleton()"),
    ("skeleton() * 0.3", "skeleton() * 0.3"),
    ("skeleton() + lazy()", "skeleton() + lazy()"),
    ("0.7 * skeleton() + 0.3 * lazy()", "0.7 * skeleton() + 0.3 * lazy()"),
    ("skeleton() + lazy() + uniform()", "skeleton() + lazy() + uniform()"),
    ("skeleton() + (lazy() + shrink())", "skeleton() + (lazy() + shrink())"),
    ("skeleton() >> lazy() + shrink()", "skeleton() >> lazy() + shrink()"),
    ("skeleton() + lazy() >> shrink()", "skeleton() + lazy() >> shrink()"),
    ("skeleton() >> 0.5 * lazy() + shrink()", "skeleton() >> 0.5 * lazy() + shrink()"),
    ("(skeleton() >> lazy()) + shrink()", "(skeleton() >> lazy()) + shrink()"),
    ("2 * (skeleton() + 3 * lazy())", "2 * (skeleton() + 3 * lazy())"),
    ("skeleton() >> lazy() >> shrink() + identity()", "skeleton() >> lazy() >> shrink() + identity()"),
    ("sequence(skeleton(), lazy())", "skeleton() .. lazy()"),
    ("sequence(skeleton(), lazy(), turn=50)", "sequence { skeleton(), lazy(), turn = 50 }"),
    ("blend(skeleton(), lazy())", "blend { skeleton(), lazy() }"),
    ("race(skeleton(), lazy())", "race { skeleton(), lazy() }"),
    ("schedule(shrink(0.3), shrink(0.6))", "schedule { shrink(0.3), shrink(0.6) }"),
    ("schedule(shrink, scale=[0.3, 0.6])", "schedule { shrink, scale = {0.3, 0.6} }"),
    ("along([[1, 1, 0], [9, 1, 0]])", "along { {1, 1, 0}, {9, 1, 0} }"),
    ("ball(centre=[1, 1], radius=0.5)", "ball({1, 1}, 0.5)"),
    ("ball([1, 1], radius=0.5)", "ball({1, 1}, 0.5)"),
]


def value(expression):
    return eval(expression, {"math": math, **WORDS})  # pylint: disable=eval-used


def quiet(call):
    """What a call returns, whatever it warns of."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return call()


def same(document):
    """The document without its times and what names the script."""
    if isinstance(document, dict):
        left_out = ("time", "seconds", "cpu", "origin", "script")
        return {
            key: same(entry)
            for key, entry in document.items()
            if not key.endswith("_s") and not any(part in key for part in left_out)
        }
    return [same(entry) for entry in document] if isinstance(document, list) else document


class Words(unittest.TestCase):
    def test_python_has_every_word(self):
        printed = subprocess.run([PROGRAM, "reference", "words"], capture_output=True, text=True, check=True).stdout.split()
        self.assertGreater(len(printed), 100)
        self.assertEqual(sorted(printed), sorted(word["name"] for word in _trellis.words()))
        for word in _trellis.words():
            with self.subTest(word["name"]):
                found = trellis
                for part in word["name"].split("."):
                    self.assertIn(part, dir(found))
                    found = getattr(found, part)
                self.assertTrue(found.__doc__)
                if word["is_module"]:
                    self.assertIsInstance(found, types.ModuleType)
                    self.assertEqual(found.__name__, "trellis." + word["name"])
                    continue
                self.assertEqual(found.__name__, word["name"].rpartition(".")[2])
                inspect.signature(found)

    def test_signatures_have_all_options_with_their_defaults(self):
        self.assertEqual(inspect.signature(trellis.rrt).parameters["step"].default, 0.5)
        self.assertEqual(inspect.signature(trellis.rrt).parameters["step"].annotation, float)
        self.assertEqual(inspect.signature(trellis.rrt).parameters["checks"].default, math.inf)
        self.assertEqual(list(inspect.signature(trellis.shrink).parameters)[0], "scale")
        self.assertEqual(str(inspect.signature(trellis.uniform)), "() -> trellis._trellis.Guide")
        self.assertEqual(trellis.rrt.__doc__.splitlines()[0].split(":")[0], "rrt (planner)")
        self.assertEqual(inspect.signature(trellis.joints).parameters["axes"].kind, inspect.Parameter.VAR_POSITIONAL)
        self.assertEqual(list(inspect.signature(trellis.ball).parameters), ["centre", "radius"])
        self.assertIs(inspect.signature(trellis.problem).return_annotation, "Problem")
        for word in _trellis.words():
            if word["is_module"] or word["kind"] not in ("planner", "guide", "target", "estimator"):
                continue
            made = getattr(trellis, word["name"])
            for parameter in inspect.signature(made).parameters.values():
                with self.subTest(word["name"], option=parameter.name):
                    self.assertIn(parameter.name, made.__doc__)
                    self.assertIsNot(parameter.default, inspect.Parameter.empty) if parameter.kind != parameter.VAR_POSITIONAL else None

    def test_the_defaults_of_signatures_are_those_of_the_words(self):
        checked = 0
        for word in _trellis.words():
            if word["kind"] not in ("planner", "guide") or ": str = " in word["signature"]:  # of a file
                continue
            made = getattr(trellis, word["name"])
            given = {
                parameter.name: parameter.default
                for parameter in inspect.signature(made).parameters.values()
                if parameter.default not in (inspect.Parameter.empty, ...)
            }
            with self.subTest(word["name"]):
                checked += 1
                self.assertEqual(made(**given), made())
        self.assertGreater(checked, 30)

    def test_words_without_required_arguments_can_be_called(self):
        called = 0
        for word in _trellis.words():
            signature = word["signature"]
            if word["is_module"] or word["kind"] not in ("planner", "guide", "target", "estimator"):
                continue
            if ": str = " in signature:
                continue  # of a file
            with self.subTest(word["name"]):
                self.assertIsNotNone(getattr(trellis, word["name"])())
                called += 1
        self.assertGreater(called, 35)
        for name in ("simple_passage", "trap", "cup"):
            self.assertEqual(getattr(trellis.scenes, name)().name, name)
        for name in dir(trellis.strategies):
            if not name.startswith("_"):
                self.assertIsInstance(getattr(trellis.strategies, name)(), (trellis.Strategy, trellis.Guide), name)

    def test_the_stubs_are_those_that_the_program_prints(self):
        printed = subprocess.run([PROGRAM, "reference", "python"], capture_output=True, text=True, check=True).stdout
        compile(printed, "_words.pyi", "exec")
        committed = (SOURCE / "python/trellis/_words.pyi").read_text(encoding="utf-8")
        self.assertTrue(printed == committed, "scripts/reference writes python/trellis/_words.pyi")

    def test_unknown_names(self):
        with self.assertRaisesRegex(AttributeError, "did you mean 'skeleton'"):
            trellis.skeletton
        with self.assertRaisesRegex(AttributeError, "scenes has no 'trapp'.*did you mean 'trap'"):
            trellis.scenes.trapp
        self.assertFalse(hasattr(trellis, "_nothing"))
        self.assertFalse(hasattr(trellis.rrt(), "__nothing__"))


class Values(unittest.TestCase):
    def test_python_makes_what_scripts_make(self):
        self.assertGreaterEqual(len(STRATEGIES) + len(GUIDES), 60)
        for expressions, read in (STRATEGIES, trellis.strategy), (GUIDES, trellis.guide):
            for python, lua in expressions:
                with self.subTest(python):
                    made, of_script = quiet(lambda: value(python)), read(lua)
                    self.assertEqual(made, of_script)
                    self.assertEqual(str(made), str(of_script))
                    self.assertEqual(hash(made), hash(of_script))
        self.assertNotEqual(value("rrt(step=0.5, bound=0)"), value("rrt(step=0.5)"))

    def test_members(self):
        strategy = trellis.skeleton() >> trellis.rrt()
        self.assertIn("skeleton", strategy.tree())
        self.assertEqual(len(strategy.hash()), 16)
        self.assertEqual(json.loads(strategy.json()), json.loads(trellis.strategy("skeleton() >> rrt {}").json()))
        world = trellis.world(trellis.box(4, 0, 6, 10, name="wall"), bounds=[0, 0, 10, 10])
        self.assertEqual(world.bounds, [0, 0, 10, 10])
        self.assertEqual([obstacle.name for obstacle in world.obstacles], ["wall"])
        robot = trellis.robot.rectangle(0.6, 0.2)
        self.assertAlmostEqual(robot.scaled(0.5).bounding_radius, 0.5 * robot.bounding_radius)
        valid, why = robot.valid([5, 5, 0], world)
        self.assertFalse(valid)
        self.assertIn("wall", why)
        self.assertTrue(robot.valid([1, 5, 0], world))
        self.assertEqual(trellis.scenes.trap().robot.bounding_radius, robot.bounding_radius)
        with self.assertRaises(AttributeError):
            world.nothing

    def test_a_problem_of_parts(self):
        wall = trellis.box(4, 0, 6, 4)
        made = trellis.problem(
            name="wall",
            world=trellis.world(wall, bounds=(0, 0, 10, 10)),
            robot=trellis.robot.disc(0.2),
            start=[1, 1],
            goal=[9, 1],
        )
        self.assertIsInstance(made, trellis.Problem)
        self.assertEqual((made.name, made.start, made.goals), ("wall", [1, 1], [[9, 1]]))
        self.assertFalse(made.valid([5, 2]))
        self.assertEqual(trellis.problem("scenes.trap()").start, trellis.scenes.trap().start)
        moved = trellis.scenes.trap(start=[1, 5, 0], resolution=0.02)
        self.assertEqual(moved.start, [1, 5, 0])
        maze = trellis.worlds.maze(cells=4, seed=2)
        of_script = trellis.problem("worlds.maze { cells = 4, seed = 2 }")
        self.assertEqual((maze.name, maze.start, maze.goals), (of_script.name, of_script.start, of_script.goals))
        self.assertEqual(
            [obstacle.bounds for obstacle in maze.world.obstacles],
            [obstacle.bounds for obstacle in of_script.world.obstacles],
        )

    @unittest.skipUnless(HAS_NUMPY, "needs numpy")
    def test_numbers_and_arrays_of_numpy(self):
        import numpy

        self.assertEqual(trellis.shrink(numpy.float32(0.5)), trellis.shrink(0.5))
        self.assertEqual(numpy.float64(0.3) * trellis.lazy(), 0.3 * trellis.lazy())
        self.assertEqual(trellis.rrt(proposals=numpy.int64(100)), trellis.rrt(proposals=100))
        self.assertEqual(trellis.rrt(connect_goal=numpy.bool_(False)), trellis.rrt(connect_goal=False))
        path = numpy.array([[1.0, 1.0], [9.0, 1.0]])
        self.assertEqual(trellis.along(path), trellis.along([[1, 1], [9, 1]]))
        self.assertEqual(trellis.scenes.trap(start=numpy.array([1, 5, 0])).start, [1, 5, 0])
        with self.assertRaisesRegex(trellis.Error, "None"):
            trellis.along(numpy.ma.masked_array(path, mask=[[False, True], [False, False]]))

    def test_texts_name_what_messages_name(self):
        self.assertEqual(str(trellis.skeleton() >> trellis.rrt(step=0.25)), "skeleton() >> rrt { step = 0.25 }")
        self.assertEqual(str(trellis.tube(delta=0.5)), str(trellis.tube(0.5)))
        self.assertEqual(trellis.knn(3), trellis.knn(k=3))
        self.assertEqual(repr(trellis.rrt()), "<trellis.Strategy rrt()>")

    def test_equal_problems_and_values(self):
        self.assertEqual(trellis.scenes.trap(), trellis.problem("scenes.trap()"))
        self.assertEqual(hash(trellis.scenes.trap()), hash(trellis.problem("scenes.trap()")))
        self.assertEqual(trellis.worlds.maze(cells=4, seed=2), trellis.problem("worlds.maze { cells = 4, seed = 2 }"))
        self.assertNotEqual(trellis.worlds.maze(cells=4, seed=2), trellis.worlds.maze(cells=4, seed=3, name="maze"))
        self.assertNotEqual(trellis.scenes.trap(), trellis.scenes.trap(resolution=0.02))
        self.assertEqual(trellis.tube(delta=0.5), trellis.tube(0.5))
        self.assertNotEqual(trellis.tube(delta=0.5), trellis.tube(0.25))
        self.assertEqual(trellis.box(1, 2, 3, 4), trellis.box(1, 2, 3, 4))
        self.assertNotEqual(trellis.box(1, 2, 3, 4), trellis.box(1, 2, 3, 5))
        self.assertEqual(len({trellis.box(1, 2, 3, 4), trellis.box(1, 2, 3, 4)}), 1)

    def test_copies_and_pickles(self):
        strategy = value("0.5 * skeleton() + 0.5 * shrink(0.4) >> rrt(step=0.25)")
        problem = trellis.worlds.maze(cells=4, seed=2)
        world = trellis.world(trellis.box(4, 0, 6, 4), trellis.disc(8, 8, 1), bounds=[0, 0, 10, 10])
        for one in (strategy, trellis.skeleton(), problem, world):
            self.assertIs(copy.deepcopy([one])[0], one)
        for one in (strategy, trellis.skeleton() + trellis.lazy()):
            self.assertEqual(pickle.loads(pickle.dumps(one)), one)
        again = pickle.loads(pickle.dumps(problem))
        self.assertEqual((again.name, again.start, again.goals), (problem.name, problem.start, problem.goals))
        self.assertEqual(again, problem)
        self.assertEqual(pickle.loads(pickle.dumps(world)), world)
        self.assertEqual(len(pickle.loads(pickle.dumps(world)).obstacles), 2)
        self.assertEqual(pickle.loads(pickle.dumps(trellis.problem("scenes.cup()"))).name, "cup")
        self.assertIs(pickle.loads(pickle.dumps(trellis.scenes.trap)), trellis.scenes.trap)
        with self.assertRaisesRegex(trellis.Error, "cannot be pickled"):
            pickle.dumps(problem.world)

    def test_help_is_printed(self):
        import contextlib
        import io

        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            trellis.help("shrink")
        self.assertIn("scale", printed.getvalue())

    def test_threads_make_values_at_the_same_time(self):
        made = []

        def work():
            made.extend(trellis.skeleton() >> trellis.shrink(0.5) >> trellis.rrt(step=0.5) for _ in range(20))

        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(made), 80)
        self.assertEqual(set(made), {trellis.strategy("skeleton() >> shrink(0.5) >> rrt { step = 0.5 }")})


class Faults(unittest.TestCase):
    def check(self, expression, *messages):
        with self.subTest(expression), self.assertRaises(trellis.Error) as caught:
            quiet(lambda: value(expression))
        for message in messages:
            self.assertIn(message, str(caught.exception))
        self.assertNotRegex(str(caught.exception), r"^\w+:\d+:|python:\d")  # no line of a script

    def test_options(self):
        self.check("rrt(stepp=0.5)", "rrt: unknown option 'stepp' (did you mean 'step'?)")
        self.check("rrt(step='a')", "rrt: option 'step' must be a number", '"a"')
        self.check("rrt(step=-1)", "rrt: option 'step' must be a number at least")
        self.check("shrink(0.5, 0.6)", "shrink: takes one option without a name", "as in shrink(name=value)")
        self.check("shrink(0.5, scale=0.6)", "given twice")
        self.check("ball([1, 1], 0.5, radius=1)", "ball: 'radius' is given twice")
        self.check("problem(robot=robot.disc(0.2), start=[1], goal=[2])", "problem: field 'world' is missing", "world(...)")
        self.check("scenes.trap(strat=[1, 1, 0])", "did you mean 'start'")

    def test_values_of_other_types(self):
        self.check("rrt(step=object())", "rrt: step: numbers, texts, lists, dicts and values of the language are accepted")
        self.check("rrt(step=lambda: 1)", "rrt: step: functions are written in the language")
        self.check("rrt(proposals=10**400)", "does not fit in 64 bits")
        self.check("along([[1, None], [2, 3]])", "along: path: a list cannot hold None, which is its element 2")
        self.check("rrt(step=b'1')", "rrt: step: numbers, texts")
        self.check("problem('scenes.trap()', name='x')", "an expression, or parts by name")
        self.check("require('os')", "the standard library has no module 'os'")

    def test_composition(self):
        self.check("rrt() >> skeleton()", "a planner cannot guide")
        self.check("skeleton() + rrt()", "a planner is no guide")
        self.check("skeleton >> rrt()", "'skeleton' is a constructor: call it, as in skeleton()")
        self.check("skeleton() >> rrt", "'rrt' is a constructor: call it, as in rrt()")
        with self.assertRaises(TypeError):
            trellis.skeleton() >> object()
        with self.assertRaises(TypeError):
            trellis.skeleton() - trellis.lazy()
        self.assertNotEqual(trellis.skeleton(), "skeleton()")
        self.assertNotEqual(trellis.tube(0.5), object())

    def test_warnings_are_issued(self):
        with self.assertWarnsRegex(UserWarning, "does not guide uniform"):
            trellis.skeleton() >> trellis.lazy() + trellis.uniform()


class Experiments(unittest.TestCase):
    SCRIPT = """
return experiment {
  problems   = { scenes.trap(), scenes.cup() },
  strategies = { { "plain", rrt {} }, { "guided", skeleton() >> rrt {} }, { "nested", skeleton() >> lazy() >> rrt {} } },
  baseline = "plain", seeds = 3, measure = tube { delta = 0.5 }, ablation = 0.5,
}"""

    def prepared(self):
        return value(
            """experiment(
            problems=[scenes.trap(), scenes.cup()],
            strategies={"plain": rrt(), "guided": skeleton() >> rrt(), "nested": skeleton() >> lazy() >> rrt()},
            baseline="plain", seeds=3, measure=tube(delta=0.5), ablation=0.5)"""
        )

    def test_an_experiment_is_that_of_the_script(self):
        made, script = self.prepared(), trellis.script(self.SCRIPT)
        self.assertEqual(made.strategies, script.strategies)
        self.assertEqual(list(made.strategies), ["plain", "guided", "nested"])
        self.assertEqual((list(made.problems), made.seeds, made.measured), (["trap", "cup"], [1, 2, 3], True))
        of_python, of_script = made.run(jobs=2), trellis.run(script, jobs=2)
        self.assertEqual(same(of_python.document), same(of_script.document))
        self.assertIn('"measure"', json.dumps(of_python.document))
        self.assertTrue(of_python.document["measure"]["run"])

    def test_runs_take_values(self):
        guided, trap = trellis.skeleton() >> trellis.rrt(), trellis.scenes.trap()
        by_values = trellis.run({"guided": guided}, trap, seeds=2)
        by_texts = trellis.run({"guided": "skeleton() >> rrt {}"}, "scenes.trap()", seeds=2)
        self.assertEqual(same(by_values.document), same(by_texts.document))
        self.assertFalse(by_values.document["measure"].get("run"))  # scores nothing without `measure`
        scored = trellis.run(guided, trap, measure=trellis.tube(delta=0.25), seeds=2)
        self.assertTrue(scored.document["measure"]["run"])
        self.assertEqual(list(trellis.run([guided, trellis.rrt()], trap).document["runs"])[1]["strategy"], "rrt()")
        named = trellis.run(guided, {"easy": trellis.scenes.cup(), "hard": trap})
        self.assertEqual([run["problem"] for run in named.document["runs"]], ["easy", "hard"])
        self.assertEqual(trellis.guide(trellis.lazy()), trellis.lazy())
        self.assertEqual(trellis.strategy(guided), guided)

    def test_faults_of_experiments(self):
        trap, plain = trellis.scenes.trap(), trellis.rrt()
        for call, message in (
            (lambda: trellis.run(plain, trap, measure=0.1), "measure is True, False, or a target"),
            (lambda: trellis.run(trellis.skeleton(), trap), "a strategy ends with a planner"),
            (lambda: trellis.run(plain, trellis.rrt()), "a problem is expected"),
            (lambda: trellis.run(plain, "trap"), "'trap' is written scenes.trap()"),
            (lambda: trellis.run("own.lua", trap), "'own.lua' is a script: trellis.run(trellis.load('own.lua'))"),
            (lambda: trellis.run(self.prepared(), measure=trellis.tube()), "a script says what"),
            (lambda: trellis.experiment(trap, plain, measure=0.1), "must be a target"),
            (lambda: trellis.experiment(trap, plain, baseline="x"), "baseline"),
            (lambda: trellis.experiment(trap, plain, sedes=3), "did you mean 'seeds'"),
            (lambda: trellis.experiment(trap, plain, seeds=0), "at least 1"),
        ):
            with self.subTest(message), self.assertRaises(trellis.Error) as caught:
                call()
            self.assertIn(message, str(caught.exception))


if __name__ == "__main__":
    unittest.main()

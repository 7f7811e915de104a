# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python package. Environment: PYTHONPATH has the built package, TRELLIS the program."""
import ast
import importlib.util
import json
import math
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import threading
import unittest
import warnings

import trellis

PROGRAM = os.environ["TRELLIS"]
HAS_NUMPY = importlib.util.find_spec("numpy") is not None
HAS_PANDAS = importlib.util.find_spec("pandas") is not None
HAS_MATPLOTLIB = importlib.util.find_spec("matplotlib") is not None

GAPS = """
return experiment {
  problems   = { scenes.trap(), scenes.cup() },
  strategies = { rrt = rrt { step = 0.5 }, guided = skeleton() >> rrt { step = 0.5 } },
  baseline   = "rrt",
  seeds      = 3,
  measure    = tube { delta = 0.5 },
  ablation   = 0,
}
"""
BLOCKED = """problem {
  world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 10} },
  robot = robot.rectangle(0.6, 0.2), start = {1, 5, 0}, goal = {9, 5, 0} }"""
ENDLESS = "rrt { step = 0.5, proposals = 1000000000 }"
ARM = """<robot name="arm">
<link name="base"/>
<link name="upper"><collision><origin xyz="0.4 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="lower"><collision><origin xyz="0.4 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="tip"/>
<joint name="swing" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
  <limit effort="1" velocity="1.5"/></joint>
<joint name="bend" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.8 0 0"/>
  <axis xyz="0 0 1"/><limit lower="-2" upper="2"/></joint>
<joint name="end" type="fixed"><parent link="lower"/><child link="tip"/><origin xyz="0.6 0 0"/></joint>
</robot>
"""
PATH = [[2.0, 5.0], [8.0, 5.0]]


def timeless(value):
    """The document without its times."""
    if isinstance(value, dict):
        return {
            key: timeless(entry)
            for key, entry in value.items()
            if not key.endswith("_s") and "time" not in key and "seconds" not in key and "cpu" not in key
        }
    return [timeless(entry) for entry in value] if isinstance(value, list) else value


def samples(count, seed=1):
    draw = random.Random(seed)
    return [[draw.uniform(1, 7), draw.uniform(4, 6.5)] for _ in range(count)]


def program(*arguments, folder="."):
    done = subprocess.run([PROGRAM, *arguments], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return done.stdout


class Folder(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)

    def file(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")
        return str(self.folder / name)


class Scripts(Folder):
    def test_a_script_gives_its_strategies_problems_and_seeds(self):
        script = trellis.load(self.file("gaps.lua", GAPS))
        self.assertEqual(list(script.strategies), ["rrt", "guided"])  # in the order of the script
        self.assertEqual(list(script.problems), ["trap", "cup"])
        self.assertEqual(script.seeds, [1, 2, 3])
        self.assertEqual(str(script.strategies["guided"]), "skeleton() >> rrt()")
        trap = script.problems["trap"]
        self.assertEqual((trap.names, trap.periodic), (["x", "y", "theta"], [False, False, True]))
        self.assertTrue(trap.valid(trap.start))
        self.assertFalse(trap.valid([-1, 0, 0]))
        with self.assertRaisesRegex(trellis.Error, "has 3 coordinates, got 2"):
            trap.valid([1, 2])

    def test_a_run_of_a_script_gives_what_the_program_writes(self):
        path = self.file("gaps.lua", GAPS)
        program("run", path, "--quiet", "--json", str(self.folder / "results.json"))
        written = json.loads((self.folder / "results.json").read_text())
        result = trellis.run(trellis.load(path))
        self.assertEqual(timeless(result.document), timeless(written))
        self.assertEqual(result.warnings, [])
        result.save(self.folder / "again.json")
        self.assertIn("2 problems, 3 seeds", program("report", str(self.folder / "again.json"), "--report", "costs", "--baseline", "rrt"))

    def test_runs_do_not_depend_on_the_numbers_of_jobs_and_threads(self):
        script = trellis.script(GAPS)
        one = trellis.run(script, jobs=1, measure=False)
        two = trellis.run(script, jobs=2, threads=2, measure=False)
        self.assertEqual(timeless(one.document), timeless(two.document))

    def test_a_part_of_a_script(self):
        script = trellis.script(GAPS)
        result = trellis.run(script, "cup", [7], strategy="rrt", measure=False)
        runs = [(run["problem"], run["strategy"], run["seed"]) for run in result.document["runs"]]
        self.assertEqual(runs, [("cup", "rrt", 7)])

    def test_strategies_and_problems_by_expressions(self):
        guided = trellis.strategy("skeleton() >> rrt { step = 0.5 }")
        self.assertEqual(guided, trellis.script(GAPS).strategies["guided"])
        both = {"plain": "rrt { step = 0.5 }", "guided": guided}
        result = trellis.run(both, trellis.problem("scenes.trap()"), seeds=2, baseline="plain", measure=True)
        self.assertEqual(len(result.document["runs"]), 4)
        self.assertIn("÷ plain's", str(result))
        self.assertTrue(math.isfinite(result.document["measure"]["SE"][0]))

    @unittest.skipUnless(HAS_PANDAS, "pandas is not installed")
    def test_frames(self):
        result = trellis.run(trellis.script(GAPS), "trap")
        runs, levels = result.runs, result.levels
        self.assertEqual(len(runs), 6)
        self.assertEqual(runs["validity_checks"].tolist(), [r["validity_checks"] for r in result.document["runs"]])
        self.assertEqual(sorted(levels[levels.strategy == "guided"].level.unique()), [0, 1])
        self.assertIn("measure.root.tree.self.SE", levels.columns)
        self.assertLessEqual(len(levels.columns), 40)
        self.assertEqual(len(result.summary), 2)
        named = result.levels_by("measure.tree.self.D", "resolved_for.*")
        self.assertEqual(len(named), len(levels))
        self.assertEqual(named["measure.tree.self.D"][0], result.document["measure"]["D"][0])
        self.assertEqual({name for name in named if name.startswith("resolved_for.")},
                         {name for name in result.document["levels"] if name.startswith("resolved_for.")})
        with self.assertRaisesRegex(trellis.Error, "no level has 'measure.tree.self.Dd'; did you mean"):
            result.levels_by("measure.tree.self.Dd")

    @unittest.skipUnless(HAS_MATPLOTLIB and HAS_PANDAS, "matplotlib or pandas is not installed")
    def test_figures(self):
        from trellis import figures

        result = trellis.run(trellis.script(GAPS), "trap", measure=False)
        self.assertEqual(result.figures.costs().get_title(loc="left"), "trap")
        self.assertEqual(figures.read(result).strategies, ["rrt", "guided"])
        with tempfile.TemporaryDirectory() as folder:
            sampled = trellis.run(trellis.script(GAPS), "trap", seeds=1, measure=False, samples=folder)
            self.assertEqual(len(sampled.figures.levels_of_world(strategy="guided")), 2)
            self.assertTrue(os.path.isabs(sampled.document["samples"]))
            pathlib.Path(folder, "file").touch()
            with self.assertRaises(trellis.Error):
                trellis.run("rrt {}", "scenes.cup()", samples=os.path.join(folder, "file", "below"))
        with self.assertRaisesRegex(ValueError, "there are no samples of 'guided' on 'trap'"):
            result.figures.levels_of_world(strategy="guided")
        # What a notebook shows.
        page = result._repr_html_()
        self.assertIn("<pre", page)
        self.assertIn("<svg", page)
        self.assertEqual(page, result._repr_html_())
        with self.assertRaisesRegex(figures.Error, "svg: a figure, or axes of one, is needed"):
            figures.svg(3)
        written = result.figures.save(self.folder / "figures", formats=["svg"], texts=[])
        self.assertIn(self.folder / "figures" / "ratios.svg", written)
        self.assertEqual(result.figures.tables()["costs"]["solved"].tolist(), [3, 3])

    def test_warnings_of_a_script(self):
        text = GAPS.replace("seeds      = 3", "seeds = 1, shortcut = 0").replace("skeleton()", "0.5 * skeleton()")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            result = trellis.run(trellis.script(text), "trap", measure=False)
        self.assertEqual([str(w.message) for w in caught], result.warnings)


class Faults(Folder):
    def test_messages_are_those_of_the_program(self):
        path = self.file("wrong.lua", "local a = rrt { stepp = 1 }\nlocal b = shrinkk(0.5)\nreturn a, scenes.trap()\n")
        done = subprocess.run([PROGRAM, "check", path], capture_output=True, text=True, check=False)
        printed = [line[len("trellis: "):] for line in done.stderr.splitlines()][:2]
        with self.assertRaises(trellis.Error) as caught:
            trellis.load(path)
        self.assertEqual(caught.exception.messages, printed)
        self.assertEqual(str(caught.exception), "\n".join(printed))

    def test_faults_of_calls(self):
        script = trellis.script(GAPS)
        rrt = script.strategies["rrt"]
        for fault, call in {
            "no-such.lua": lambda: trellis.load("no-such.lua"),
            "unknown|undefined|no": lambda: trellis.strategy("rtt {}"),
            "this is no strategy": lambda: trellis.strategy("skeleton()"),
            "call problems": lambda: trellis.problem("{ scenes.trap(), scenes.cup() }"),
            "has no problem 'cap'; it has: trap, cup": lambda: trellis.run(script, "cap"),
            "has no strategy 'x'": lambda: trellis.run(script, strategy="x"),
            "a strategy needs a problem": lambda: trellis.run(rrt),
            "at least 1, got 0": lambda: trellis.run(rrt, "scenes.trap()", 0),
            "an integer in": lambda: trellis.run(rrt, "scenes.trap()", [-1]),
            "a number of seeds": lambda: trellis.run(rrt, "scenes.trap()", "1"),
            "jobs must be": lambda: trellis.run(rrt, "scenes.trap()", jobs=0),
            "threads must be": lambda: trellis.run(rrt, "scenes.trap()", threads=0),
            "ablation must be": lambda: trellis.run(rrt, "scenes.trap()", ablation=-1),
            "cross: the experiment measures nothing": lambda: trellis.run(rrt, "scenes.trap()", measure=False, cross=1),
        }.items():
            with self.subTest(fault), self.assertRaisesRegex(trellis.Error, fault):
                call()

    def test_scripts_are_sandboxed_unless_trusted(self):
        with self.assertRaisesRegex(trellis.Error, "io"):
            trellis.script("io.write('x')\n" + GAPS)
        self.assertEqual(trellis.script("assert(io.open)\n" + GAPS, trust=True).seeds, [1, 2, 3])


class Threads(unittest.TestCase):
    def test_ctrl_c_stops_a_run_and_the_next_one_works(self):
        timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            trellis.run(ENDLESS, BLOCKED, measure=False)
        timer.join()
        self.assertTrue(trellis.run("rrt { step = 0.5 }", "scenes.trap()").document["runs"][0]["solved"])

    def test_ctrl_c_stops_a_script_that_loads(self):
        timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            trellis.script("while true do pcall(error) end")
        timer.join()

    def test_other_threads_run_meanwhile(self):
        class Enough(Exception):
            pass

        counted = 0

        def progress_in_python():
            nonlocal counted
            for counted in range(1, 3000001):
                pass
            os.kill(os.getpid(), signal.SIGINT)

        def handler(number, frame):
            raise Enough

        before = signal.signal(signal.SIGINT, handler)
        thread = threading.Thread(target=progress_in_python)
        try:
            with self.assertRaises(Enough):
                thread.start()
                trellis.run(ENDLESS, BLOCKED, measure=False)
        finally:
            thread.join()
            signal.signal(signal.SIGINT, before)
        self.assertEqual(counted, 3000000)

    def test_progress_is_reported_and_its_exception_stops_the_run(self):
        steps = []
        trellis.run(trellis.script(GAPS), progress=lambda done, of: steps.append((done, of)))
        self.assertEqual(steps[-1][0], steps[-1][1])

        def fail(done, of):
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            trellis.run({"a": "rrt {}", "b": ENDLESS}, ["scenes.trap()", BLOCKED], progress=fail, measure=False)


class Recorders(Folder):
    def case(self, **more):
        """The same case as a file."""
        rows = samples(3000)
        lines = [",".join(repr(x) for x in row) for row in rows]
        self.file("samples.csv", "\n".join(["q1,q2", *lines]) + "\n")
        case = {"dim": 2, "coords": ["q1", "q2"], "weights": [1, 1], "lo": [0, 0], "hi": [10, 10],
                "periodic": [False, False], "path": PATH, "delta": 0.5, "samples": "samples.csv", **more}
        self.file("case.json", json.dumps(case))
        return rows

    def test_figures_are_those_of_the_program(self):
        rows = self.case()
        recorder = trellis.Recorder([0, 0], [10, 10])
        for row in rows:
            recorder.add(row)
        self.assertEqual(len(recorder), 3000)
        found = recorder.measure(PATH, delta=0.5)
        self.assertEqual(found.document, json.loads(program("measure", "case.json", "--json", "-", folder=self.folder)))
        table = program("measure", "case.json", folder=self.folder)
        self.assertEqual(str(found).splitlines()[4:], table.splitlines()[4:])
        for estimator in ("knn", "all"):
            with self.subTest(estimator):
                options = ("--estimator", estimator, "--json", "-")
                printed = json.loads(program("measure", "case.json", *options, folder=self.folder))
                self.assertEqual(recorder.measure(PATH, delta=0.5, estimator=estimator).document, printed)

    def test_figures_and_intervals(self):
        found = trellis.measure(samples(3000), PATH, lo=[0, 0], hi=[10, 10], delta=0.5)
        self.assertAlmostEqual(found.se, found.mass + found.spread)
        self.assertAlmostEqual(found.above_uniform, found.uniform - found.se)
        for value, (lo, hi) in ((found.se, found.se_interval), (found.mass, found.mass_interval),
                                (found.spread, found.spread_interval)):
            self.assertLessEqual(lo, value)
            self.assertLessEqual(value, hi)
        # The interval of the mass by the share of the samples in the target.
        share = found.in_target / found.n
        blurred = 0.95 * share + 0.05 * math.exp(-found.uniform)
        self.assertAlmostEqual(found.mass, -math.log(blurred), places=6)
        self.assertEqual(found.n, 3000)
        self.assertEqual(found.estimator, "knn")
        self.assertIn("SE ", repr(found))

    def test_a_target_without_samples(self):
        found = trellis.measure([[1, 1], [2, 2], [1, 9]], PATH, lo=[0, 0], hi=[10, 10], delta=0.5)
        self.assertIn("censored", found.flags)
        self.assertEqual(found.in_target, 0)
        self.assertTrue(math.isfinite(found.mass_interval[1]))

    @unittest.skipUnless(HAS_NUMPY, "numpy is not installed")
    def test_arrays_of_numpy(self):
        import numpy

        rows = self.case()
        array = numpy.array(rows)
        wide = numpy.zeros((3000, 4))
        wide[:, ::2] = array
        listed = trellis.measure(rows, PATH, lo=[0, 0], hi=[10, 10], delta=0.5).document
        for form in (array, numpy.asfortranarray(array), wide[:, ::2], array[::-1]):
            found = trellis.measure(form, numpy.array(PATH), lo=numpy.zeros(2), hi=numpy.full(2, 10), delta=0.5)
            self.assertEqual(found.document, listed)
        recorder = trellis.Recorder([0, 0], [10, 10])
        recorder.add(array[0])
        recorder.add(array[1:])
        self.assertEqual(recorder.measure(PATH, delta=numpy.float64(0.5)).document, listed)
        for wrong in (numpy.zeros((3, 3)), numpy.zeros((2, 2, 2)), numpy.array([["a", "b"]]), array[0] * math.nan):
            with self.assertRaises(trellis.Error):
                recorder.add(wrong)

    def test_validity_by_a_problem_a_function_and_a_name_agree(self):
        trap = trellis.problem("scenes.trap()")
        path = trellis.run("rrt_connect { step = 0.5 }", trap, measure=False).document["runs"][0]["path"]
        draw = random.Random(3)
        rows = [[draw.uniform(a, b) for a, b in zip(trap.lo, trap.hi)] for _ in range(2000)]
        found = []
        for valid in ({"valid": trap}, {"valid": trap.valid}, {"free": "trap"}):
            recorder = trellis.Recorder(trap.lo, trap.hi, weights=trap.weights, names=trap.names, angles=["theta"],
                                        **valid)
            found.append(recorder.measure(path, delta=0.5, samples=rows).document)
        self.assertEqual(found[0], found[1])
        self.assertEqual(found[0], found[2])
        self.assertLess(found[0]["free_share"], 1)
        self.assertEqual(trellis.Recorder.of(trap).measure(path, delta=0.5, samples=rows).document, found[0])
        self.assertNotIn("invalid path", found[0]["flags"])

    def test_exceptions_of_a_validity_function(self):
        def fail(q):
            raise LookupError("no model")

        recorder = trellis.Recorder([0, 0], [10, 10], valid=fail)
        with self.assertRaisesRegex(LookupError, "no model"):
            recorder.measure(PATH, delta=0.5, samples=samples(10))
        nothing = trellis.Recorder([0, 0], [10, 10], valid=lambda q: False)
        with self.assertRaisesRegex(trellis.Error, "no valid configuration"):
            nothing.measure(PATH, delta=0.5, samples=samples(10))

    def test_robots_of_urdf_files(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "arm.urdf").write_text(ARM, encoding="utf-8")
            arm = trellis.problem(
                """problem {
                  world = world { bounds = {-2, -2, -2, 2, 2, 2}, sphere {-1, 0, 0, 0.2, name = "lamp"} },
                  robot = robot.urdf "arm.urdf", start = {0.3, -0.4}, goal = { swing = 1, bend = 0.5 } }""",
                folder=folder)
        self.assertEqual(arm.goals, [[1.0, 0.5]])
        self.assertEqual(arm.joints(), [
            {"name": "swing", "kind": "continuous", "lower": None, "upper": None, "velocity": 1.5},
            {"name": "bend", "kind": "revolute", "lower": -2.0, "upper": 2.0, "velocity": None}])
        self.assertEqual(arm.fault([0.3, -0.4]), "")
        self.assertIn("bend = 3, expected it in [-2, 2]", arm.fault([0, 3]))
        self.assertIn("is in collision with obstacle 1 (lamp)", arm.fault([math.pi, 0]))
        found = arm.ik("tip", [1.0, 0.5, 0.0], within=(0.001, 4), seed=[0.3, -0.4])
        self.assertTrue(found)
        for q in found:
            self.assertTrue(arm.valid(q))
            x = 0.8 * math.cos(q[0]) + 0.6 * math.cos(q[0] + q[1])
            self.assertAlmostEqual(x, 1.0, delta=0.001)
        self.assertEqual(arm.ik("tip", [5, 0, 0]), [])
        with self.assertRaisesRegex(trellis.Error, "did you mean 'tip'"):
            arm.ik("tpi", [1, 0, 0])
        with self.assertRaisesRegex(trellis.Error, "for robots of URDF files"):
            trellis.problem("scenes.trap()").joints()

    def test_rotations_in_space(self):
        box = trellis.problem("problem { world = world { bounds = {0, 0, 0, 10, 10, 10} },"
                              " robot = robot.rigid { box {-0.3, -0.1, -0.1, 0.3, 0.1, 0.1} },"
                              " start = {2, 5, 5, 0, 0, 0, 1}, goal = {8, 5, 5, 0, 0, 0, 1} }")
        self.assertEqual(len(box.rotations), 1)
        draw = random.Random(3)
        rows = []
        for _ in range(500):
            q = [draw.gauss(0, 1) for _ in range(4)]
            norm = math.sqrt(sum(x * x for x in q))
            rows.append([draw.uniform(2, 8) for _ in range(3)] + [x / norm for x in q])
        found = trellis.Recorder.of(box).measure([box.start, box.goals[0]], delta=1.5, samples=rows)
        self.assertEqual(found.document["outside"], 0)

    def test_faults(self):
        recorder = trellis.Recorder([0, 0], [10, 10])
        for fault, call in {
            "no samples": lambda: recorder.measure(PATH, delta=0.5),
            "has 3 coordinates, not 2": lambda: recorder.add([1, 2, 3]),
            "not finite": lambda: recorder.add([1, math.inf]),
            "must be an array": lambda: recorder.add(["a", "b"]),
            "delta must be": lambda: recorder.measure(PATH, delta=0, samples=samples(3)),
            "K of at least 2": lambda: recorder.measure(PATH[:1], delta=1, samples=samples(3)),
            "lies outside of the space": lambda: recorder.measure([[0, 0], [11, 0]], delta=1, samples=samples(3)),
            "finite": lambda: recorder.measure([[0, 0], [math.nan, 0]], delta=1, samples=samples(3)),
            "within the bounds": lambda: recorder.measure(PATH, delta=1, samples=[[20, 20]]),
            "estimator": lambda: recorder.measure(PATH, delta=1, samples=samples(3), estimator="knm"),
            "lo must be below hi": lambda: trellis.measure([[1]], [[1], [2]], lo=[3], hi=[2], delta=1),
            "hi must be a list of 1": lambda: trellis.measure([[1]], [[1], [2]], lo=[0], hi=[2, 3], delta=1),
            "weights must be greater": lambda: trellis.measure([[1]], [[1], [2]], lo=[0], hi=[2], delta=1, weights=[0]),
            "angles: a coordinate is in": lambda: trellis.Recorder([0], [1], angles=[1]),
            "no coordinate 'z'": lambda: trellis.Recorder([0], [1], angles=["z"]),
            "not both": lambda: trellis.Recorder([0], [1], valid=len, free="trap"),
            "free: ": lambda: trellis.Recorder([0, 0], [9, 9], free="trop").measure(PATH, delta=1, samples=samples(3)),
        }.items():
            with self.subTest(fault), self.assertRaisesRegex(trellis.Error, fault):
                call()


class Package(unittest.TestCase):
    def test_the_version_is_that_of_the_program(self):
        commit = f" ({trellis.commit()})" if trellis.commit() else ""
        self.assertEqual(program("version"), f"trellis {trellis.__version__}{commit}\n")

    def test_the_stub_has_every_name_of_the_native_part(self):
        from trellis import _trellis

        stub = pathlib.Path(trellis.__file__).with_name("_trellis.pyi")
        described = {node.name: node for node in ast.parse(stub.read_text()).body if hasattr(node, "name")}
        there = {name for name in vars(_trellis) if not name.startswith("_")}
        self.assertEqual(there, set(described))
        for name in ("Strategy", "Problem", "Script"):
            members = {node.name for node in described[name].body if isinstance(node, ast.FunctionDef)}
            found = {member for member in vars(getattr(_trellis, name)) if not member.startswith("_")}
            self.assertEqual(found, {member for member in members if not member.startswith("_")})
        self.assertTrue(stub.with_name("py.typed").exists())

    def test_every_public_name_is_documented(self):
        for name in trellis.__all__:
            value = getattr(trellis, name)
            self.assertTrue(value.__doc__, name)
            if value.__module__ == "trellis._recorder" or name in ("Result",):
                for member, function in vars(value).items() if isinstance(value, type) else ():
                    if not member.startswith("_"):
                        self.assertTrue(function.__doc__, f"{name}.{member}")


@unittest.skipUnless(HAS_NUMPY and HAS_PANDAS, "numpy and pandas are not installed")
class Frames(unittest.TestCase):
    def setUp(self):
        import numpy

        self.rows = numpy.random.default_rng(1).uniform([0, 0], [10, 2], (200, 2))
        self.path = [[1, 1], [9, 1]]

    def recorder(self):
        return trellis.Recorder(lo=[0, 0], hi=[10, 2], names=["x", "y"])

    def test_columns_are_read_by_their_names(self):
        import pandas

        frame = pandas.DataFrame(self.rows, columns=["x", "y"])
        plain = self.recorder().measure(self.path, delta=0.3, samples=self.rows)
        for samples in (frame, frame[["y", "x"]], pandas.DataFrame(self.rows)):
            path = pandas.DataFrame(self.path, columns=["x", "y"])[["y", "x"]]
            self.assertEqual(self.recorder().measure(path, delta=0.3, samples=samples).document, plain.document)
        with self.assertRaisesRegex(trellis.Error, "one column for each coordinate; y is not there once; it has x, z"):
            self.recorder().add(frame.rename(columns={"y": "z"}))
        with self.assertRaisesRegex(trellis.Error, "other columns: t"):
            self.recorder().add(frame.assign(t=0.0))

    def test_the_rule_of_scale(self):
        for changes, delta, fault in [({"hi": [10, 1e308]}, 0.3, "keep q2 within 1e\\+09 m"),
                                      ({"weights": [1e300, 1]}, 0.3, "keep q1 within 1e\\+09 m"), ({}, 5e-324, "delta is")]:
            recorder = trellis.Recorder(**{"lo": [0, 0], "hi": [10, 2], **changes})
            recorder.add(self.rows)
            with self.assertRaisesRegex(trellis.Error, fault):
                recorder.measure(self.path, delta=delta)

    def test_other_numbers(self):
        import numpy

        recorder = self.recorder()
        with self.assertRaisesRegex(trellis.Error, "masked"):
            recorder.add(numpy.ma.masked_greater(self.rows, 5.0))
        recorder.add(numpy.ma.masked_greater(self.rows, 50.0))
        self.assertEqual(len(recorder), 200)
        with self.assertRaisesRegex(trellis.Error, "must be an array of N rows of 2 numbers"):
            recorder.add([[10 ** 400, 1]])
        with self.assertRaisesRegex(trellis.Error, r"a path is of shape \(K, 2\)"):
            recorder.measure([1.0, 1.0], delta=0.3)
        with self.assertRaisesRegex(trellis.Error, "has 4 coordinates, not 2"):
            recorder.measure([1.0, 1.0, 9.0, 1.0], delta=0.3)
        with self.assertRaisesRegex(trellis.Error, "'seed' must be an integer, got 1.5"):
            recorder.measure(self.path, delta=0.3, seed=1.5)
        self.assertEqual(recorder.measure(self.path, delta=0.3, seed=numpy.int64(1)).document,
                         recorder.measure(self.path, delta=0.3).document)
        self.assertEqual(trellis.Recorder([0, -3], [1, 3], angles=[numpy.int32(1)])._space["periodic"], [False, True])
        with self.assertRaisesRegex(trellis.Error, "there are no samples"):
            self.recorder().measure(self.path, delta=0.3)


class Exit(unittest.TestCase):
    def test_a_daemon_thread_that_plans_ends_with_the_interpreter(self):
        for call in ("trellis.run('rrt {}', 'scenes.cup()', 100000, measure=False)",
                     "[trellis.Sampler('shrink(0.5)', trellis.problem('scenes.cup()'), s).draw() for s in range(10 ** 6)]"):
            code = "import trellis, threading, time\n" \
                   f"threading.Thread(target=lambda: {call}, daemon=True).start()\n" \
                   "time.sleep(0.3)\nprint('exiting')\n"
            done = subprocess.run([sys.executable, "-B", "-c", code], capture_output=True, text=True, check=False, timeout=60)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "exiting\n", ""))


if __name__ == "__main__":
    unittest.main()

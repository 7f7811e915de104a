# SPDX-License-Identifier: GPL-3.0-or-later
"""wheel.py SOURCE BUILD: `pip install` makes a wheel of the package without a network, and what it installs plans and
measures. Exits with 77, which ctest reports as skipped, without pip."""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile

SKIPPED = 77
USE = """
import trellis
assert trellis.__file__.startswith({folder!r}), trellis.__file__
assert trellis.run("rrt {{ step = 0.5 }}", "scenes.trap()", measure=False).document["runs"][0]["solved"]
recorder = trellis.Recorder([0, 0], [10, 10])
recorder.add([[5 + i / 100, 5] for i in range(20)])
assert recorder.measure([[2, 5], [8, 5]], delta=0.5).in_target == 20
"""


def main():
    if importlib.util.find_spec("pip") is None:
        print("skipped: there is no pip; python3-pip is needed")
        return SKIPPED
    source, build = sys.argv[1:]
    environment = dict(os.environ, TRELLIS_BUILD=build, PIP_NO_INDEX="1", PIP_DISABLE_PIP_VERSION_CHECK="1")
    environment.pop("PYTHONPATH", None)
    with tempfile.TemporaryDirectory() as place:
        folder = str(pathlib.Path(place).resolve() / "installed")
        install = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", folder, source]
        subprocess.run(install, check=True, env=environment, cwd=place)
        found = sorted(path.name for path in (pathlib.Path(folder) / "trellis").glob("*"))
        for name in ("__init__.py", "_trellis.pyi", "py.typed", "figures"):
            assert name in found, found
        sources = sorted(path.name for path in (pathlib.Path(source) / "python/trellis/figures").glob("*.py"))
        installed = sorted(path.name for path in (pathlib.Path(folder) / "trellis/figures").glob("*.py"))
        assert installed == sources, installed
        if os.access(os.path.join(build, "trellis-mesh"), os.X_OK):
            # What converts COLLADA is beside the library that looks for it.
            assert os.access(os.path.join(folder, "trellis", "trellis-mesh"), os.X_OK), found
        use = [sys.executable, "-c", USE.format(folder=folder)]
        subprocess.run(use, check=True, env=dict(environment, PYTHONPATH=folder), cwd=place)
    return 0


sys.exit(main())

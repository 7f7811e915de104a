# SPDX-License-Identifier: MIT-0
"""The build backend of `pip install .` (PEP 517): builds the package by CMake and packs it as a wheel.

It builds in build/release where that was configured for the same Python, else in build/python-CACHE_TAG, which takes as
long as a build of Trellis. TRELLIS_BUILD names another folder, TRELLIS_JOBS the number of jobs (default 2).
"""
import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent


def _version():
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"^project\(trellis VERSION ([0-9.]+)", text, re.M).group(1)


def _metadata():
    return (
        f"Metadata-Version: 2.1\nName: trellis\nVersion: {_version()}\n"
        "Summary: Guiding spaces for motion planning: run Trellis scripts, and score the samples of any planner\n"
        "License: GPL-3.0-or-later AND MIT-0\nRequires-Python: >=3.8\nProvides-Extra: frames\n"
        "Requires-Dist: pandas; extra == 'frames'\nProvides-Extra: figures\n"
        "Requires-Dist: matplotlib; extra == 'figures'\nRequires-Dist: numpy; extra == 'figures'\n"
        "Requires-Dist: pandas; extra == 'figures'\n"
    )


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = re.sub("[-.]", "_", sysconfig.get_platform())
    return f"{python}-{python}-{platform}"


def _wheel():
    return f"Wheel-Version: 1.0\nGenerator: trellis\nRoot-Is-Purelib: false\nTag: {_tag()}\n"


def _built():
    """Builds the package and returns its folder."""
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    given = os.environ.get("TRELLIS_BUILD")
    build = pathlib.Path(given) if given else ROOT / "build" / "release"
    if not given and not (build / "python" / "trellis" / f"_trellis{suffix}").exists():
        build = ROOT / "build" / f"python-{sys.implementation.cache_tag}"
    if not (build / "build.ninja").exists():
        configure = ["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                     "-DTRELLIS_BENCH=OFF", f"-DPython_EXECUTABLE={sys.executable}"]
        subprocess.run(configure, check=True)
    jobs = os.environ.get("TRELLIS_JOBS", "2")
    subprocess.run(["cmake", "--build", build, "--target", "trellis_python", "-j", jobs], check=True)
    folder = build / "python" / "trellis"
    if not (folder / f"_trellis{suffix}").exists():
        raise SystemExit(f"{build} is configured for another Python; name another folder in TRELLIS_BUILD")
    return folder


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Writes the wheel and returns its name."""
    folder = _built()
    name = f"trellis-{_version()}"
    wheel = f"{name}-{_tag()}.whl"
    sources = [path for path in sorted(folder.rglob("*")) if path.is_file() and "__pycache__" not in path.parts]
    files = [(f"trellis/{path.relative_to(folder).as_posix()}", path.read_bytes()) for path in sources]
    converter = folder.parent.parent / "trellis-mesh"  # of COLLADA; not built without assimp
    if converter.exists():
        files.append((f"trellis/{converter.name}", converter.read_bytes()))
    files += [
        (f"{name}.dist-info/METADATA", _metadata().encode()),
        (f"{name}.dist-info/WHEEL", _wheel().encode()),
        (f"{name}.dist-info/licenses/MIT-0.txt", (ROOT / "LICENSES" / "MIT-0.txt").read_bytes()),
        (f"{name}.dist-info/licenses/LICENSE", (ROOT / "LICENSE").read_bytes()),
    ]
    record = f"{name}.dist-info/RECORD"
    lines = []
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, content in files:
            entry = zipfile.ZipInfo(path)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if path.endswith(f"/{converter.name}") else 0o100644) << 16
            archive.writestr(entry, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            lines.append(f"{path},sha256={digest},{len(content)}")
        archive.writestr(record, "\n".join([*lines, f"{record},,"]) + "\n")
    return wheel


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Writes the metadata without a build."""
    folder = pathlib.Path(metadata_directory) / f"trellis-{_version()}.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text(_metadata(), encoding="utf-8")
    (folder / "WHEEL").write_text(_wheel(), encoding="utf-8")
    return folder.name


def build_sdist(sdist_directory, config_settings=None):
    """There is none: the sources are the git repository."""
    raise NotImplementedError("build a wheel from a clone of the repository")

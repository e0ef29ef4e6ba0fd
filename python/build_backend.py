"""The build backend of `pip install .` (PEP 517): CMake builds and installs the package, and this module packs it into
a wheel.

It needs the system packages that scripts/setup installs, and no package from PyPI. It builds in the folder build/pip
and reuses this folder, so that a second build is fast. With `--config-settings build-dir=build/release` it builds in
the given folder, which must already be configured.
"""

import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
SUMMARY = "Massively multi-robot simulation, the same bits on any number of threads"


def version():
    return re.search(r"project\(troupe VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]


def configure(build):
    environment = dict(os.environ)
    if shutil.which("ccache"):
        environment.update(CMAKE_C_COMPILER_LAUNCHER="ccache", CMAKE_CXX_COMPILER_LAUNCHER="ccache")
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    options = ["CMAKE_BUILD_TYPE=Release", "TROUPE_TESTS=OFF", "TROUPE_PERF=OFF", "TROUPE_PYTHON=REQUIRED",
               f"Python_EXECUTABLE={sys.executable}"]
    subprocess.run(["cmake", "-S", ROOT, "-B", build, *generator, *(f"-D{option}" for option in options)],
                   check=True, env=environment)


def tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    return f"{python}-{python}-{platform}"


def metadata():
    return (f"Metadata-Version: 2.1\nName: troupe\nVersion: {version()}\nSummary: {SUMMARY}\nLicense: Apache-2.0\n"
            "Requires-Python: >=3.9\nRequires-Dist: numpy<2\nDescription-Content-Type: text/markdown\n\n"
            + (ROOT / "README.md").read_text())


def pack(folder, wheel):
    """Packs the files of a folder, the metadata and a RECORD (the list of all files) into a wheel. Files are sorted
    by name and have no dates, so that equal builds give equal wheels."""
    info = f"troupe-{version()}.dist-info"
    (folder / info).mkdir()
    (folder / info / "METADATA").write_text(metadata())
    (folder / info / "WHEEL").write_text(
        f"Wheel-Version: 1.0\nGenerator: troupe\nRoot-Is-Purelib: false\nTag: {tag()}\n")
    shutil.copy(ROOT / "LICENSE", folder / info)
    record = []
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        def add(name, content):
            entry = zipfile.ZipInfo(name)
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)

        for file in sorted(path for path in folder.rglob("*") if path.is_file()):
            name, content = file.relative_to(folder).as_posix(), file.read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{name},sha256={digest},{len(content)}\n")
            add(name, content)
        add(f"{info}/RECORD", "".join(record) + f"{info}/RECORD,,\n")


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    given = (config_settings or {}).get("build-dir")
    build = (ROOT / given) if given else ROOT / "build" / "pip"
    if not given:
        configure(build)
    subprocess.run(["cmake", "--build", build, "--target", "troupe_python"], check=True)
    name = f"troupe-{version()}-{tag()}.whl"
    with tempfile.TemporaryDirectory() as scratch:
        subprocess.run(["cmake", "--install", build, "--component", "python", "--prefix", scratch],
                       check=True, stdout=subprocess.DEVNULL)
        installed = re.search(r"^TROUPE_PYTHON_INSTALL_DIR:\w+=(.*)$", (build / "CMakeCache.txt").read_text(), re.M)[1]
        pack(pathlib.Path(scratch) / installed, pathlib.Path(wheel_directory) / name)
    return name


def build_sdist(sdist_directory, config_settings=None):
    raise RuntimeError("Troupe has no source distribution: use an archive of the repository (git archive)")

#!/usr/bin/env python3
"""Runs a command as on a fresh Debian on which scripts/setup has installed what Troupe needs, and nothing else.

    bare_environment.py COMMAND [ARGUMENT...]

The command finds in PATH only programs of the packages that scripts/setup installs, of the packages that these need, and of
every Debian system; and in Debian's Python only the modules of these packages. Programs that it starts by their full path,
and shared libraries, are those of this machine.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODULES = pathlib.Path("/usr/lib/python3/dist-packages")
# A clone needs the first two; the last starts these packages.
FRESH = ("git", "ca-certificates", "apt")

HIDE = """
import importlib.machinery
import sys


class PathFinder(importlib.machinery.PathFinder):
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        return None if name.partition(".")[0] in {names!r} else super().find_spec(name, path, target)


sys.meta_path[:] = [PathFinder if finder is importlib.machinery.PathFinder else finder for finder in sys.meta_path]
"""


def installed():
    """Returns the packages that provide a name: {name: [packages]}; what
    each package needs: {package: [[alternatives]]}; and the packages that every system has."""
    form = "${db:Status-Status}\t${Package}\t${Essential}\t${Priority}\t${Depends}, ${Pre-Depends}\t${Provides}\n"
    lines = subprocess.run(["dpkg-query", "-W", "-f", form], check=True, capture_output=True, text=True).stdout.splitlines()
    provided, needed, always = {}, {}, set()
    for status, package, essential, priority, depends, provides in (line.split("\t") for line in lines):
        if status != "installed":
            continue
        names = lambda text: re.findall(r"[\w.+-]+", re.sub(r"\([^)]*\)|:\w+", "", text))
        needed[package] = [names(each) for each in depends.split(",") if names(each)]
        for name in (package, *names(provides)):
            provided.setdefault(name, []).append(package)
        if essential == "yes" or priority == "required":
            always.add(package)
    return provided, needed, always


def packages():
    """Returns the packages that a fresh system has after scripts/setup."""
    provided, needed, always = installed()
    listed = subprocess.run([ROOT / "scripts" / "setup", "--list"], check=True, capture_output=True, text=True).stdout.split()
    waiting, found = [*always, *FRESH, *listed], set()
    while waiting:
        for package in provided.get(waiting.pop(), ()):
            if package not in found:
                found.add(package)
                waiting += [name for alternatives in needed[package] for name in alternatives]
    return found


def main():
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        sys.exit("usage: bare_environment.py COMMAND [ARGUMENT...]")
    owned = set(subprocess.run(["dpkg-query", "-L", *sorted(packages())], check=True, capture_output=True, text=True).stdout.split("\n"))
    owned |= {os.path.realpath(file) for file in owned if "/bin/" in file or "/sbin/" in file}
    with tempfile.TemporaryDirectory(prefix="troupe_bare_") as folder:
        programs = pathlib.Path(folder) / "bin"
        modules = pathlib.Path(folder) / "python"
        programs.mkdir()
        modules.mkdir()
        for file in (file for place in ("/usr/bin", "/usr/sbin") for file in sorted(pathlib.Path(place).iterdir())):
            if str(file) in owned or f"/{file.relative_to('/usr')}" in owned or os.path.realpath(file) in owned:
                (programs / file.name).symlink_to(file)
        names = {entry.name.partition(".")[0] for entry in MODULES.iterdir()}
        names -= {file[len(f"{MODULES}/"):].partition("/")[0].partition(".")[0] for file in owned if file.startswith(f"{MODULES}/")}
        (modules / "sitecustomize.py").write_text(HIDE.format(names=names))
        environment = {**os.environ, "PATH": str(programs),
                       "PYTHONPATH": os.pathsep.join(filter(None, (str(modules), os.environ.get("PYTHONPATH"))))}
        return subprocess.run(sys.argv[1:], env=environment).returncode


if __name__ == "__main__":
    sys.exit(main())

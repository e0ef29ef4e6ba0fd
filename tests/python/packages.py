"""Installs packages of the Python Package Index for tests that need them: in a virtual environment in the build folder, which
is made at the first use and also has the packages of the interpreter.

    packages.py    makes the virtual environment if it does not exist, and prints the path of its interpreter
"""

import fcntl
import os
import pathlib
import subprocess
import sys

import troupe

#: The versions that the documentation names.
PACKAGES = ("gymnasium==1.4.0", "pettingzoo==1.27.0", "cma==4.5.0")


def environment():
    """Returns the folder of the virtual environment."""
    return pathlib.Path(troupe.__file__).parents[4] / f"python_packages-{sys.version_info[0]}.{sys.version_info[1]}"


def python_with_packages():
    """Returns the interpreter of the virtual environment, which is made if it does not exist. If the packages cannot be
    installed, prints the reason and ends with 77 (skipped)."""
    folder = environment()
    python = folder / "bin" / "python3"
    made = folder / "made"
    with open(folder.parent / f"{folder.name}.lock", "w") as lock:  # ctest runs several tests that need the packages at the same time
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (made.exists() and made.read_text() == " ".join(PACKAGES)):
            try:
                subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", folder], check=True, capture_output=True)
                pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--retries", "1", *PACKAGES]
                subprocess.run(pip, check=True, capture_output=True, text=True, timeout=600)
            except (subprocess.CalledProcessError, subprocess.TimeoutExpired, OSError) as error:
                last = (getattr(error, "stderr", None) or str(error)).strip().splitlines()[-1:]
                print(f"SKIPPED: {', '.join(PACKAGES)} could not be installed: {' '.join(map(str, last))}")
                sys.exit(77)
            made.write_text(" ".join(PACKAGES))
    return python


def run_with_packages():
    """Runs this program again in the virtual environment, and ends with its exit status; in the virtual environment, only
    returns. Ends with 77 (skipped) as python_with_packages() does."""
    if pathlib.Path(sys.prefix) != environment():
        python = python_with_packages()
        os.execv(python, [str(python), *sys.argv])


if __name__ == "__main__":
    print(python_with_packages())

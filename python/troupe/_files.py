"""Finds the files that come with the package."""

import pathlib

_PACKAGE = pathlib.Path(__file__).parent  # not resolved: in a build tree this file is a link
_SOURCE = pathlib.Path(__file__).resolve().parent


def _roots() -> "list[pathlib.Path]":
    """Returns the folders below which the files of an installation may be: the package itself (a wheel has them there)
    and, if the package is in PREFIX/lib/python3/dist-packages, the folder PREFIX of an installation or a build tree."""
    is_below_prefix = _PACKAGE.parts[-4:-1] == ("lib", "python3", "dist-packages")
    return [_PACKAGE, *([_PACKAGE.parents[3]] if is_below_prefix else [])]


def _first(what: str, file: str, folders: "list[pathlib.Path]") -> pathlib.Path:
    for folder in folders:
        if (folder / file).is_file():
            return folder
    raise FileNotFoundError(
        f"this installation of troupe has no {what}: there is no {file} in " + ", ".join(map(str, folders))
        + "; wheels, and the prefix of cmake --install, contain it")


def cmake_dir() -> pathlib.Path:
    """Returns the folder for CMake's option -Dtroupe_DIR=, with which find_package(troupe) finds this installation. The
    CMake package of a wheel contains what plug-ins need; that of a build tree or an installation from source contains
    the whole library. Raises FileNotFoundError if the installation has no CMake package, as after `pip install .`."""
    roots = _roots()
    return _first("CMake package", "troupe-config.cmake", [*(root / "lib" / "cmake" / "troupe" for root in roots), *roots[1:]])


def worlds_dir() -> pathlib.Path:
    """Returns the folder of the worlds that come with Troupe, for example
    `troupe.Simulation(troupe.worlds_dir() / "hospital.json")`. Raises FileNotFoundError if the installation has no
    worlds."""
    folders = [root / "share" / "troupe" / "worlds" for root in _roots()]
    return _first("worlds", "hospital.json", [*folders, _SOURCE.parents[1] / "worlds"])

#!/usr/bin/env python3
"""Tests that scripts/debian-mirror and scripts/sysroot use only the sources and proxies with which apt is configured.

The tests configure apt with their own sources and proxies (APT_CONFIG), so they need no network.
"""

import hashlib
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
SKIPPED = 77  # ctest's SKIP_RETURN_CODE


class Apt(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "parts").mkdir()
        self.configure("")

    def configure(self, settings):
        (self.folder / "apt.conf").write_text(
            f'Dir::Etc::parts "/dev/null";\nDir::Etc::main "/dev/null";\n'
            f'Dir::Etc::sourcelist "{self.folder}/sources.list";\nDir::Etc::sourceparts "{self.folder}/parts";\n{settings}\n')

    def write(self, file, text):
        (self.folder / file).write_text(text)

    def call(self, script, *arguments):
        environment = {**os.environ, "APT_CONFIG": str(self.folder / "apt.conf"), "LC_ALL": "C"}
        return subprocess.run([ROOT / "scripts" / script, *arguments], capture_output=True, text=True, env=environment)


class Mirror(Apt):
    def found(self, suite="bookworm"):
        done = self.call("debian-mirror", suite)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr, "")
        return done.stdout.split("\n")[:2]

    def error(self, suite="bookworm"):
        done = self.call("debian-mirror", suite)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        return done.stderr

    def test_of_one_line_sources(self):
        self.write("sources.list", "# deb http://comment.example/debian bookworm main\n"
                                   "deb-src http://sources.example/debian bookworm main\n"
                                   "deb http://later.example/debian bookworm-updates main\n"
                                   "deb http://others.example/debian bookworm contrib\n"
                                   "deb [trusted=yes] http://first.example:8080/a/debian bookworm contrib main  # this\n"
                                   "deb http://second.example/debian bookworm main\n")
        self.assertEqual(self.found(), ["http://first.example:8080/a/debian/", ""])
        self.assertEqual(self.found("bookworm-updates"), ["http://later.example/debian/", ""])

    def test_of_deb822_sources(self):
        self.write("parts/debian.sources", "Types: deb\n# http://comment.example/debian\nEnabled: no\n"
                                           "URIs: http://disabled.example/debian\nSuites: bookworm\nComponents: main\n\n"
                                           "Types: deb-src deb\nURIs: https://first.example/debian\n http://second.example/debian\n"
                                           "Suites: bookworm bookworm-updates\nComponents: main\n")
        self.assertEqual(self.found(), ["https://first.example/debian/", ""])
        self.assertEqual(self.found("bookworm-updates"), ["https://first.example/debian/", ""])

    def test_of_a_list_beside_the_list(self):
        self.write("parts/more.list", "deb file:/srv/debian bookworm main\n")
        self.assertEqual(self.found(), ["file:/srv/debian/", ""])

    def test_that_debootstrap_cannot_read_is_passed_over(self):
        self.write("sources.list", "deb cdrom:[Debian]/ bookworm main\ndeb http://first.example/debian bookworm main\n")
        self.assertEqual(self.found()[0], "http://first.example/debian/")

    def test_proxies_are_those_of_apt(self):
        self.write("sources.list", "deb http://first.example/debian bookworm main\n"
                                   "deb https://secure.example/debian trixie main\ndeb http://near.example:81/ sid main\n")
        self.configure('Acquire::http::Proxy "http://proxy.example:3128";\nAcquire::http::Proxy::near.example "DIRECT";\n')
        self.assertEqual(self.found()[1], "http://proxy.example:3128")
        self.assertEqual(self.found("trixie")[1], "")
        self.assertEqual(self.found("sid"), ["http://near.example:81/", ""])

    def test_no_source_is_an_error(self):
        self.assertEqual(self.error(), "scripts/debian-mirror: error: apt has no source of the suite bookworm with the component "
                                       "main and a URI that begins with http:, https: or file:, in "
                                       f"{self.folder}/sources.list and {self.folder}/parts/; found: none\n")
        self.write("sources.list", "deb http://first.example/debian trixie main contrib\n")
        self.assertIn("; found: http://first.example/debian/ trixie main, http://first.example/debian/ trixie contrib\n",
                      self.error())

    def test_arguments(self):
        for arguments in ([], ["--all"], ["bookworm", "main"]):
            done = self.call("debian-mirror", *arguments)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (2, "", "usage: scripts/debian-mirror SUITE\n"))


class Sysroot(Apt):
    def repository(self):
        """Makes an apt repository with one arm64 package, in a folder."""
        package = self.folder / "package"
        (package / "DEBIAN").mkdir(parents=True)
        (package / "usr/lib").mkdir(parents=True)
        control = "Package: little\nVersion: 1.0\nArchitecture: arm64\nMaintainer: none <none@example>\nDescription: little\n"
        (package / "DEBIAN/control").write_text(control)
        (package / "usr/lib/little").write_text("it is here\n")
        (package / "usr/lib/link").symlink_to("/usr/lib/little")
        source = self.folder / "source"
        source.mkdir()
        archive = source / "little.deb"
        subprocess.run(["dpkg-deb", "--build", "--root-owner-group", package, archive], check=True, capture_output=True)
        data = archive.read_bytes()
        (source / "Packages").write_text(
            f"{control}Filename: ./little.deb\nSize: {len(data)}\nSHA256: {hashlib.sha256(data).hexdigest()}\n")
        return source

    def test_is_unpacked_from_the_sources_of_apt(self):
        self.write("parts/own.sources", f"Types: deb\nURIs: file:{self.repository()}\nSuites: ./\nTrusted: yes\n")
        done = self.call("sysroot", "arm64", self.folder / "root", "little")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((self.folder / "root/packages.txt").read_text(), "little\nlittle 1.0 arm64\n")
        self.assertEqual((self.folder / "root/usr/lib/link").read_text(), "it is here\n")

    def test_no_source_of_the_architecture_is_an_error(self):
        for sources in ("", "deb [arch=amd64] http://first.example/debian bookworm main\n"):
            self.write("sources.list", sources)
            done = self.call("sysroot", "arm64", self.folder / "root", "little")
            self.assertEqual(done.returncode, 2)
            self.assertEqual(done.stderr, "scripts/sysroot: error: apt has no source of packages of arm64 in "
                                          f"{self.folder}/sources.list and {self.folder}/parts/\n")
            self.assertEqual([entry.name for entry in self.folder.glob("root*")], [])


class Tree(unittest.TestCase):
    def test_names_no_mirror(self):
        host = b"debian" + b".org"
        listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], capture_output=True)
        if listed.returncode != 0:
            self.skipTest("not a clone")
        files = [ROOT / name for name in listed.stdout.decode().split("\0") if name]
        found = [str(file.relative_to(ROOT)) for file in files if file.is_file() and host in file.read_bytes()]
        self.assertEqual(found, [])


if __name__ == "__main__":
    if not shutil.which("apt-get") or not shutil.which("dpkg-deb"):
        print("SKIPPED: no apt and dpkg: nothing to take sources from")
        sys.exit(SKIPPED)
    unittest.main()

#!/usr/bin/env python3
"""Tests one world on two computers (*nodes*), which this machine imitates: each node is a set of network, host name, mount
and IPC namespaces, with its own address, /tmp and /dev/shm. The launchers reach the other node with nsenter, not ssh.

    two_nodes_test.py PROGRAM    PROGRAM: the program `troupe`, in the folder of its modules for MPI; not in /tmp

Exits with 77 if the system allows no namespaces, or if no MPI is installed.
"""

import contextlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from tests.support import room  # noqa: E402

PROGRAM = None
MARGIN_S = 240  # for a busy machine

AGENT = """#!/bin/sh
# AGENT [OPTION...] HOST COMMAND...: as ssh
while [ "${1#-}" != "$1" ]; do shift; done
case $1 in NODES *) echo "agent: unknown host $1" >&2; exit 1 ;; esac
shift
exec nsenter --target "$process" --net --uts --mount --ipc --wd="$PWD" /bin/sh -c "$*"
"""


class Node:
    """An imitated computer: a process that keeps its namespaces alive."""

    def __init__(self, name, address, folder):
        self.name, self.address = name, address
        script = (f"hostname {name} && mount -t tmpfs tmpfs /tmp && mount -t tmpfs tmpfs /dev/shm && "
                  f"mount --bind {folder}/hosts /etc/hosts && mount -t sysfs sysfs /sys && "  # where UCX looks for network devices
                  "ip link set lo up && echo ready && exec sleep infinity")
        self.holder = subprocess.Popen(["unshare", "--net", "--uts", "--mount", "--ipc", "--propagation", "private", "sh", "-c", script],
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if self.holder.stdout.readline() != "ready\n":
            self.holder.kill()
            reason = self.holder.communicate()[1].strip()
            raise unittest.SkipTest(f"NOT TESTED: this machine gives no namespaces: {reason}")
        self.net = os.readlink(f"/proc/{self.holder.pid}/ns/net")

    def command(self, *words):
        return ["nsenter", "--target", str(self.holder.pid), "--net", "--uts", "--mount", "--ipc", *words]

    def do(self, *words):
        return subprocess.run(self.command(*words), check=True, capture_output=True, text=True).stdout

    def processes(self, program=None):
        """Returns the processes of the node, or only those of a program."""
        found = []
        for process in pathlib.Path("/proc").iterdir():
            with contextlib.suppress(OSError):
                if process.name.isdigit() and os.readlink(process / "ns" / "net") == self.net:
                    if program is None or os.readlink(process / "exe") == os.path.realpath(program):
                        found.append(int(process.name))
        return found

    def end(self):
        for process in self.processes():
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        self.holder.communicate()


def lines_of(log):
    return [line for line in log.read_text().splitlines() if not line.startswith("#")]


class OnTwoNodes:
    """The tests of one MPI."""

    mpi = None

    @classmethod
    def setUpClass(cls):
        cls.launcher = shutil.which(f"mpirun.{cls.mpi}")
        if cls.launcher is None or not (pathlib.Path(PROGRAM).parent / f"libtroupe_mpi_{cls.mpi}.so").exists():
            raise unittest.SkipTest(f"NOT TESTED: {cls.mpi}: its mpirun or its module is missing (scripts/setup --mpi)")
        if pathlib.Path(PROGRAM).resolve().is_relative_to("/tmp"):
            raise unittest.SkipTest(f"NOT TESTED: {PROGRAM} is in /tmp, and each node has a /tmp of its own")
        for tool in ("unshare", "nsenter", "ip"):
            if shutil.which(tool) is None:
                raise unittest.SkipTest(f"NOT TESTED: the program {tool} is missing")

    def setUp(self):
        # Not in /tmp, because each node has its own /tmp.
        scratch = tempfile.TemporaryDirectory(dir="/var/tmp")
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        (self.folder / "room.json").write_text(json.dumps(room.WORLD))
        addresses = {"troupe-a": "10.77.3.1", "troupe-b": "10.77.3.2"}
        (self.folder / "hosts").write_text("127.0.0.1 localhost\n" + "".join(f"{a} {name}\n" for name, a in addresses.items()))
        self.nodes = []
        for name, address in addresses.items():
            self.nodes.append(Node(name, address, self.folder))
            self.addCleanup(self.nodes[-1].end)
        first, second = self.nodes
        done = subprocess.run(["ip", "link", "add", "link0", "netns", str(first.holder.pid), "type", "veth",
                               "peer", "name", "link0", "netns", str(second.holder.pid)], capture_output=True, text=True)
        if done.returncode != 0:
            self.skipTest(f"NOT TESTED: this machine gives no virtual network: {done.stderr.strip()}")
        for node in self.nodes:
            node.do("ip", "address", "add", f"{node.address}/24", "dev", "link0")
            node.do("ip", "link", "set", "link0", "up")
        self.wait_for_link()
        agent = self.folder / "agent"
        agent.write_text(AGENT.replace("NODES", " ".join(f"{node.name}) process={node.holder.pid} ;;" for node in self.nodes)))
        agent.chmod(0o755)

    def environment(self):
        own = {name: value for name, value in os.environ.items()
               if not name.startswith(("OMPI_", "PMI", "SLURM_", "TROUPE_", "TMP"))}
        return {**own, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}

    def on_nodes(self, ranks_per_node, *arguments):
        """Returns a command for the first node that starts ranks on both nodes."""
        launch = [self.launcher, *self.launcher_options(ranks_per_node), PROGRAM, *map(str, arguments)]
        return self.nodes[0].command(f"--wd={self.folder}", *launch)

    def call(self, command):
        done = subprocess.run(command, capture_output=True, text=True, cwd=self.folder, timeout=300, env=self.environment())
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done

    def wait_until(self, what, condition, seconds):
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.05)

    def wait_for_link(self):
        self.wait_until("the link does not come up",
                        lambda: all(node.do("cat", "/sys/class/net/link0/operstate") == "up\n" for node in self.nodes), MARGIN_S)

    def test_one_hash(self):
        self.call([PROGRAM, "run", "room.json", "--threads", "1", "--hash-log", "one.log", "--quiet"])
        done = self.call(self.on_nodes(2, "run", "room.json", "--threads", 1, "--hash-log", "two.log", "--json"))
        summary = json.loads(done.stdout)
        self.assertEqual((summary["ranks"], summary["nodes"]), (4, 2))
        self.assertEqual(len(lines_of(self.folder / "one.log")), 31)
        self.assertEqual(lines_of(self.folder / "two.log"), lines_of(self.folder / "one.log"))

    def test_a_study(self):
        (self.folder / "study.json").write_text(json.dumps(room.STUDY))
        self.call([PROGRAM, "sweep", "study.json", "-o", "one", "--quiet"])
        self.call(self.on_nodes(1, "sweep", "study.json", "-o", "two", "--threads", 1, "--quiet"))
        self.assertEqual((self.folder / "two" / "table.csv").read_text(), (self.folder / "one" / "table.csv").read_text())

    def test_a_cut_link_ends_all_processes(self):
        limit_s = 3
        run = subprocess.Popen(self.on_nodes(2, "run", "room.json", "--threads", 1, "--for", 1e6, "--checkpoint", "run.h5",
                                             "--checkpoint-every", 1, "--rank-limit", limit_s, "--quiet"),
                               cwd=self.folder, env=self.environment(), text=True, stderr=subprocess.PIPE)
        self.addCleanup(run.stderr.close)
        self.addCleanup(run.kill)
        saved = self.folder / "run.h5"
        self.wait_until("no checkpoint", saved.exists, MARGIN_S)
        first = saved.stat().st_mtime_ns
        self.wait_until("no second checkpoint", lambda: saved.stat().st_mtime_ns != first, MARGIN_S)
        self.assertEqual([len(node.processes(PROGRAM)) for node in self.nodes], [2, 2])
        self.nodes[0].do("ip", "link", "set", "link0", "down")
        self.wait_until("a process goes on after the link was cut",
                        lambda: not any(node.processes(PROGRAM) for node in self.nodes), limit_s + MARGIN_S)
        # The launcher may wait for the other node much longer.
        for process in self.nodes[0].processes() + self.nodes[1].processes():
            if process not in (node.holder.pid for node in self.nodes):
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)
        run.wait(timeout=MARGIN_S)
        self.assertRegex(run.stderr.read(), rf"rank [0-3] on troupe-[ab]: (waited {limit_s} s for rank [0-3] on troupe-[ab]|MPI: )")
        # The last checkpoint is complete, and resuming it with other numbers of ranks gives the same bits.
        tick = int(re.search(r"tick +(\d+)", self.call([PROGRAM, "info", "run.h5"]).stdout)[1])
        end = str((tick + 5) / 10)
        self.call([PROGRAM, "run", "room.json", "--for", end, "--hash-log", "one.log", "--quiet"])
        expected = lines_of(self.folder / "one.log")[tick:]
        self.call([PROGRAM, "resume", "run.h5", "--for", end, "--ranks", "3", "--hash-log", "three.log", "--quiet"])
        self.assertEqual(lines_of(self.folder / "three.log"), expected)
        self.nodes[0].do("ip", "link", "set", "link0", "up")
        self.wait_for_link()
        self.call(self.on_nodes(1, "resume", "run.h5", "--threads", 1, "--for", end, "--hash-log", "two.log", "--quiet"))
        self.assertEqual(lines_of(self.folder / "two.log"), expected)


class OpenMpi(OnTwoNodes, unittest.TestCase):
    mpi = "openmpi"

    def launcher_options(self, ranks_per_node):
        hosts = ",".join(f"{node.name}:{ranks_per_node}" for node in self.nodes)
        return ["--host", hosts, "-n", str(ranks_per_node * len(self.nodes)), "--bind-to", "none",
                "--mca", "plm_rsh_agent", str(self.folder / "agent"), "--mca", "btl", "tcp,self,vader",
                "--mca", "oob_tcp_if_include", "link0", "--mca", "btl_tcp_if_include", "link0"]


class Mpich(OnTwoNodes, unittest.TestCase):
    mpi = "mpich"

    def launcher_options(self, ranks_per_node):
        return ["-launcher", "ssh", "-launcher-exec", str(self.folder / "agent"), "-iface", "link0",
                "-hosts", ",".join(node.name for node in self.nodes), "-ppn", str(ranks_per_node),
                "-n", str(ranks_per_node * len(self.nodes))]


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    result = unittest.main(exit=False).result
    for _, reason in result.skipped:
        print(reason, file=sys.stderr)
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(77 if len(result.skipped) >= max(1, result.testsRun) else 0)

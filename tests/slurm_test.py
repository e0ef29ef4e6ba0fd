#!/usr/bin/env python3
"""Tests one world on the processes of `srun`, and a study as an array of jobs. The test starts Slurm on one node: munged,
slurmctld and slurmd of Debian, as root, with their own files, keys and ports.

    slurm_test.py PROGRAM    PROGRAM: the program `troupe`, in the folder of its modules for MPI

Exits with 77 if Slurm is not installed (scripts/setup --checks).
"""

import contextlib
import json
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from tests.support import room  # noqa: E402

PROGRAM = None
CPUS = 4
WAIT_S = 240  # for a busy machine

CONFIGURATION = """ClusterName=troupe
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
"""


def free_ports(count):
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


def lines_of(log):
    return [line for line in log.read_text().splitlines() if not line.startswith("#")]


class OnSlurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        tools = {name: shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin")
                 for name in ("munged", "slurmctld", "slurmd", "srun", "sbatch", "sinfo", "scontrol")}
        missing = [name for name, path in tools.items() if path is None]
        if missing or os.geteuid() != 0:
            raise unittest.SkipTest("NOT TESTED: Slurm: " + (f"{', '.join(missing)} missing (scripts/setup --checks)"
                                                             if missing else "its daemons need root"))
        cls.stack = contextlib.ExitStack()
        cls.addClassCleanup(cls.stack.close)
        cls.folder = pathlib.Path(cls.stack.enter_context(tempfile.TemporaryDirectory(dir="/var/tmp")))
        cls.folder.chmod(0o755)
        for name in ("state", "spool"):
            (cls.folder / name).mkdir()
        host = socket.gethostname().split(".")[0]
        (cls.folder / "slurm.conf").write_text(CONFIGURATION.format(host=host, ports=free_ports(2), folder=cls.folder, cpus=CPUS))
        key = cls.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        cls.environment = {name: value for name, value in os.environ.items()
                           if not name.startswith(("OMPI_", "PMI", "SLURM_", "TROUPE_"))}
        cls.environment |= {"SLURM_CONF": str(cls.folder / "slurm.conf"), "OMPI_ALLOW_RUN_AS_ROOT": "1",
                            "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        cls.start("munged", [tools["munged"], "--foreground", "--force", f"--key-file={key}", f"--socket={cls.folder}/munge.socket",
                             f"--pid-file={cls.folder}/munge.pid", f"--seed-file={cls.folder}/munge.seed",
                             f"--log-file={cls.folder}/munge.log"])
        cls.wait_until("munged does not start", (cls.folder / "munge.socket").exists)
        cls.start("slurmctld", [tools["slurmctld"], "-D"])
        cls.start("slurmd", [tools["slurmd"], "-D", "-N", host])
        cls.wait_until("the node does not become idle", lambda: "idle" in cls.output("sinfo", "--noheader", "--format=%T"))

    @classmethod
    def start(cls, name, command):
        log = cls.stack.enter_context(open(cls.folder / f"{name}.out", "w"))
        process = subprocess.Popen(command, cwd=cls.folder, env=cls.environment, stdout=log, stderr=log)

        def end():
            process.terminate()
            try:
                process.wait(timeout=30)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

        cls.stack.callback(end)

    @classmethod
    def wait_until(cls, what, condition):
        end = time.monotonic() + WAIT_S
        while not condition():
            if time.monotonic() > end:
                logs = "".join(f"== {log.name}\n{log.read_text()[-2000:]}" for log in sorted(cls.folder.glob("*.out")))
                raise AssertionError(f"{what}\n{logs}")
            time.sleep(0.2)

    @classmethod
    def output(cls, *command):
        return subprocess.run(command, capture_output=True, text=True, cwd=cls.folder, env=cls.environment, timeout=WAIT_S).stdout

    def setUp(self):
        (self.folder / "room.json").write_text(json.dumps(room.WORLD))
        (self.folder / "study.json").write_text(json.dumps(room.STUDY))

    def call(self, *command, **environment):
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, cwd=self.folder, timeout=300,
                              env={**self.environment, **environment})
        return done

    def good(self, *command, code=0):
        done = self.call(*command)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def srun_makes_each_process_a_rank(self, interface, mpi):
        if interface not in self.output("srun", "--mpi=list") + self.call("srun", "--mpi=list").stderr:
            self.skipTest(f"NOT TESTED: this Slurm has no --mpi={interface}")
        if not (pathlib.Path(PROGRAM).parent / f"libtroupe_mpi_{mpi}.so").exists():
            self.skipTest(f"NOT TESTED: the module of {mpi} is missing (scripts/setup --mpi)")
        self.good(PROGRAM, "run", "room.json", "--threads", 1, "--hash-log", "one.log", "--quiet")
        done = self.good("srun", f"--mpi={interface}", "-n", 3, "-c", 1, PROGRAM, "run", "room.json", "--hash-log", "three.log",
                         "--json")
        summary = json.loads(done.stdout)
        self.assertEqual((summary["ranks"], summary["threads"]), (3, 1))  # as -c says
        self.assertEqual(lines_of(self.folder / "three.log"), lines_of(self.folder / "one.log"))
        for log in ("one.log", "three.log"):
            (self.folder / log).unlink()

    def test_srun_makes_each_process_a_rank(self):
        self.srun_makes_each_process_a_rank("pmix", "openmpi")

    def test_srun_makes_each_process_a_rank_of_mpich(self):
        self.srun_makes_each_process_a_rank("pmi2", "mpich")

    def test_srun_without_mpi_is_an_error(self):
        done = self.call("srun", "-n", 2, PROGRAM, "run", "room.json", "--hash-log", "never.log")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("give srun the option --mpi=pmix", done.stderr)
        self.assertFalse((self.folder / "never.log").exists())

    def test_an_array_computes_a_study(self):
        self.good(PROGRAM, "sweep", "study.json", "-o", "one", "--quiet")
        part = f"{PROGRAM} sweep study.json -o parts --part $SLURM_ARRAY_TASK_ID/3 --threads 1 --quiet"
        self.good("sbatch", "--wait", "--array=1-3", "-c", 1, "--output=part-%a.out", "--wrap", part)
        self.good(PROGRAM, "sweep", "study.json", "-o", "parts", "--quiet")  # writes the table of all parts
        self.assertEqual((self.folder / "parts" / "table.csv").read_text(), (self.folder / "one" / "table.csv").read_text())
        self.assertEqual([(self.folder / f"part-{part}.out").read_text() for part in (1, 2, 3)], ["", "", ""])

    def test_the_processes_of_srun_share_a_study(self):
        self.good(PROGRAM, "sweep", "study.json", "-o", "one-again", "--quiet")
        done = self.good("srun", "--mpi=pmix", "-n", 3, "-c", 1, PROGRAM, "sweep", "study.json", "-o", "three")
        # Rank 0 prints this after it has written the table; any other output says why there is none.
        self.assertIn("8 of 8 runs done: three/table.csv\n", done.stdout, done.stderr)
        self.assertEqual((self.folder / "three" / "table.csv").read_text(), (self.folder / "one-again" / "table.csv").read_text())
        self.assertEqual(len(list((self.folder / "three").glob("runs-*-of-3.jsonl"))), 3)

    def test_a_job_ends_before_its_time_limit_and_is_resumed(self):
        self.good(PROGRAM, "run", "room.json", "--threads", 1, "--hash-log", "straight.log", "--for", 1e5, "--wall-limit", 2,
                  "--checkpoint", "straight.h5", "--quiet", code=3)
        run = f"srun --mpi=pmix {PROGRAM} run room.json --for 1e5 --checkpoint big.h5 --wall-limit 2 --hash-log big.log --quiet"
        again = f"srun --mpi=pmix {PROGRAM} resume big.h5 --for 1e5 --checkpoint big.h5 --wall-limit 2 --hash-log big.log --quiet"
        for job, ranks in ((run, 3), (again, 2)):
            self.good("sbatch", "--wait", "-n", ranks, "-c", 1, "--output=big.out", "--wrap", job, code=3)
        lines = min(len(lines_of(self.folder / "big.log")), len(lines_of(self.folder / "straight.log")))
        self.assertGreater(lines, 2)
        self.assertEqual(lines_of(self.folder / "big.log")[:lines], lines_of(self.folder / "straight.log")[:lines])

    def test_the_signal_of_a_job_saves_the_state(self):
        job = f"srun --mpi=pmix -n 2 -c 1 {PROGRAM} run room.json --for 1e6 --checkpoint job.h5 --hash-log job.log --quiet"
        number = self.good("sbatch", "--parsable", "-n", 2, "-c", 1, "--output=job.out", "--wrap", job).stdout.strip()
        # The processes of a job outlive the daemons, so wait for their end.
        self.addCleanup(self.wait_until, "the job does not end", lambda: not self.output("squeue", "--noheader"))
        self.addCleanup(self.call, "scancel", number)
        log, saved = self.folder / "job.log", self.folder / "job.h5"
        self.wait_until("the job does not run", lambda: log.exists() and len(lines_of(log)) > 20)
        self.assertFalse(saved.exists())
        self.good("scancel", "--signal=USR1", number)
        self.wait_until("no checkpoint", saved.exists)
        ticks = len(lines_of(log))
        self.wait_until("the job does not go on", lambda: len(lines_of(log)) > ticks + 20)


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    result = unittest.main(exit=False).result
    for _, reason in result.skipped:
        print(reason, file=sys.stderr)
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(77 if result.testsRun == 0 else 0)

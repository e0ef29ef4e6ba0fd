"""Lists the commands and texts of the documentation that tests/docs_test.py does not run, or runs in another form, and why.

Commands are selected by patterns (regular expressions); texts by their page and the beginning of their first line.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "scripts"))

from proofs.scenes import Scenes  # noqa: E402

# Commands that are never run: (pattern, reason).
NOT_RUN = [
    (r"\bscripts/(quickstart|test|bench|prove|fuzz|setup|build|gallery|scenes|reference|replay-page|format|lint|wheel|check-\w+|count-ranks)\b",
     "builds, or takes minutes"),
    (r"^(cmake|ctest) --preset ", "builds, or tests, all of Troupe"),
    (r"\bpip3? ", "builds all of Troupe"),
    (r"^~/venv/bin/", "needs a wheel: scripts/wheel --check"),
    (r"\bcpack\b", "tests/install/package_test.cmake makes the packages"),
    (r"\bsudo\b", "needs root"),
    (r"^git clone ", "needs a network"),
    (r"python/examples/(train_navigation|evolve_dispersion)\.py", "takes minutes, and needs skrl or cma: training_test.py, training_ppo_test.py"),
    (r"perf/learning_vmas\.py", "takes minutes, and needs VMAS"),
    (r"^apptainer ", "needs Apptainer"),
    (r"^(sbatch|squeue|srun) ", "needs SLURM"),
    (r"^(mpirun|mpicc) ", "needs MPI: tests/mpi_test.py"),
    (r"^xdg-open ", "opens a window"),
    (r"/usr/bin/python3$", "waits for input from a terminal"),
    (r"perf_kernels|perf_paper --only", "takes minutes"),
    (r"perf_paper --quick", "is the test perf.paper"),
    (rf"\bworlds/({'|'.join(Scenes().slow()).replace('.', chr(92) + '.')})", "takes minutes of one core"),
    (r"--rate 1\b", "takes as long as it simulates"),
    (r"^troupe view (?!--help)", "waits for a browser: tests/view_page_test.py"),
    (r"--session \S+\.session\.jsonl", "repeats what was done in a browser: tests/view_test.py"),
]

# Commands that are changed before they are run: (pattern, replacement, reason).
INSTEAD = [
    (r"--for 172800 ", "--for 20 ", "two days of the hospital take hours"),
    (r"--for 172830 ", "--for 22 ", "goes on with that"),
    (r"^(troupe run worlds/hospital\S* .*)--for 600\b", r"\1--for 30", "ten minutes of 2,000 robots take a minute"),
    (r"^(troupe resume \S+ .*)--for 600\b", r"\1--for 40", "goes on with that"),
    (r"--for (60|20) (--film \S+)", r"--for 2 \2", "each of a film's pictures takes a while"),
    (r"--for 60 --raytracer grid", "--for 10 --raytracer grid", "the grid engine is slow"),
    (r"^man -l (\S+)$", r"test -s \1", "a terminal is needed, and there may be no man"),
]

# Commands that need a program or folder that may be missing: (pattern, program or folder).
NEEDS = [
    (r"--film \S+\.mp4", "ffmpeg"),
    (r"^h5dump ", "h5dump"),
    (r"^h5repack ", "h5repack"),
    (r"perf_paper ", "build/release/bin/perf_paper"),
]

# Modules that Python listings need in addition to those that they import: (pattern, module).
NEEDS_MODULE = [
    (r"\btroupe\.envs\b", "gymnasium"),
    (r"\bParallelEnv\b", "pettingzoo"),
]

# Commands that may end with an exit code other than 0, as their page says: (pattern, exit codes).
ENDS = [
    (r"^troupe (diff|lint) ", {0, 1}),
    (r"--wall-limit ", {0, 3}),
]

# Preconditions of pages: commands that are run before the first command of the page.
BEFORE = {
    "docs/pictures.md": ["troupe run worlds/minimal.world --for 2 --record day.h5"],
}

# Subcommands and options that the program may not have. Commands with them are run if the program has them.
WAITING = {"render", "replay", "sweep", "--film", "--film-speed", "--layers", "--camera", "--snapshot-at", "--color-by"}

# Pages that may be missing although other pages link to them.
WAITING_PAGES = {"pictures.md", "replay.md", "radio.md", "python.md", "experiments.md", "sweeps.md"}

# Worlds in listings that the program cannot load: (page, file), reason.
NOT_LOADED = {
    ("docs/extending.md", "east.json"): "has kinds of a program of the page, which runs it",
    ("docs/from-stage.md", "shy.world"): "has a controller of a plug-in of the page, which is built further down",
}

# C++ listings that are not compiled: (page, beginning of the first line, reason).
CPP_NOT_COMPILED = []

# Includes and declarations that are compiled before the C++ listings of a page.
CPP_BEFORE = {
    "docs/checkpoints.md": """
        troupe::Simulation simulation("worlds/hospital.json");""",
    "docs/determinism.md": """
        #include <engine/observing/controller_check.hpp>
        #include <troupe/registry.hpp>
        struct Patrol { void operator()(const troupe::engine::Percept&, troupe::Random&, troupe::engine::Actions&) const {} };""",
    "docs/library.md": """
        troupe::Simulation simulation("worlds/hospital.json");
        troupe::Model robot = simulation.find("r0");""",
    "docs/measures.md": """
        #include <engine/kinds/measure_kind.hpp>
        #include <troupe/registry.hpp>
        struct Crowding : troupe::engine::Measure {
          Crowding(const troupe::engine::MeasuredWorld&, std::vector<troupe::BodyId>) {}
          double value(const troupe::engine::MeasuredWorld&) override { return 0; }
        };""",
}

# Texts on a page that none of its commands prints: (page, beginning of the first line, reason).
SHOWN_ONLY = [
    ("README.md", "S(k): poses", "the phases of a tick, told"),
    ("docs/architecture.md", "intervene ", "the phases of a tick, told"),
    ("docs/architecture.md", "WorldSpec ", "a sketch of the data"),
    ("docs/checkpoints.md", "200 kills", "tests/checkpoint_kill_test.py printed it, after minutes"),
    ("docs/checkpoints.md", "run.h5: error: this is not a", "damaged files: tests/apps/resume_test.cpp"),
    ("docs/controllers.md", 'controller "patrol/0"', "a controller that breaks the rules: tests/plugins/program_test.cpp"),
    ("docs/controllers.md", "troupe: error: tick 3", "a controller that throws: tests/plugins/program_test.cpp"),
    ("docs/measures.md", "troupe: error: tick 3", "a measure that throws: tests/plugins/program_test.cpp"),
    ("docs/determinism.md", "S(k+1)", "a formula"),
    ("docs/determinism.md", "key = seed", "a formula"),
    ("docs/determinism.md", "id (32 bits", "what is hashed, told"),
    ("docs/determinism.md", "tick state", "the columns of a hash log"),
    ("docs/determinism.md", "variant ", "a difference, which there must not be: tests/apps/check_test.cpp"),
    ("docs/determinism.md", 'controller "patrol/0"', "a controller that breaks the rules: tests/plugins/program_test.cpp"),
    ("docs/proofs.md", "proof ", "scripts/prove and scripts/check-aarch64 print it, after minutes"),
    ("docs/proofs.md", "hospital, T0", "a difference, which there must not be: tests/prove_test.py"),
    ("docs/driving.md", "heading'", "a formula"),
    ("docs/experiments.md", "w.json:12", "of a world with faults: tests/engine/placement_test.cpp"),
    ("docs/ground.md", "brightness =", "a formula"),
    ("docs/install.md", "== the program", "scripts/check-package prints it, after minutes"),
    ("docs/install.md", "Bootstrap:", "a recipe for Apptainer"),
    ("docs/library.md", "error: types[0]", "of a spec with a fault: tests/troupe/spec_simulation_test.cpp"),
    ("docs/library.md", "room.json:14", "of a world with a fault: tests/troupe/library_test.cpp"),
    ("docs/lint.md", "simple.world:33", "of a world that comes with Stage: tests/apps/lint_test.cpp"),
    ("docs/live.md", "Pioneer robots", "what troupe view prints: tests/view_test.py"),
    ("docs/live.md", '{"troupe_session"', "lines of a session: tests/troupe/session_test.cpp"),
    ("docs/live.md", "import troupe", "waits for a browser: tests/python/simulation_test.py"),
    ("docs/live-protocol.md", "import asyncio", "tests/view_test.py runs it, where websockets is installed"),
    ("docs/recordings.md", "200 kills", "tests/recording_kill_test.py printed it, after minutes"),
    ("docs/recordings.md", "differs at tick 40", "a difference, which there must not be: tests/apps/diff_test.cpp"),
    ("docs/replay.md", "long.html:", "of a recording of ten minutes"),
    ("docs/sensing.md", "c = (v - o)", "formulas"),
    ("docs/scenes.md", "beeclust: ", "scripts/scenes prints it, after minutes"),
    ("docs/scenes.md", "coverage: ", "scripts/scenes prints it, after minutes"),
    ("docs/scenes.md", "chain: ", "scripts/scenes prints it, after minutes"),
    ("docs/scenes.md", "brazil_nut: ", "scripts/scenes prints it, after minutes"),
    ("docs/scenes.md", "segregation: ", "scripts/scenes prints it, after minutes"),
    ("docs/scenes.md", "harvest: ", "scripts/scenes prints it, after minutes"),
    ("docs/scenes.md", "perception: ", "scripts/scenes prints it, after minutes"),
    ("docs/scenes.md", "flock: ", "scripts/scenes prints it, after minutes"),
    ("docs/science.md", "@software", "a reference in BibTeX"),
    ("docs/science.md", "@article", "a reference in BibTeX"),
    ("docs/stage-worlds.md", "maze.world:12", "of a world with faults: tests/worldio/stage_world_test.cpp"),
]

# Lines whose numbers vary between machines and runs: wall time, memory, versions.
VARYING = (r"\bwall\b|times real time|\bcost\b|\bphases\b|\bthreads\b|memory|troupe \d|version|compiler|\btile_m\b"
           r"|\bMi?B\b|\bloading\b|processor time|\bratio\b")

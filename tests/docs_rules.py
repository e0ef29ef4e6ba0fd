"""What tests/docs_test.py does not run as it stands, and why. Everything else in the documentation is run.

A pattern is searched in a command, or matched from the start of a shown text; every entry must be of use (`--strict`
names those that are not).
"""

# Commands that are never run: (pattern, why).
NOT_RUN = [
    (r"\bscripts/(quickstart|test|bench|prove|fuzz|check-\w+|setup|gallery|reference|replay-page)\b",
     "builds, or takes minutes"),
    (r"^cmake --preset ", "builds all of Troupe"),
    (r"\bsudo\b", "needs root"),
    (r"^git clone ", "needs a network"),
    (r"^apptainer ", "needs Apptainer"),
    (r"\bcpack\b", "tests/install/package_test.cmake makes the packages"),
    (r"\bpip\b", "builds all of Troupe"),
    (r"/usr/bin/python3$", "waits for somebody to type"),
    (r"^perf/|perf_paper (?!--list|--quick)|perf_kernels", "takes minutes"),
    (r"perf_paper --quick", "is the test perf.paper"),
    (r"\bworlds/(campus|foragers)\.json", "takes minutes of one core"),
    (r"--rate 1 --clock", "takes a minute, in real time"),
    (r"^xdg-open ", "opens a window"),
]

# Commands that are run in another way: (pattern, replacement, why).
INSTEAD = [
    (r"--for 172800 ", "--for 20 ", "two days of a hospital are some hours"),
    (r"^man -l (\S+)$", r"test -s \1", "there may be no man"),
    (r"^cmake -B build ", "cmake -G Ninja -B build ", "as the tree itself is built"),
    (r"^(troupe run worlds/hospital\S* .*)--for 600\b", r"\1--for 30", "600 s of 2,000 robots take a minute on a busy machine"),
    (r"^(troupe resume \S+ .*)--for 600\b", r"\1--for 40", "with the one before"),
]

# Commands that need what may not be there: (pattern, program, why).
NEEDS = [
    (r"--film \S+\.mp4", "ffmpeg", "makes the film"),
    (r"^h5", "h5dump", "hdf5-tools"),
]

# Commands that end otherwise than with 0: (pattern, exit codes). The prose says so.
ENDS = [
    (r"^troupe diff ", {0, 1}),
    (r"^troupe lint ", {0, 1}),
    (r"--wall-limit ", {0, 3}),
]

# What a page takes for granted: commands that are run before its first one.
BEFORE = {
    "docs/pictures.md": ["troupe run worlds/minimal.world --for 2 --record day.h5"],
}

# Words of the program that are not there yet; as soon as they are, commands with them are run.
WAITING = {"render", "replay", "--film", "--film-speed", "--layers", "--camera", "--snapshot-at", "sweep"}

# Python listings of a page that another test runs: page -> test.
PYTHON_ELSEWHERE = {"docs/python.md": "tests/python/docs_test.py"}

# C++ listings that are no statements or declarations of their own: (page, first line, why).
CPP_NOT_COMPILED = []

# Names that C++ listings of a page take for granted: declarations before them.
CPP_BEFORE = {
    "docs/checkpoints.md": 'troupe::Simulation simulation("worlds/hospital.json");',
    "docs/lives.md": "",
    "docs/measures.md": "struct Crowding : troupe::engine::MeasureKind::Measure { };",
}

# Shown texts that nothing prints: (page, start of the first line, why).
SHOWN_ONLY = [
]

# Lines of which numbers depend on the machine and the minute: wall time, memory, versions, sizes of files with a time in them.
VARYING = (r"\bwall\b|times real time|\bcost\b|\bphases\b|peak memory|\bthreads\b|^troupe \d|version|tile_m|MiB|\bMB\b"
           r"|compiler|bytes|loading|beams a s")

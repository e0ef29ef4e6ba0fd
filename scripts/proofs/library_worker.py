#!/usr/bin/env python3
"""Runs checks of worlds (checks.py) with Troupe's Python module, in this process. Reads a request from standard input and
writes an answer to standard output, each as one line of JSON:

    in   {"world": {...}, "folder": "...", "program": "...", "ticks": 40, "checks": [...], "cover": true}
    out  {"invalid": the reason why the world cannot be loaded}, or
         {"failures": [{"check": {...}, "tick": 7, "text": "..."}], "events": [[type, robot, other], ...],
          "refused": [errors of `troupe convert` for worlds that Stage's format cannot express],
          "resumed": [names of the robots alive at checkpoints], "acts": [kinds of the acts that were carried out in sessions],
          "ticks": ticks of the plain run (on one thread), "stopped": the line with the error that ended the plain run, or ""}

scripts/proofs/random_proof.py starts this script as a process of its own, because a world may crash the process.
"""

import json
import os
import pathlib
import random
import subprocess
import sys

import troupe

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from checks import difference, options_of  # noqa: E402
from sessions import Viewer  # noqa: E402


def names_of_living(simulation):
    """Returns the names of all bodies that are in the world, except static bodies. Bodies without a drive are included, although
    no swarm contains them."""
    ids = sorted({int(id) for table in simulation.tables() for id in table.ids})
    return [model.name for model in map(simulation.model, ids) if model.is_alive()]


class Job:
    def __init__(self, request):
        self.world, self.ticks = request["world"], request["ticks"]
        self.folder = pathlib.Path(request["folder"])
        self.program = request["program"]
        self.cover = request.get("cover", False)
        self.name = str(self.folder / "world.json")
        self.events, self.refused, self.resumed, self.acts = [], [], [], set()
        self.expected = []

    def simulation(self, threads=1, tile=0.0, **options):
        return troupe.Simulation(self.world, threads=threads, tile_size_m=tile or 0.0, name=self.name, **options)

    def steps(self, simulation, ticks, each=None):
        """Steps the simulation to the tick `ticks`, and returns the lines of its hash log from the current tick on. each:
        function to call after each step. If a step fails, the last line is "TICK error TEXT"."""
        lines = [simulation.hash_log_line().strip()]
        while simulation.tick < ticks:
            tick = simulation.tick
            try:
                simulation.step()
            except troupe.StepError as error:
                return [*lines, f"{tick + 1} error {error}"]
            if each:
                each()
            lines.append(simulation.hash_log_line().strip())
        return lines

    # ---- checks; each yields one or more lists of lines

    def threads(self, check):
        yield self.steps(self.simulation(check["threads"], check["tile"]), self.ticks)

    def checkpoints(self, check):
        """Saves the simulation at the first tick of check["at"], continues it to its end, and then resumes it, saving and
        resuming it again at each further tick of check["at"]. Yields the lines of each part."""
        file = self.folder / "chain.h5"
        simulation = self.simulation(check["threads"][0], check["tiles"][0])
        for i, at in enumerate(check["at"]):
            lines = self.steps(simulation, at)
            yield lines
            if "error" in lines[-1].split()[1:2]:
                return
            simulation.save(file)
            if i == 0:  # saving must not change the simulation
                yield self.steps(simulation, self.ticks)
            simulation = troupe.Simulation.resume(file, threads=check["threads"][i + 1], tile_size_m=check["tiles"][i + 1])
            if self.cover:
                self.resumed += names_of_living(simulation)
        yield self.steps(simulation, self.ticks)

    def reset(self, check):
        simulation = self.simulation(check["threads"])
        self.steps(simulation, check["at"])
        simulation.reset()
        yield self.steps(simulation, self.ticks)

    def steps_of(self, check):
        """Makes several ticks per call, and compares only the state after the last tick of each call."""
        simulation = self.simulation(check["threads"])
        while simulation.tick < self.ticks:
            try:
                simulation.step(min(check["of"], self.ticks - simulation.tick))
            except troupe.StepError:
                return
            yield [simulation.hash_log_line().strip()]

    def observed(self, check):
        simulation = self.simulation(check["threads"])
        events = troupe.Events(simulation)
        measures = troupe.Measures(simulation, self.world.get("measures") or ["stalls"])
        recording = self.folder / "observed.h5"
        simulation.record(recording, fields=["all"], every_s=simulation.tick_s, replace=True)

        def look():
            measures.see()
            measures.values()
            self.events += [(event.type, event.robot, event.other) for event in events.see()]

        lines = self.steps(simulation, self.ticks, look)
        if check.get("picture"):
            simulation.picture(80, 60, layers="scans,beams,grips,links,names,energy")
            lines[-1] = simulation.hash_log_line().strip() if " error " not in lines[-1] else lines[-1]
        simulation.stop_recording()
        yield lines

    def tables(self, check):
        """Compares the measures and the events of each tick with those of a run on one thread."""

        def rows_of(**options):
            simulation = self.simulation(**options)
            events = troupe.Events(simulation)
            measures = troupe.Measures(simulation, self.world.get("measures") or ["stalls"])
            rows = []

            def look():
                measures.see()
                rows.append(f"tick {simulation.tick}: measures {measures.values()}, events "
                            f"{[(event.type, event.robot, event.other) for event in events.see()]}")

            return self.steps(simulation, self.ticks, look), rows

        _, expected = rows_of()
        lines, rows = rows_of(threads=check["threads"], tile=check["tile"], ranks=check["ranks"])
        yield lines
        for a, b in zip(expected, rows):
            if a != b:
                raise RuntimeError(f"the tables differ: expected {a}; got {b}")

    def converted(self, check):
        """Converts the world with `troupe convert` and runs the result. Before a conversion to Stage's format, removes the
        features that this format lacks, and runs the reduced world again for comparison."""
        source, target = self.folder / "source.json", self.folder / f"converted.{check['to']}"
        world = self.world
        options = {}
        if check["to"] == "world":
            options = {"ranging": world["ranging"]} if "ranging" in world else {}
            unsaid = ("measures", "ranging", "resolution_m", "at", "faults", "mortal")
            world = {key: value for key, value in world.items() if key not in unsaid}
            world["populations"] = [{key: value for key, value in one.items() if key != "reserve"}
                                    for one in world.get("populations", ())]
        source.write_text(json.dumps(world))
        done = subprocess.run([self.program, "convert", source, target, "--force"], capture_output=True, text=True)
        if done.returncode == 2 and check["to"] == "world":
            self.refused.append(done.stderr.strip().splitlines()[0].split(": ", 1)[1][:160])
            return
        if done.returncode != 0:
            raise RuntimeError(f"troupe convert: exit code {done.returncode}: {done.stderr.strip()}")
        if check["to"] == "world":
            self.expected = self.steps(troupe.Simulation(str(source), threads=1, **options), self.ticks)
        yield self.steps(troupe.Simulation(str(target), threads=1, **options), self.ticks)

    def session(self, check):
        """Records a session (random actions of a viewer, sessions.py), and lets the program repeat it: from the start with other
        threads or several ranks, which may divide the robots among themselves, and from a checkpoint that was saved in the
        session."""
        draws = random.Random(f"session {check['seed']}")
        source, log = self.folder / "session.json", self.folder / "session.log"
        for old in (*self.folder.glob("session.session*.jsonl"), *self.folder.glob("session.checkpoint*.h5")):
            old.unlink()
        source.write_text(json.dumps({**self.world, "mortal": True}))  # otherwise bodies cannot be removed or disabled
        simulation = troupe.Simulation(str(source), threads=draws.choice((1, 2, 3)))
        view = simulation.view(rate=0, out=self.folder)
        viewer = Viewer(view, self.world, self.ticks, check["seed"])
        viewer.start()
        file = view.session
        lines = self.steps(simulation, self.ticks)
        view.close()
        viewer.join()
        viewer.socket.socket.close()
        if viewer.error is not None:
            raise RuntimeError(f"the viewer failed: {viewer.error!r}")
        self.acts |= viewer.done
        self.expected = [line for line in lines if " error " not in line]
        end_s = repr((len(self.expected) - 1) * self.world.get("tick_s", 0.1))
        ways = [("run", source, "--threads", draws.choice((1, 2, 3, 8)), "--ranks", draws.choice((1, 1, 2, 3)),
                 *draws.choice(((), ("--distribute",))))]
        if viewer.checkpoint:
            ways.append(("resume", self.folder / viewer.checkpoint, "--threads", draws.choice((1, 2, 3))))
        for way in ways:
            log.unlink(missing_ok=True)
            command = [self.program, *way, "--session", file, "--for", end_s, "--hash-log", log, "--quiet"]
            done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
            if done.returncode != 0:
                raise RuntimeError(f"troupe {way[0]} --session: exit code {done.returncode}: {done.stderr.strip()[:1500]}")
            yield [line for line in log.read_text().splitlines() if not line.startswith("#")]

    def program_check(self, check):
        yield from ()
        if check["check"] == "reach" and self.world.get("ranging") == "grid":
            return  # needs the exact engine
        command = [self.program, "check", self.folder / "world.json", "--for", repr(self.ticks * self.world.get("tick_s", 0.1))]
        command += ["--threads", ",".join(map(str, check.get("threads", [1]))),
                    "--tile-size", ",".join(str(tile) if tile else "auto" for tile in check.get("tiles", [0])),
                    *options_of(check)]
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
        if done.returncode != 0:
            told = done.stdout[done.stdout.find("differs at"):] if "differs at" in done.stdout else done.stdout
            raise RuntimeError(f"troupe check: exit code {done.returncode}: {(told + done.stderr).strip()[:1500]}")

    def failure(self, check):
        """Makes one check. Returns None if it passes, else the failure: {"check": the check, "tick": the tick of the first
        difference or None, "text": the reason}."""
        run = {"threads": self.threads, "checkpoints": self.checkpoints, "reset": self.reset, "steps": self.steps_of,
               "observed": self.observed, "tables": self.tables, "converted": self.converted, "program": self.program_check,
               "ranks": self.program_check, "amnesia": self.program_check, "reach": self.program_check,
               "controllers": self.program_check, "session": self.session}[check["check"]]
        plain = self.expected
        try:
            for lines in run(check):
                end = int(lines[-1].split()[0])
                last = next((i for i, line in enumerate(self.expected) if int(line.split()[0]) == end), len(self.expected))
                found = difference(self.expected[:last + 1], lines)
                if found:
                    return {"check": check, "tick": found[0], "text": found[1]}
        except (RuntimeError, ValueError, LookupError, TypeError) as error:
            return {"check": check, "tick": None, "text": f"{type(error).__name__}: {error}"}
        finally:
            self.expected = plain
        return None

    def run(self, checks):
        (self.folder / "world.json").write_text(json.dumps(self.world, indent=1) + "\n")
        try:
            plain = self.simulation()
        except troupe.InputError as error:
            return {"invalid": "\n".join(error.findings) or str(error)}
        self.expected = self.steps(plain, self.ticks)
        failures = [found for found in map(self.failure, checks) if found]
        return {"failures": failures, "events": sorted(set(self.events), key=repr), "refused": self.refused,
                "resumed": sorted(set(self.resumed)), "acts": sorted(self.acts), "ticks": len(self.expected) - 1,
                "stopped": self.expected[-1] if " error " in self.expected[-1] else ""}


def main():
    # Output of libraries must not mix with the answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    print(json.dumps({"ready": troupe.version_line()}), file=answers, flush=True)
    for line in sys.stdin:
        request = json.loads(line)
        print(json.dumps(Job(request).run(request["checks"])), file=answers, flush=True)


if __name__ == "__main__":
    main()

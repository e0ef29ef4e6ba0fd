"""Runs proofs (variants.py). Compares the hash log of each run of a world, line by line, with that of the first run. Compares
the last hash of the first run with the golden hash, which is the expected hash in worlds/golden_hashes.txt."""

from .runs import Fault, difference, state_of
from .table import Progress, print_row


def runs_of(proofs):
    return sum(len(proof.variants) for proof in proofs)


def hold(world, proofs, ticks, folder, golden=None, robots=None, progress=None):
    """Runs the variants of the proofs in one world and prints one row of the table per proof. Yields each proof with a list of
    the differences, as texts. folder: folder for the files of the runs; calls that run at the same time need different ones.
    golden: the result of read_golden(), with which the last hash of the first run is compared; None: no comparison. robots:
    number of robots; None: the number in the world. progress: the progress line of several calls, which expects the runs of
    all of them; None: a line of its own.
    Raises Fault if the first run fails."""
    progress = progress or Progress(runs_of(proofs))
    expected = None
    for proof in proofs:
        found = []
        for variant in proof.variants:
            where = f"{world.name}, {proof.name}, {variant.label}"
            progress.show(where)
            try:
                lines = variant.lines(world, ticks, folder, robots)
            except Fault as fault:
                if expected is None:
                    raise
                found.append(f"{where}: {fault}")
                continue
            if expected is None:
                expected = lines
                if golden is not None:
                    found += compare_golden(world, ticks, state_of(lines[-1]), golden, where, robots)
            elif text := difference(expected, lines):
                found.append(f"{where}: {text}")
        progress.clear()
        print_row((f"{world.name}: {proof.name}", proof.about, ticks, "DIFFERS" if found else "same bits",
                   state_of(expected[-1])))
        yield proof, found


def compare_golden(world, ticks, state, golden, where, robots=None):
    known = golden.get((world.key, robots, ticks))
    if known is None:
        return [f"{world.key}: worlds/golden_hashes.txt has no golden hash of tick {ticks}; scripts/prove --golden computes it"]
    if known != state:
        return [f"{where}: the state hash at tick {ticks} is {state}, the golden hash is {known}"]
    return []

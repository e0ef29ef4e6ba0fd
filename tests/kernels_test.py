#!/usr/bin/env python3
"""Checks the object code of the kernels for every instruction set: it copies no table to the stack, has no repeated
string instructions, and calls only functions that are listed here. Highway's operations are inline functions. If one of
them has a table in a local array, gcc copies the table at every call, which once took three quarters of the time of a
cull (the test that skips the outlines that a beam cannot meet).

    kernels_test.py OBJDUMP LIBRARY.a    reads the object code of a release build
"""

import re
import subprocess
import sys
import unittest

OBJDUMP = LIBRARY = None

KERNEL = re.compile(r"::N_(\w+)::")  # Highway's namespace of a target
# Functions that kernels may call in addition to other kernels, and why.
ALLOWED = {
    "troupe::partition::inverse_range(": "the formula itself, for the rare edges that noise would decide",
    "memset": "clears what the beams of a fan have met, once a block of edges",
    "memcpy": "the last readings of a fan, fewer than a vector",
    "sqrtf": "for the errno of a negative number, which no distance is",
}
# The compiler may store a few vectors of constants on the stack; tables have 256 bytes or more.
MOST_STACK_BYTES = 128

FUNCTION = re.compile(r"^[0-9a-f]+ <(.*)>:$")
INSTRUCTION = re.compile(r"^\s+[0-9a-f]+:\s+(?:(?:notrack|bnd|lock) )?(\S+)\s*([^#]*)")
RELOCATION = re.compile(r"^\s+[0-9a-f]+: R_\w+\s+(.*?)(?:[-+]0x[0-9a-f]+)?$")
REGISTER = re.compile(r"%([xyz]mm\d+|r\d+|[re]?[a-d]x|[re]?[sd]i|[re]bp)[dwb]?$")
VECTOR_BYTES = {"x": 16, "y": 32, "z": 64}


def register(operand):
    """Returns the name of the whole register and the number of its bytes that are used; (None, 0) for other operands."""
    match = REGISTER.match(operand.strip())
    if not match:
        return None, 0
    name = match[1]
    if name[1:3] == "mm":
        return name[1:], VECTOR_BYTES[name[0]]
    return name.lstrip("re") if not name[1].isdigit() else name, 8


def operands(text):
    return [part for part in re.split(r",(?![^()]*\))", re.sub(r"<.*", "", text).strip()) if part]


def callee_of(text):
    """Returns the callee of a call without relocation: `a30 <name>`, `a30 <name+0x10>`, or `*%rax`."""
    match = re.search(r"<(.*)>\s*$", text)
    return re.sub(r"\+0x[0-9a-f]+$", "", match[1]) if match else f"through {text.strip()}"


class Function:
    """The findings in one function: string instructions, callees, and bytes of constants that are written to the stack."""

    def __init__(self, name):
        self.name, self.repeated, self.callees, self.stack_bytes = name, set(), set(), 0
        self._constant = set()  # registers

    def read(self, operation, text, target):
        if operation.startswith("rep"):
            self.repeated.add(f"{operation} {text.split()[0]}")
        if operation in ("call", "bl") or (operation in ("jmp", "b") and target):
            self.callees.add(target or callee_of(text))
        parts = operands(text)
        if len(parts) < 2:
            return
        source, to = parts[0], parts[-1]
        is_move = re.match(r"v?mov|vbroadcast|movabs", operation)
        if re.search(r"\(%r[sb]p", to):
            name, size = register(source)
            if is_move and name in self._constant:
                self.stack_bytes += size
            elif is_move and source.startswith("$") and source != "$0x0":
                self.stack_bytes += 8
        elif register(to)[0]:
            is_constant = is_move and ("(%rip)" in source or operation == "movabs")
            (self._constant.add if is_constant else self._constant.discard)(register(to)[0])


def kernels(disassembly):
    """Returns the kernels in the output of objdump, which must contain relocations and demangled names."""
    found, function = [], None
    lines = disassembly.splitlines()
    for line, following in zip(lines, [*lines[1:], ""]):
        if match := FUNCTION.match(line):
            function = Function(match[1]) if KERNEL.search(match[1]) else None
            if function:
                found.append(function)
        elif function and (match := INSTRUCTION.match(line)) and not RELOCATION.match(line):
            relocation = RELOCATION.match(following)
            function.read(match[1], match[2], relocation[1] if relocation else None)
    return found


def faults(disassembly):
    texts = []
    for kernel in kernels(disassembly):
        # From gcc 14 on, project_carefully(), which is the same for each instruction set, may be merged into one.
        own = re.compile(f"::N_{KERNEL.search(kernel.name)[1]}::|::N_\\w+::.*::project_carefully\\(")
        texts += [f"{kernel.name}: {text}" for text in sorted(kernel.repeated)]
        texts += [f"{kernel.name}: calls {callee}" for callee in sorted(kernel.callees)
                  if not own.search(callee) and not any(callee == name or (name.endswith("(") and callee.startswith(name))
                                                   for name in ALLOWED)]
        if kernel.stack_bytes > MOST_STACK_BYTES and "::N_EMU128::" not in kernel.name:  # whose vectors are arrays
            texts.append(f"{kernel.name}: writes {kernel.stack_bytes} bytes of constants to the stack")
    return texts


class TheKernels(unittest.TestCase):
    def test_do_nothing_but_compute(self):
        done = subprocess.run([OBJDUMP, "-dr", "-C", "--no-show-raw-insn", LIBRARY], check=True, capture_output=True, text=True)
        found = kernels(done.stdout)
        targets = {KERNEL.search(kernel.name)[1] for kernel in found}
        self.assertGreater(len(targets), 1, f"{LIBRARY} holds no kernels")
        for target in targets:
            names = [kernel.name for kernel in found if f"::N_{target}::" in kernel.name]
            for part in ("fan_may_meet", "limits_of", "unpack_runs", "project_on", "turn_beams", "ranges_of_fan"):
                self.assertTrue(any(part in name for name in names), f"{part} was not found for {target}")
        self.assertEqual(faults(done.stdout), [])


HEAD = "0000000000001000 <troupe::partition::N_AVX2::(anonymous namespace)::fan_may_meet(unsigned long)>:\n"


class PlantedFaults(unittest.TestCase):
    def faults(self, *lines):
        return [fault.partition(": ")[2] for fault in faults(HEAD + "".join(f"    1000:\t{line}\n" for line in lines))]

    def test_a_string_instruction(self):
        self.assertEqual(self.faults("rep movsq %ds:(%rsi),%es:(%rdi)"), ["rep movsq"])
        self.assertEqual(self.faults("rep stos %rax,%es:(%rdi)"), ["rep stos"])

    def test_a_call(self):
        there = "\t\t\t1001: R_X86_64_PLT32\t"
        for callee in ("__popcountdi2-0x4", "operator new(unsigned long)-0x4"):
            text = f"{HEAD}    1000:\tcall   1005 <x+0x5>\n{there}{callee}\n"
            self.assertEqual(len(faults(text)), 1, callee)
            self.assertTrue(faults(text)[0].endswith(f"calls {callee[:-4]}"), faults(text))
        self.assertEqual(self.faults("call   a30 <troupe::partition::CircleArrays::change_capacity(unsigned long)>"),
                         ["calls troupe::partition::CircleArrays::change_capacity(unsigned long)"])
        self.assertEqual(self.faults("call   *%rax"), ["calls through *%rax"])
        self.assertEqual(faults(f"{HEAD}    1000:\tjmp    1005 <x+0x5>\n{there}memmove-0x4\n")[0][-13:], "calls memmove")

    def test_what_is_allowed(self):
        there = "\t\t\t1001: R_X86_64_PLT32\t"
        for callee in ("memset", "troupe::partition::inverse_range(troupe::partition::RayEdge const&, float)"):
            self.assertEqual(faults(f"{HEAD}    1000:\tcall   1005 <x+0x5>\n{there}{callee}-0x4\n"), [])
        self.assertEqual(self.faults("call   b <troupe::partition::N_AVX2::(anonymous namespace)::project_carefully(int)>",
                                     "jmp    1010 <troupe::partition::N_AVX2::(anonymous namespace)::fan_may_meet(int)+0x10>"),
                         [])

    def test_a_table_that_is_copied_to_the_stack(self):
        pairs = ["movdqa 0x0(%rip),%xmm3        # 1177 <f+0xc7>", "movaps %xmm3,0x50(%rsp)"]
        self.assertEqual(self.faults(*(16 * pairs)), ["writes 256 bytes of constants to the stack"])
        halves = ["movabs $0x302010007060504,%r8", "mov    %r8,0x70(%rsp)"]
        self.assertEqual(self.faults(*(32 * halves)), ["writes 256 bytes of constants to the stack"])
        self.assertEqual(self.faults(*(32 * ["movq   $0x3020100,0x70(%rsp)"])), ["writes 256 bytes of constants to the stack"])

    def test_what_is_computed_may_be_spilled(self):
        pairs = ["vmovaps 0x0(%rip),%ymm3        # 1177 <f+0xc7>", "vaddps %ymm1,%ymm2,%ymm3", "vmovaps %ymm3,0x50(%rsp)"]
        self.assertEqual(self.faults(*(32 * pairs)), [])

    def test_other_functions_are_not_kernels(self):
        text = "0000000000001000 <troupe::partition::may_meet(int)>:\n    1000:\trep movsq %ds:(%rsi),%es:(%rdi)\n"
        self.assertEqual(faults(text), [])


if __name__ == "__main__":
    OBJDUMP, LIBRARY = sys.argv[1:]
    del sys.argv[1:]
    unittest.main()

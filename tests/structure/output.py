#!/usr/bin/env python3
"""Programs write through core/util/console.h, verbs through scripts/lib.sh or lib.py, so that output that cannot be written and
names with hidden characters are dealt with in one place; no verb measures spans of time by the wall clock.

usage: output.py [--root DIR]

Fails on another way to write to stdout or stderr in the sources of programs, on a main that does not run inside run_program
(follower_main is one; an example of the core ends with roads.exit_code()), on a verb that does not begin with lib.sh or end in
lib.run, on a second EXIT trap, and on $SECONDS, $EPOCHSECONDS, $EPOCHREALTIME and time.time() in scripts.
"""
import argparse
import glob
import os
import re
import sys

import sizes

SOURCES = ("core", "wire", "lab", "procs", "render")
OWN_WAYS = {
    "core/util/console.cc",  # the one place
    "core/util/progress.cc",  # a bar on a terminal; console.cc sees the error
    "wire/schema/count_fault_generator.cc",  # a tool of the build
}
WRITES = re.compile(r"std::(cout|cerr|clog)\b|\bfmt::print\b|\b(printf|fprintf|vprintf|puts|fputs|putchar|perror)\s*\(|\bstd(out|err)\b")
FRAME = re.compile(r"\brun_program\(|\bfollower_main\(|\broads\.exit_code\(\)")
CLOCKS = re.compile(r"\$\{?(SECONDS|EPOCHSECONDS|EPOCHREALTIME)\b|\$\(\((?:[^)]*\W)?(SECONDS|EPOCHSECONDS)\b|\btime\.time\(\)")


def read(root, path):
    with open(os.path.join(root, path), encoding="utf-8") as file:
        return file.read()


def sources(root, folders):
    for folder in folders:
        for pattern in ("**/*.cc", "**/*.h"):
            for path in glob.glob(os.path.join(root, folder, pattern), recursive=True):
                yield os.path.relpath(path, root)


def faults_of_sources(root):
    found = []
    for path in sources(root, SOURCES):
        if path in OWN_WAYS:
            continue
        for number, line in enumerate(sizes.plain(read(root, path)).splitlines(), 1):
            if match := WRITES.search(line):
                found.append(f"{path}:{number}: '{match[0]}': write through core/util/console.h")
    for path in sources(root, (*SOURCES, "examples")):
        text = sizes.plain(read(root, path))
        if re.search(r"^int main\(", text, re.M) and path not in OWN_WAYS and not FRAME.search(text):
            found.append(f"{path}: main does not run inside run_program (core/util/console.h)")
    return found


def faults_of_scripts(root):
    found = []
    for path in sorted(glob.glob(os.path.join(root, "scripts", "*"))):
        name = os.path.relpath(path, root)
        text = read(root, name)
        is_verb = os.path.basename(path).startswith("lab-")
        if is_verb and "/lib.sh\"" not in text and "\nlib.run(" not in text:
            found.append(f"{name}: neither lib.sh nor lib.py")
        for number, line in enumerate(text.splitlines(), 1):
            code = line if line.lstrip()[:1] != "#" else ""
            if re.search(r"\btrap\b.*\bEXIT\b", code) and name != "scripts/lib.sh":
                found.append(f"{name}:{number}: a second EXIT trap: define cleanup (lib.sh)")
            if match := CLOCKS.search(code):
                found.append(f"{name}:{number}: '{match[0]}' follows the wall clock: use now, expires_in (lib.sh)")
    return found


def faults(root):
    return faults_of_sources(root) + faults_of_scripts(root)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", default=os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
    found = faults(parser.parse_args().root)
    for fault in found:
        print(fault)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

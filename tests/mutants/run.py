#!/usr/bin/env python3
"""Mutants: changes one operator of the sources at a time, and tells which changes no test notices.

usage: run.py [--count N] [--seed S] [--only GLOB] [--tests REGEX] [--json] [-o DIR]

Picks N (120) places of wire, procs and scripts/supervise by the seed, from a fixed list of operators. Each mutant is built in
a clone of the last commit (-o DIR; kept, so that a second run builds little) and must make a test fail: those of --tests
(by default the unit tests and the scripts' tests of what was changed). What does not compile does not count. Prints a line for
each mutant, then the survivors. Exit 1 when fewer than 95 % were killed.
"""
import argparse
import fnmatch
import json
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
# what is replaced, and by what; only in code, never in comments and strings
CPP = [(r" < ", " <= "), (r" <= ", " < "), (r" > ", " >= "), (r" >= ", " > "), (r" == ", " != "), (r" != ", " == "),
       (r" && ", " || "), (r" \|\| ", " && "), (r" \+ ", " - "), (r" - ", " + "), (r"\bif \(", "if (false && "),
       (r"\bif \(", "if (true || "), (r"\bstd::min\b", "std::max"), (r"\bstd::max\b", "std::min"), (r"\btrue\b", "false"),
       (r"\bfalse\b", "true"), (r"^(\s+)return;$", r"\1;"), (r"^(\s+)break;$", r"\1;"), (r"\+\+(\w)", r"\1"), (r" \+= ", " -= ")]
BASH = [(r" -gt ", " -ge "), (r" -ge ", " -gt "), (r" -lt ", " -le "), (r" -le ", " -lt "), (r" -eq ", " -ne "), (r" = ", " != "),
        (r" && ", " || "), (r" \|\| ", " && "), (r"\bKILL\b", "TERM"), (r" -z ", " -n "), (r" -n ", " -z ")]
# tests by what was changed
TESTS = [("wire/bus/*", "wire_(bus|udpm|tools)"), ("wire/schema/*", "wire_(guard|schema)|fuzz_(guard|schema)"), ("wire/log/*", "wire_log|log_files|fuzz_log"),
         ("wire/*", "^wire_|^system_(one_run|lockstep|requests)$"), ("procs/simulator/*", "simulator_test|direct_test|system_requests"),
         ("procs/planner/*", "planner_test|direct_test"), ("procs/controller/*", "controller_test|direct_test"),
         ("procs/logger/*", "log_files_test|system_one_run|system_groups"), ("procs/send/*", "send_test|system_requests"),
         ("procs/*", "^(?!system_(catalogue|sweep|slurm)).*"), ("scripts/*", "scripts_supervise|system_faults|system_groups")]


def candidates(only):
    """(file, line number, operator) of every place that an operator fits."""
    files = subprocess.run(["git", "ls-files", "wire", "procs", "scripts/supervise", "scripts/lib-process.sh"], cwd=ROOT,
                           capture_output=True, text=True, check=True).stdout.split()
    for file in sorted(files):
        shell = file.startswith("scripts/")
        if not (shell or file.endswith((".cc", ".h"))) or not fnmatch.fnmatch(file, only):
            continue
        for number, line in enumerate((ROOT / file).read_text().splitlines()):
            code = re.split(r"(?:^|\s)#" if shell else "//", line)[0]
            if not shell and ('"' in code or code.lstrip().startswith(("#", "template", "static_assert", "*"))):
                continue
            for index, (pattern, _) in enumerate(BASH if shell else CPP):
                if re.search(pattern, code):
                    yield file, number, index


def mutate(folder, file, number, index):
    """Changes the line; returns what it says now."""
    pattern, replacement = (BASH if file.startswith("scripts/") else CPP)[index]
    path = folder / file
    lines = path.read_text().splitlines(keepends=True)
    line = lines[number]
    if "if (" in replacement:  # close the parenthesis that was opened: the condition must stay one
        head, _, rest = line.partition("if (")
        depth, end = 1, 0
        while end < len(rest) and depth:
            depth += {"(": 1, ")": -1}.get(rest[end], 0)
            end += 1
        if depth:
            return None
        lines[number] = f"{head}{replacement}({rest[:end - 1]}){rest[end - 1:]}"
    else:
        lines[number] = re.sub(pattern, replacement, line, count=1)
    path.write_text("".join(lines))
    return lines[number].strip()


def build(folder):
    return subprocess.run([str(folder / "scripts" / "lab"), "build"], capture_output=True, text=True).returncode == 0


def tests_fail(folder, regex):
    """True when a test noticed, or when one did not end."""
    env = {**os.environ, "LAB_BUILD": str(folder / "build" / "release"), "LAB_TEST_DEADLINE": "30"}
    command = ["ctest", "--test-dir", str(folder / "build" / "release"), "-j", str(os.cpu_count()), "-R", regex, "--stop-on-failure",
               "--timeout", "120", "--no-tests=error"]
    return subprocess.run(command, env=env, capture_output=True, text=True).returncode != 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=120)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="*", help="pattern of files")
    parser.add_argument("--tests", help="regular expression of ctest")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("-o", dest="folder", help="folder of the clone")
    options = parser.parse_args()
    folder = pathlib.Path(options.folder or tempfile.mkdtemp(prefix="mutants.")).resolve()
    if not (folder / ".git").exists():
        subprocess.run(["git", "clone", "-q", str(ROOT), str(folder)], check=True)
    subprocess.run(["git", "checkout", "-q", "."], cwd=folder, check=True)
    if not build(folder):
        sys.exit(f"mutants: {folder} does not build")
    places = list(candidates(options.only))
    random.Random(options.seed).shuffle(places)
    done = []
    for file, number, index in places:
        if len(done) == options.count:
            break
        now = mutate(folder, file, number, index)
        outcome = None
        if now and (file.startswith("scripts/") or build(folder)):
            regex = options.tests or next(tests for pattern, tests in TESTS if fnmatch.fnmatch(file, pattern))
            outcome = "killed" if tests_fail(folder, regex) else "survived"
            done.append({"place": f"{file}:{number + 1}", "line": now, "outcome": outcome})
        subprocess.run(["git", "checkout", "-q", file], cwd=folder, check=True)
        if outcome and not options.json:
            print(f"{outcome:8} {file}:{number + 1}: {now}", flush=True)
    killed = sum(one["outcome"] == "killed" for one in done)
    print(json.dumps(done, indent=2) if options.json else f"{killed} of {len(done)} killed")
    return 1 if killed < 0.95 * len(done) else 0


if __name__ == "__main__":
    sys.exit(main())

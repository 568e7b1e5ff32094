#!/usr/bin/env python3
"""Mutants: changes one operator of the sources at a time, and tells which changes no test notices.

usage: run.py [--count N] [--seed S] [--only GLOB] [--units] [--again] [-j N] [-o DIR]

Picks N (120) places of wire, procs, scripts/supervise and scripts/lib-process.sh by the seed, from a fixed list of operators;
which ones does not depend on other lines. Each mutant is built (preset dev) in a clone of the last commit, DIR/lab, and must
make a test fail that passes without it: first the unit tests of what was changed, one program after another, then the system
tests named for it. What does not compile does not count, nor do the changes that tests/mutants/equivalent.txt explains:
others are taken instead. Prints a line for each mutant, then the survivors. Exit 1 when fewer than 95 % were killed.

  --only GLOB   only files like this
  --units       only the unit tests; those that they do not notice are `unseen`, and a run without this option tries the rest
  --again       try those once more that were not killed in the results of DIR
  -j N          this many compilers at once (default: one per CPU)
  -o DIR        keeps the clone and results.jsonl there: a run that was interrupted goes on, a second one builds little

example: nice tests/mutants/run.py --only 'wire/schema/*' --count 20 -o /tmp/mutants
"""
import argparse
import collections
import fnmatch
import hashlib
import json
import os
import pathlib
import re
import resource
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
# what was changed; the unit tests that should notice, which are ninja targets too (but for those of scripts); pytest's
# words for the system tests of what these cannot see
PROTOCOL = " ".join(f"wire_{name}_test" for name in ("lockstep_logger lockstep_follower simulator_role realtime_simulator "
                                                     "realtime_follower publishers input_queue lockstep").split())
RUN = "test_lockstep.py -k 'what_solo_writes or lost_in_the_endpoints or last_bit'"
LABS = "test_requests.py test_groups.py test_faults.py"
TESTS = [
    ("wire/schema/*", "wire_schema_test wire_guard_test guard_fuzz_smoke schema_fuzz_smoke wire_schema_lcmgen_test", RUN),
    ("wire/log/*", "wire_log_test log_fuzz_smoke log_files_test", RUN),
    ("wire/bus/*", "wire_udpm_wire_test wire_bus_net_test wire_spin_net_test wire_routes_net_test", "test_spy.py test_groups.py"),
    ("wire/process/*", "wire_launch_record_test wire_participant_test wire_participant_net_test", LABS),
    ("wire/protocol/*", PROTOCOL, f"{LABS} test_lockstep.py"),
    ("procs/simulator/replay.*", "simulator_test truth_test", LABS),
    ("procs/simulator/role.*", "direct_test", LABS),
    ("procs/simulator/*", "simulator_test", LABS),
    ("procs/planner/*", "planner_test", LABS),
    ("procs/controller/*", "controller_test laws_test own_model_test", LABS),
    ("procs/logger/*", "log_files_test", LABS),
    ("procs/renderer/role.*", "renderer_role_test", "test_pictures.py"),
    ("procs/renderer/[efw]*", "renderer_work_test", "test_pictures.py"),  # encoder, frames, from_log, workers
    ("procs/renderer/[lmv]*", "", "test_pictures.py"),  # logged, main, video
    ("procs/renderer/*", "renderer_pictures_test", "test_pictures.py"),
    ("procs/send/guest.*", "guest_net_test", LABS),
    ("procs/send/*", "send_test", LABS),
    ("procs/spy/*", "spy_test", "test_spy.py"),
    ("procs/solo/*", "direct_test", RUN),
    ("scripts/*", "scripts_supervise", LABS)]
PROGRAMS = "lab-simulator lab-planner lab-controller lab-logger lab-solo lab-send lab-spy lab-experiment test-controller".split()
Place = collections.namedtuple("Place", "file number index before after nth")


def mutated(line, pattern, replacement):
    """The line with its operator changed; None when it cannot be."""
    if "if (" not in replacement:
        return re.sub(pattern, replacement, line, count=1)
    head, _, rest = line.partition("if (")  # close the parenthesis that was opened: the condition must stay one
    if rest.startswith(("const ", "auto ")):  # .. and a declaration is none
        return None
    depth, end = 1, 0
    while end < len(rest) and depth:
        depth += {"(": 1, ")": -1}.get(rest[end], 0)
        end += 1
    return None if depth else f"{head}{replacement}({rest[:end - 1]}){rest[end - 1:]}"


def candidates(folder, only):
    """Every Place of the sources that an operator fits."""
    files = subprocess.run(["git", "ls-files", "wire", "procs", "scripts/supervise", "scripts/lib-process.sh"], cwd=folder,
                           capture_output=True, text=True, check=True).stdout.split()
    for file in files:
        shell = file.startswith("scripts/")
        if not (shell or file.endswith((".cc", ".h"))) or not fnmatch.fnmatch(file, only):
            continue
        seen = collections.Counter()
        for number, line in enumerate((folder / file).read_text().splitlines()):
            code = re.split(r"(?:^|\s)#" if shell else "//", line)[0]
            if not shell and ('"' in code or code.lstrip().startswith(("#", "template", "static_assert", "*"))):
                continue
            seen[line] += 1
            for index, (pattern, replacement) in enumerate(BASH if shell else CPP):
                after = mutated(line, pattern, replacement) if re.search(pattern, code) else None
                if after is not None:
                    yield Place(file, number, index, line.strip(), after, seen[line])


def drawn(folder, seed, only):
    """The places in the order of the seed, without those that are known to be equivalent."""
    known = (ROOT / "tests" / "mutants" / "equivalent.txt").read_text().splitlines()

    def explained(p):
        which = f" ({p.nth}.)" if p.nth > 1 else ""  # of several lines that are the same
        return any(line.startswith(f"{p.file}: {p.before}{which} => {p.after.strip()}: ") for line in known)

    places = [p for p in candidates(folder, only) if not explained(p)]
    return sorted(places, key=lambda p: hashlib.sha256(f"{seed} {p.file} {p.before} {p.nth} {p.index}".encode()).digest())


def limit():
    """A mutant may go on for ever and take all memory; a part of the build, count_fault_generator, is made of mutants too."""
    resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
    resource.setrlimit(resource.RLIMIT_CPU, (60, 60))  # s, each process


def succeeds(folder, *command, seconds=1200):
    """(whether the command did well within the limits, what it printed)"""
    env = {**os.environ, "LAB_BUILD": str(folder / "build" / "dev"), "LAB_TEST_DEADLINE": "30", "GTEST_FAIL_FAST": "1",
           "BATS_TEST_TIMEOUT": "20", "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(["timeout", "-k", "10", str(seconds), *command], env=env, cwd=folder / "tests" / "system", text=True,
                          errors="replace", stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          preexec_fn=limit)
    return done.returncode == 0, done.stdout


def build(folder, targets, jobs):
    words = [word for target in targets for word in ("--target", target)]
    return succeeds(folder, folder / "scripts" / "lab", "build", "--preset", "dev", "-j", str(jobs), *words)[0]


def test(folder, *command, seconds):
    """The command on a network and with process numbers of its own, so that nothing of a mutant is left."""
    netns = folder / "tests" / "support" / "netns.sh"
    return succeeds(folder, netns, "unshare", "--pid", "--fork", "--kill-child", "--mount-proc", *command, seconds=seconds)


def unit_test(folder, name):
    pattern = "^" + re.sub("(.*)_smoke$", r"fuzz_\1", name) + "$"
    return test(folder, "ctest", "--test-dir", folder / "build" / "dev", "-R", pattern, "--no-tests=error", seconds=300)[0]


def system_tests(folder, words):
    """The first system test that fails, or None."""
    pytest = f"exec pytest-3 -x -q -rf -p no:cacheprovider -m 'not (robots or ffmpeg)' {words}"
    fine, said = test(folder, "sh", "-c", pytest, seconds=600)
    found = re.search(r"^FAILED (\S+)", said, re.MULTILINE)
    return None if fine else found.group(1) if found else words


class Judge:
    """Says of one mutant in the clone which test notices it."""

    def __init__(self, folder, jobs, only_units):
        self.folder, self.jobs, self.only_units = folder, jobs, only_units
        self.sound = set()  # tests that pass without a mutant, and do not depend on the clock

    def stages(self, file, seen):
        """(programs to build, a function that gives the name of a test that fails or None), the quick ones first."""
        units, words = next(row[1:] for row in TESTS if fnmatch.fnmatch(file, row[0]))
        for name in units.split() if not seen else []:
            yield [] if file.startswith("scripts/") else [name], lambda name=name: None if unit_test(self.folder, name) else name
        if not self.only_units:
            programs = ["lab-spy"] if words == "test_spy.py" else PROGRAMS + ["lab-renderer"] * ("renderer" in file)
            yield programs, lambda: system_tests(self.folder, words)

    def outcome(self, place, seen):
        """killed, survived (or `unseen` by the unit tests alone), doubtful (the test fails without the mutant, too) or broken
        (does not compile), and the test. `seen`: the unit tests have had their turn."""
        path = self.folder / place.file
        text = path.read_text()
        lines = text.splitlines(keepends=True)
        lines[place.number] = place.after + "\n"
        path.write_text("".join(lines))
        try:
            for targets, failing in self.stages(place.file, seen):
                if targets and not build(self.folder, targets, self.jobs):
                    return "broken", None
                name = failing()
                if name:
                    break
            else:
                return "unseen" if self.only_units else "survived", None
        finally:
            path.write_text(text)
        if name in self.sound:
            return "killed", name
        if targets and not build(self.folder, targets, self.jobs):
            sys.exit(f"mutants: {self.folder} does not build without a mutant")
        fails = system_tests(self.folder, f"'{name}'") if ".py" in name and "'" not in name else failing()
        if not fails and not re.search("_net_|participant|scripts|[.]py", name):
            self.sound.add(name)
        return ("doubtful" if fails else "killed"), name


def clone(folder):
    """The last commit of the sources, in the folder."""
    if not folder.exists():
        subprocess.run(["git", "clone", "-q", str(ROOT), str(folder)], check=True)
    for words in (["fetch", "-q", "origin", "HEAD"], ["checkout", "-q", "--force", "FETCH_HEAD"]):
        subprocess.run(["git", *words], cwd=folder, check=True)


def known_results(file, again):
    """The newest result of each place; with `again` without survivors."""
    results = {}
    for line in file.read_text().splitlines() if file.exists() else []:
        one = json.loads(line)
        results[one["file"], one["before"], one["after"], one["nth"]] = one
    return {key: one for key, one in results.items() if not again or one["outcome"] in ("killed", "broken")}


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1].replace("%", "%%"))
    parser.add_argument("--count", type=int, default=120)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="*")
    parser.add_argument("--units", action="store_true")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("-j", dest="jobs", type=int, default=os.cpu_count())
    parser.add_argument("-o", dest="folder")
    options = parser.parse_args()
    folder = pathlib.Path(options.folder or tempfile.mkdtemp(prefix="mutants.")).resolve()
    folder.mkdir(exist_ok=True)
    clone(folder / "lab")
    results = known_results(folder / "results.jsonl", options.again)
    judge, done = Judge(folder / "lab", options.jobs, options.units), []
    for place in drawn(folder / "lab", options.seed, options.only):
        if len(done) == options.count:
            break
        after = place.after.strip()
        one = results.get((place.file, place.before, after, place.nth))
        if not one or (one["outcome"] == "unseen" and not options.units):
            outcome, test = judge.outcome(place, bool(one))
            one = {"file": place.file, "before": place.before, "after": after, "nth": place.nth, "outcome": outcome, "test": test}
            with (folder / "results.jsonl").open("a") as file:
                file.write(json.dumps(one) + "\n")
            print(f"{outcome:8} {place.file}:{place.number + 1}: {after}{f'  [{test}]' if test else ''}", flush=True)
        if one["outcome"] != "broken":
            done.append((f"{place.file}:{place.number + 1}: {after}", one["outcome"]))
    killed = sum(outcome == "killed" for _, outcome in done)
    for what, outcome in done:
        if outcome != "killed":
            print(f"not killed ({outcome}): {what}")
    print(f"{killed} of {len(done)} killed")
    return 1 if killed < 0.95 * len(done) else 0


if __name__ == "__main__":
    sys.exit(main())

"""lab bench core: the dynamics core against other libraries, all in one session.

Writes each robot and its states to a file once, lets every program measure it, one after the other on one core, and
compares: first that all computed the same numbers (else exit 1), then how fast. docs/bench.md says how to read it.
"""
import argparse
import datetime
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import report

ROOT = pathlib.Path(os.environ["LAB_ROOT"])
PROGRAMS = pathlib.Path(os.environ["LAB_BUILD"]) / "bin"
DATA = pathlib.Path(os.environ["LAB_ROBOTS"]) / "example-robot-data/robots"
PEERS = ["pinocchio", "mujoco", "kdl"]

ROBOTS = {  # name: arguments of bench-robots
    "simple_3dof_arm": [ROOT / "models/simple_3dof_arm.urdf"],
    "manipulator": ["builtin:manipulator"],
    "ur5": [DATA / "ur_description/urdf/ur5_robot.urdf"],
    "panda": [DATA / "panda_description/urdf/panda.urdf", "--lock", "finger"],
    "solo12": [DATA / "solo_description/robots/solo12.urdf", "--floating"],
    "anymal": [DATA / "anymal_b_simple_description/robots/anymal.urdf", "--floating"],
    "humanoid": ["builtin:humanoid"],
    "talos": [DATA / "talos_data/robots/talos_reduced.urdf", "--floating"],
}
SCALING = [f"{kind}:{n}" for kind in ("chain", "tree") for n in (1, 3, 10, 30, 100, 300, 1000)]


def say(text):
    print(f"lab bench core: {text}", file=sys.stderr, flush=True)


def progress(text):
    """On a terminal one line that is written over and over; elsewhere one line a step."""
    if sys.stderr.isatty():
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)
    elif text:
        print(text, file=sys.stderr, flush=True)


def options():
    words = lambda text: [w for w in text.split(",") if w]
    p = argparse.ArgumentParser(
        prog="lab bench core", allow_abbrev=False, formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Nanoseconds per call of the dynamics core, and its ratio to the best of other libraries (docs/bench.md).",
        epilog="Peers that are missing are built first, in the cache folder (bench/peers/build --help); what cannot be is named.\n"
               "Exit code 1: the libraries did not compute the same numbers. Speed is never a failure.\n\n"
               "example: scripts/lab bench core --robots panda,talos --algorithms rnea,aba --peers pinocchio")
    p.add_argument("--robots", type=words, metavar="NAME,..",
                   help=f"of {', '.join(ROBOTS)}; a URDF file; chain:N, tree:N; scaling: both from 1 to 1000 joints (default: all)")
    p.add_argument("--algorithms", type=words, default=[], metavar="NAME,..",
                   help="rows to measure, named as in the output (default: all; rnea and aba of chains and trees)")
    p.add_argument("--peers", type=words, default=PEERS, metavar="NAME,..", help=f"of {', '.join(PEERS)}; none (default: all)")
    p.add_argument("--rounds", type=int, default=2, metavar="N", help="passes over everything; the best counts (2)")
    p.add_argument("--quick", action="store_true", help="short blocks: to see that it works, not to trust it")
    p.add_argument("--json", action="store_true", help="JSON on stdout instead of lines and tables")
    p.add_argument("--from", dest="lines", metavar="FILE", help="no measurement: lines of an earlier one")
    p.add_argument("-o", dest="folder", type=pathlib.Path, default=ROOT / "build/bench-core", metavar="DIR",
                   help="where lines.txt, results.json and ratios.svg go (build/bench-core)")
    o = p.parse_args()
    if o.robots is None:
        o.robots = [*ROBOTS, "scaling"]
    o.robots = [name for r in o.robots for name in (SCALING if r == "scaling" else [r])]
    for r in o.robots:
        kind, _, n = r.partition(":")
        if r not in ROBOTS and not r.endswith(".urdf") and not (kind in ("chain", "tree") and n.isdecimal() and 0 < int(n) <= 3000):
            p.error(f"no robot '{r}'; there are {', '.join(ROBOTS)}, scaling, chain:N, tree:N (N up to 3000), files that end in .urdf")
    o.peers = [] if o.peers == ["none"] else o.peers
    for peer in o.peers:
        if peer not in PEERS:
            p.error(f"no peer '{peer}'; there are {', '.join(PEERS)}, or none")
    if o.rounds < 1:
        p.error("--rounds is a whole number above 0")
    return o


def quietest_core():
    """Of the cores we may use, the one that idled most during a moment's look (of equals the last: interrupts like the first)."""
    def idle():
        lines = (line.split() for line in open("/proc/stat") if line.startswith("cpu") and line[3].isdigit())
        return {int(w[0][3:]): int(w[4]) for w in lines}
    before = idle()
    time.sleep(0.3)
    after = idle()
    return max(os.sched_getaffinity(0), key=lambda c: (after.get(c, 0) - before.get(c, 0), c))


def write_robot(name, folder):
    """The robot as a file for all programs, or None and why."""
    arguments = ROBOTS.get(name, [name])
    short = pathlib.Path(name).stem if name.endswith(".urdf") else name
    if name in ROBOTS and str(arguments[0]).startswith(str(DATA)) and not DATA.is_dir():
        return None, "it is downloaded by scripts/lab robots"
    path = folder / short.replace(" ", "_")
    with open(path, "w") as out:
        done = subprocess.run([PROGRAMS / "bench-robots", path.name, *arguments], stdout=out, stderr=subprocess.PIPE, text=True)
    return (path, "") if done.returncode == 0 else (None, done.stderr.strip())


def small(name):
    """Chains and trees that peers are asked for: beyond, those whose cost is cubic take minutes, and GBs."""
    return ":" not in name or int(name.partition(":")[2]) <= 100


def peer_programs(peers):
    """Those that are ready after bench/peers/build, {name: program}; it says itself what is not, and why."""
    if not peers:
        return {}
    built = subprocess.run([ROOT / "bench/peers/build", *peers], stdout=subprocess.PIPE, text=True).stdout
    return dict(line.split(maxsplit=1) for line in built.splitlines())


def measure(o):
    """All lines of all programs, in order."""
    for program in ("bench-core", "bench-robots"):
        if not os.access(PROGRAMS / program, os.X_OK):
            say(f"{program} is not built: run scripts/lab build first")
            sys.exit(2)
    programs = {"lcmlab": str(PROGRAMS / "bench-core"), **peer_programs(o.peers)}
    lines = [f"# {datetime.date.today()}, {cpu()}" + (", quick: not to be trusted" if o.quick else "")]
    lines += [f"# skipped {peer}" for peer in o.peers if peer not in programs]
    with tempfile.TemporaryDirectory() as temporary:
        files = {}
        for name in o.robots:
            files[name], why = write_robot(name, pathlib.Path(temporary))
            if files[name] is None:
                say(f"{name} is skipped: {why}")
                lines.append(f"# skipped {name}")
        files = {name: file for name, file in files.items() if file}
        core = quietest_core()
        # one program right after the other: what drifts, drifts for all
        work = [(name, peer) for _ in range(o.rounds) for name in files for peer in programs if peer == "lcmlab" or small(name)]
        for done, (name, peer) in enumerate(work, 1):
            file = files[name]
            only = o.algorithms or (["rnea", "aba"] if ":" in name else [])
            words = (["--quick"] if o.quick else []) + (["--only", ",".join(only)] if only else []) + [file]
            progress(f"[{done}/{len(work)}] {file.name}: {peer}")
            run = subprocess.run([programs[peer], *words], stdout=subprocess.PIPE, text=True, cwd=temporary,
                                 preexec_fn=lambda: os.sched_setaffinity(0, {core}))
            lines += [line for line in run.stdout.splitlines() if line[0] != "#" or line not in lines]
            if run.returncode != 0:
                say(f"{peer} failed on {file.name} (exit code {run.returncode})")
                if peer == "lcmlab":
                    sys.exit(1)
        progress("")
    return lines


def cpu():
    words = {}
    for line in open("/proc/cpuinfo"):
        key, _, value = line.partition(":")
        words.setdefault(key.strip(), value.strip())
    return f"{words.get('model name', 'unknown CPU')} (family {words.get('cpu family', '?')}, model {words.get('model', '?')})"


def main():
    o = options()
    try:
        lines = open(o.lines).read().splitlines() if o.lines else measure(o)
    except OSError as error:
        say(f"{o.lines}: {error.strerror}; give the lines.txt of an earlier bench")
        return 2
    results = report.Results(lines)
    o.folder.mkdir(parents=True, exist_ok=True)
    (o.folder / "lines.txt").write_text("\n".join(lines) + "\n")
    text = json.dumps(results.json(), indent=1)
    (o.folder / "results.json").write_text(text + "\n")
    (o.folder / "ratios.svg").write_text(report.svg(results))
    print(text if o.json else "\n".join(lines) + "\n\n" + report.tables(results))
    say(f"lines.txt, results.json and ratios.svg are in {o.folder}")
    for problem in results.disagreements():
        say(f"NOT THE SAME NUMBERS: {problem}")
    return 1 if results.disagreements() else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)

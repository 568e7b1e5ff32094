"""Every program and verb with stdout and stderr that cannot be written: no abort, and no success where something was lost."""
import os
import signal
import subprocess

import pytest

from labrun import BUILD, DEADLINE, LAB, ROOT, environment, solo
from locales import LOCALES, locale

BIN = BUILD / "bin"
ALL = os.environ.get("LAB_TEST_OUTPUT") == "all"  # lab test --full; else a sixth of the verbs' help
EXPERIMENT = str(ROOT / "experiments" / "cubic_pd.yaml")
# What each command prints is asked of the command itself, with both streams kept. {log} is a short run, {new} a new name. No
# lab is on memq://, which is this process' own memory.
COMMANDS = [
    ("lab-experiment", "check", EXPERIMENT),
    ("lab-experiment", "check", "--json", EXPERIMENT),
    ("lab-experiment", "check", "nix.yaml"),
    ("lab-experiment", "resolve", EXPERIMENT),
    ("lab-experiment", "processes", EXPERIMENT),
    ("lab-experiment", "keys"),
    ("lab-experiment", "evaluate", "{log}"),
    ("lab-experiment", "report", "{log}"),
    ("lab-experiment", "sweep", str(ROOT / "experiments" / "sweeps" / "kp_kd.yaml"), "--dry-run"),
    ("lab-model", "info", str(ROOT / "models" / "simple_3dof_arm.urdf")),
    ("lab-model", "tree", "builtin:humanoid"),
    ("lab-model", "check", "nix.urdf"),
    ("lab-solo", EXPERIMENT, "--set", "simulator.duration=0.1", "--run-dir", "{new}"),
    ("lab-solo", "nix.yaml", "--run-dir", "{new}"),
    ("lab-spy", "--url", "memq://", "list", "--for", "0.01"),
    ("lab-spy", "--url", "memq://", "who", "--for", "0.01", "--json"),
    ("lab-spy", "--url", "memq://", "echo", "RUN", "--timeout", "0.01"),
    ("lab-send", "--url", "memq://", "pause", "--timeout", "0.01"),
    ("lab-simulator", "--experiment", "nix.yaml"),
    ("lab-planner", "--url", "memq://", "--ready", "0.01"),
    ("lab-controller", "--url", "memq://", "--ready", "0.01"),
    ("lab-logger", "--url", "memq://", "--ready", "0.01", "--run-dir", "{new}"),
    ("lab-renderer", "{log}", "--times", "0,0.1", "--size", "32x32", "--quality", "draft", "-o", "{new}"),
    *[(f"lab-{name}", "--help") for name in ("experiment", "model", "solo", "spy", "send", "simulator", "planner", "controller",
                                             "logger", "renderer")],
    ("../examples/05_1_first_model",),
    ("../examples/07_2_jacobian",),
    ("../examples/own_controller", "--help"),
]
VERBS = [(LAB, "help"), (LAB, "ls"), (LAB, "ls", "--json"), (LAB, "ps"), (LAB, "ps", "--json"), (LAB, "doctor"), (LAB, "doctor", "--json"),
         (LAB, "nix"), (LAB, "run", "nix"), (LAB, "run", EXPERIMENT, "--solo", "--set", "simulator.duration=0.1", "--set", "expect={{}}", "-o", "{new}"),
         *[(LAB, path.name[4:], "--help") for path in sorted((ROOT / "scripts").glob("lab-*"))[::1 if ALL else 6]]]
STREAMS = ["full", "closed", "pipe"]


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with one short run and one locale folder."""
    folder = tmp_path_factory.mktemp("output")
    (folder / "locales").mkdir()
    (folder / "runs").mkdir()
    solo(EXPERIMENT, folder / "log", "--set", "simulator.duration=0.2", "--set", "expect={}", "--no-report")
    return folder


def become(fd, stream):
    """In the child: makes stdout or stderr one that cannot be written."""
    if stream == "full":
        os.dup2(os.open("/dev/full", os.O_WRONLY), fd)
    elif stream == "closed":
        os.close(fd)
    elif stream == "pipe":
        reader, writer = os.pipe()
        os.close(reader)
        os.dup2(writer, fd)


count = 0


def call(place, command, env, out=None, err=None):
    """(exit code as a shell says it, stdout, stderr)"""
    global count
    count += 1
    program = command[0] if command[0] == LAB else str(BIN / command[0])
    words = [w.format(log=place / "log", new=place / f"new{count}") for w in command[1:]]
    done = subprocess.run([program, *words], cwd=place, env=environment(LAB_RUNS=str(place / "runs"), **env), stdin=subprocess.DEVNULL,
                          capture_output=True, timeout=DEADLINE, preexec_fn=lambda: (become(1, out), become(2, err)))
    return (done.returncode if done.returncode >= 0 else 128 - done.returncode, done.stdout.decode(errors="replace"),
            done.stderr.decode(errors="replace"))


def faults_of(place, command, env):
    code, said, complained = call(place, command, env)
    found = []
    for stream in STREAMS:
        for name, text, streams in (("stdout", said, {"out": stream}), ("stderr", complained, {"err": stream}),
                                    ("both", said + complained, {"out": stream, "err": stream})):
            got, _, err = call(place, command, env, **streams)
            lost = bool(text.strip())
            expected = {code} if not lost else {code or 1, 128 + signal.SIGPIPE} if stream == "pipe" else {code or 1}
            if got not in expected:
                found.append(f"{' '.join(command)}: {name} {stream}: {got}, not {sorted(expected)}: {err[-200:]}")
            if name == "stdout" and lost and stream != "pipe" and not err.strip():
                found.append(f"{' '.join(command)}: stdout {stream}: nothing on stderr")
    return found


@pytest.mark.parametrize("name", LOCALES)
def test_programs_with_streams_that_cannot_be_written(place, name):
    env = locale(place / "locales", name)
    assert [f for command in COMMANDS for f in faults_of(place, command, env)] == []


def test_verbs_with_streams_that_cannot_be_written(place):
    assert [f for command in VERBS for f in faults_of(place, command, {"LC_ALL": "C"})] == []

"""Random command lines in a folder full of somebody's files: nothing changes but what the command lines name as their output."""
import os
import random
import shlex
import subprocess

import labrun as lab

LINES = int(os.environ.get("LAB_TEST_LINES", 50))
THEIRS = {
    "experiment.yaml": lab.MOTION.format(root=lab.ROOT, dt=0.01, duration=0.1),
    "motion.yaml": lab.MOTION.format(root=lab.ROOT, dt=0.01, duration=0.1),
    "sweep.yaml": "experiment: motion.yaml\ngrid: {controller.kp: [80, 100]}\n",
    "group": "a: true\n", "manifest.json": '{"mine": 1}\n', "report.html": "<p>mine", "metrics.json": "{}\n", "sweep.csv": "a,b\n",
    "compare.html": "<p>mine", "log.lcm": "mine", "log.lcm.part": "mine", "telemetry.lcm": "mine", "contact.png": "mine",
    "out.mp4": "mine", "gl.txt": "mine", "frames/0001.png": "mine", "processes/Procfile": "a: true\n", "processes/state": "mine",
    "sub/experiment.yaml": "# As I like it\n", "sub/frames/0000.png": "mine", "sub/log.lcm": "mine", "runs/mine.txt": "mine",
}
OUTPUTS = [".", "sub", "frames", "runs", "experiment.yaml", "new", "fresh/deep", "./"]
RUNS = ["motion.yaml", "experiment.yaml", "sub", ".", "nothing.yaml", "latest", "log.lcm", "sub/log.lcm", "../base"]


def command_lines(random_):
    """Endless: verbs with a person's paths as their inputs and outputs, right and wrong."""
    out = lambda: ["-o", random_.choice(OUTPUTS)]  # noqa: E731
    run = lambda: random_.choice(RUNS)  # noqa: E731
    kinds = [
        lambda: ["run", run(), *out(), "--solo"],
        lambda: ["run", run(), *out()],
        lambda: ["run", "motion.yaml", *out(), "--solo", "--set", "controller.kp=abc"],
        lambda: ["up", run(), *out(), "--private"],
        lambda: ["up", "-f", "group", *out(), "--private"],
        lambda: ["sweep", "sweep.yaml", *out()],
        lambda: ["sweep", run(), *out()],
        lambda: ["render", run(), "--times", "0", *out()],
        lambda: ["render", run(), "--contact", "2", *out()],
        lambda: ["report", run()],
        lambda: ["compare", run(), run(), *out()],
        lambda: ["clean", "--yes", run()],
        lambda: ["clean", run()],
        lambda: ["ls", run()],
        lambda: ["check", run()],
        lambda: ["logs", run()],
        lambda: ["down", "--lab", run()],
        lambda: ["wait", "--exit", "--timeout", "1", "--lab", run()],
    ]
    while True:
        yield random_.choice(kinds)()


def stamps(folder):
    """What find -newer looks at, and the content."""
    return {str(p.relative_to(folder)): (p.lstat().st_mtime_ns, p.read_bytes()) for p in folder.rglob("*") if p.is_file()}


def test_random_command_lines_leave_a_persons_files_alone(tmp_path):
    folder, runs = tmp_path / "folder", tmp_path / "runs"
    for name, text in THEIRS.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    theirs, ended = stamps(folder), []
    for words, _ in zip(command_lines(random.Random(17)), range(LINES)):
        before = stamps(folder)
        done = subprocess.run([lab.LAB, *words], cwd=folder, env=lab.environment(LAB_RUNS=str(runs)), capture_output=True, text=True,
                              timeout=lab.DEADLINE, stdin=subprocess.DEVNULL)
        line, after = shlex.join(words), stamps(folder)
        ended.append(done.returncode)
        assert {name: after.get(name) for name in theirs} == theirs, line
        named = words[words.index("-o") + 1].rstrip("/") if "-o" in words else None
        for name in {name for name in before.keys() | after.keys() if before.get(name) != after.get(name)}:
            assert named and (name == named or name.startswith(named + "/")), f"{line} changed {name}"
    assert 0 in ended and 2 in ended, "some are right and some are wrong"

"""The same Procfile under other runners: honcho (PyPI) and foreman (apt)."""
import os
import shutil
import signal
import subprocess

import pytest

import labrun as lab

RUNNERS = {"honcho": str(lab.BUILD / "pyenv" / "bin" / "honcho"), "foreman": shutil.which("foreman") or "foreman"}


@pytest.fixture(params=["honcho", pytest.param("foreman", marks=pytest.mark.foreman)])
def start(request):
    """Starts a Procfile under the runner, on a private bus."""
    program = RUNNERS[request.param]
    if not os.access(program, os.X_OK):
        pytest.skip(f"no {request.param} here")
    words = [lab.ISOLATE, program, "start", "-f"]
    path = f"{lab.BUILD}/bin:{os.environ['PATH']}"
    return lambda folder: subprocess.Popen([*words, str(folder / "Procfile")], env=lab.environment(PATH=path), cwd=folder,
                                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, stdin=subprocess.DEVNULL)


def group(folder, file, *options):
    """A run folder with the Procfile that `lab run` would make."""
    folder.mkdir()
    tool = str(lab.BUILD / "bin" / "lab-experiment")
    subprocess.run([tool, "resolve", file, *options, "-o", str(folder / "experiment.yaml")], check=True)
    text = subprocess.run([tool, "processes", str(folder / "experiment.yaml"), "--run-dir", str(folder)], check=True, capture_output=True, text=True).stdout
    (folder / "Procfile").write_text(text)
    return folder


def test_a_run_is_the_same_run(start, tmp_path):
    """Who ends first makes them end the others; the log is whole all the same, and so are the pictures."""
    file = lab.experiment(tmp_path, dt=0.005, duration=60.0)  # long enough for the renderer to be there before the end
    pictures = ["--set", "renderer.enabled=true", "--set", "renderer.fps=0.5", "--set", "renderer.size=[64, 48]"]
    folder = group(tmp_path / "run", file, *pictures)
    out, _ = start(folder).communicate(timeout=lab.DEADLINE)
    assert (folder / "log.lcm").exists(), out
    assert (folder / "log.lcm").read_bytes() == lab.solo(file, tmp_path / "solo"), out
    assert len(list((folder / "frames").glob("*.png"))) == 31, out
    assert not lab.leftovers(folder)


def test_interrupted_in_real_time_it_ends_cleanly(start, tmp_path):
    file = lab.experiment(tmp_path, dt=0.005, duration=600)
    folder = group(tmp_path / "run", file, "--set", "simulator.clock=realtime")
    runner = start(folder)
    try:
        part = folder / "log.lcm.part"
        lab.until(lambda: part.exists() and any(c == "COMMAND" for c, _ in lab.events(part)), "a command")
        os.kill(children(runner.pid), signal.SIGINT)
        out, _ = runner.communicate(timeout=lab.DEADLINE)
    finally:
        runner.kill()
    channels = [channel for channel, _ in lab.events(folder / "log.lcm")]
    assert channels[0] == "RUN" and channels.count("ROBOT_STATE") > 0, out
    lab.until(lambda: not lab.leftovers(folder), "all processes to end")


def children(pid):
    """The runner itself: the last of the chain that isolate is."""
    while True:
        below = subprocess.run(["pgrep", "-P", str(pid)], capture_output=True, text=True).stdout.split()
        line = open(f"/proc/{pid}/cmdline").read()
        if ("honcho" in line or "foreman" in line) and "isolate" not in line and "unshare" not in line or not below:
            return pid
        pid = int(below[0])

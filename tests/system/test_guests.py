"""Plain LCM programs beside a lab: a controller that nobody of the lab started, a logger that comes late, a publisher on other
channels. The rules that keep strangers out (attacks.py) let these in. ctest runs this in a private network."""
import os
import shutil
import signal
import subprocess

import pytest

import labrun as lab
from labrun import call, ok

PUBLISHER = """
import sys
import lcm
bus = lcm.LCM(sys.argv[1])
for n in range(2000):
    bus.publish("CAMERA", bytes(2000))
    bus.publish("MY_ROBOT_STATE", bytes(100))
print("published")
"""


@pytest.fixture
def python():
    found = lab.BUILD / "pyenv" / "bin" / "python"
    if not os.access(found, os.X_OK):
        pytest.skip("no Python with LCM here (tests/conformance/pyenv.sh)")
    return found


def test_plain_lcm_programs_take_part(python, tmp_path):
    runs, folder = tmp_path / "runs", tmp_path / "runs" / "live"
    types = lab.generated_types(tmp_path / "types")
    programs = []

    def start(*words):
        environment = lab.environment(LCM_DEFAULT_URL=lab.bus_of(folder), PYTHONPATH=str(tmp_path / "types"))
        programs.append(subprocess.Popen([str(word) for word in words], stdin=subprocess.DEVNULL, cwd=tmp_path, env=environment))
        return programs[-1]

    def events():
        for name in ("log.lcm.part", "log.lcm"):
            if (folder / name).exists():
                return [types.event_t.decode(data) for channel, data in lab.events(folder / name) if channel == "EVENT"]
        return []

    def whats(after):
        return [event.what for event in events()[after:]]

    ok(call(runs, "up", "-d", "-f", lab.live_experiment(tmp_path), "simulator", "planner", "logger"))
    try:
        controller = start(python, lab.ROOT / "examples" / "controller.py", 100, 20)
        lab.until(lambda: "running" in whats(0), "the robot is moved by a controller that the lab did not start")
        for _ in range(3):  # it dies, and another one takes its place
            before = len(events())
            controller.send_signal(signal.SIGKILL)
            controller.wait()
            lab.until(lambda: "holding" in whats(before), "the robot is held")
            controller = start(python, lab.ROOT / "examples" / "controller.py", 100, 20)
            lab.until(lambda: "running" in whats(before), "the next one moves it")
        assert "accepted" in ok(call(runs, "goal", "0.1", "0.1", "0.1"))

        before = len(events())
        logger = start(shutil.which("lcm-logger"), "-q", "-f", tmp_path / "late.lcm")
        publisher = start(python, "-c", PUBLISHER, lab.bus_of(folder))
        assert publisher.wait(timeout=lab.DEADLINE) == 0

        def heard():
            if not (tmp_path / "late.lcm").exists():
                return False
            channels = [channel for channel, _ in lab.events(tmp_path / "late.lcm")]
            return {"ROBOT_STATE", "REFERENCE", "COMMAND", "PROCESS", "CAMERA"} <= set(channels)
        lab.until(heard, "a logger that comes late hears everybody")
        assert not {"holding", "stranger_ignored"} & set(whats(before)), whats(before)
        ok(call(runs, "down"))
        assert call(runs, "wait", "--exit").returncode == 0
        kinds = {channel for channel, _ in lab.events(folder / "log.lcm")}
        assert "COMMAND" in kinds and not kinds & {"CAMERA", "MY_ROBOT_STATE"}
    finally:
        for program in programs:
            program.kill()
            program.wait()
        call(runs, "down")

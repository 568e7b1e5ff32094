"""When something is wrong, the run ends with one clear line and the exit code of the contract, and leaves nothing."""
import os
import pathlib
import signal
import subprocess

import pytest

import labrun as lab

INTRUDER = str(lab.BUILD / "bin" / "test-controller")


def ends(done, code, *words):
    assert done.returncode == code, done.stderr
    for word in words:
        assert word in done.stderr, done.stderr


def namespaces():
    """Of all running processes. (lsns counts zombies too, and in a container they may never be reaped.)"""
    found = set()
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if (entry / "stat").read_text().rpartition(")")[2].split()[0] != "Z":
                found |= {os.readlink(entry / "ns" / kind).strip("netpid:[]") for kind in ("net", "pid")}
        except OSError:
            pass  # gone meanwhile, or another user's
    return found


def test_a_process_that_never_comes(tmp_path):
    file = lab.experiment(tmp_path)
    done = lab.run(file, tmp_path / "run", "--set", "processes.controller=sleep 1000", "--set", "ready=1")
    ends(done, 4, "not ready in 1 s: controller (never heard)")


def test_a_process_that_does_not_exist(tmp_path):
    done = lab.run(lab.experiment(tmp_path), tmp_path / "run", "--set", "processes.planner=no-such-planner")
    ends(done, 5, "planner", "no-such-planner")


@pytest.mark.parametrize("mode, code, words", [
    ("nan", 6, ["controller's message for step 5 was refused", "COMMAND", "tau[1]", "nan"]),
    ("short", 7, ["controller's message for step 5 was refused", "COMMAND", "nv"]),
    ("other_model", 4, ["controller has another model", "00000000deadbeef"]),
    ("silent", 7, ["controller gave no COMMAND for step 5"]),
])
def test_a_wrong_controller(tmp_path, mode, code, words):
    done = lab.run(lab.experiment(tmp_path), tmp_path / "run", "--set", f"processes.controller={INTRUDER} {mode}",
                   "--set", "deadline=1")
    ends(done, code, *words)
    assert not lab.leftovers(tmp_path / "run")


def test_a_plain_lcm_controller_is_enough(tmp_path):
    """It knows ROBOT_STATE, COMMAND and PROCESS, and nothing of NEED; packets are lost all the same."""
    done = lab.run(lab.experiment(tmp_path), tmp_path / "run", "--set", f"processes.controller={INTRUDER} plain",
                   LAB_FAULT_DROP="5,3")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("victim, code", [("simulator", 5), ("planner", 5), ("controller", 5), ("logger", 5)])
def test_kill_of_a_required_process(tmp_path, victim, code):
    file = lab.experiment(tmp_path, dt=0.001, duration=600)
    with lab.Running(file, tmp_path / "run") as run:
        run.wait_for_step(50)
        os.kill(run.pid(victim), signal.SIGKILL)
        done = run.finish()
    ends(done, code, victim, "killed by signal 9")
    assert (run.folder / "manifest.json").exists()
    # what was written is whole steps, and readable
    log = run.folder / ("log.lcm.part" if victim == "logger" else "log.lcm")
    steps = [lab.header(data)[2] for channel, data in lab.events(log) if channel == "ROBOT_STATE"]
    assert steps == list(range(len(steps))) and len(steps) > 50
    assert not lab.leftovers(run.folder)


def test_kill_of_the_renderer_does_not_end_the_run(tmp_path):
    file = lab.experiment(tmp_path, dt=0.001, duration=20)
    with lab.Running(file, tmp_path / "run", "--set", "renderer.enabled=true") as run:
        run.wait_for_step(50)
        os.kill(run.pid("renderer"), signal.SIGKILL)
        done = run.finish()
    ends(done, 0, "renderer", "killed by signal 9")


def test_a_frozen_process_ends_the_run_at_the_deadline(tmp_path):
    file = lab.experiment(tmp_path, dt=0.001, duration=600)
    with lab.Running(file, tmp_path / "run", "--set", "deadline=1") as run:
        run.wait_for_step(50)
        os.kill(run.pid("planner"), signal.SIGSTOP)
        done = run.finish()
    ends(done, 7, "planner gave no REFERENCE for step")
    assert not lab.leftovers(run.folder)


def test_interrupt_is_graceful(tmp_path):
    file = lab.experiment(tmp_path, dt=0.001, duration=600)
    with lab.Running(file, tmp_path / "run") as run:
        run.wait_for_step(50)
        run.process.send_signal(signal.SIGINT)
        done = run.finish()
    assert done.returncode == 130, done.stderr
    channels = [channel for channel, _ in lab.events(run.folder / "log.lcm")]
    assert channels[-1] == "END" and channels.count("ROBOT_STATE") == channels.count("COMMAND")


def test_kill_of_the_run_itself_leaves_nothing(tmp_path):
    file = lab.experiment(tmp_path, dt=0.001, duration=600)
    with lab.Running(file, tmp_path / "run") as run:
        run.wait_for_step(50)
        simulator = run.pid("simulator")
        private = {os.readlink(f"/proc/{simulator}/ns/{kind}").strip("netpid:[]") for kind in ("net", "pid")}
        private -= {os.readlink(f"/proc/self/ns/{kind}").strip("netpid:[]") for kind in ("net", "pid")}
        run.process.kill()
        run.process.wait()
        lab.until(lambda: not lab.leftovers(run.folder), "processes outlive lab run")
        lab.until(lambda: not private & namespaces(), "namespaces outlive lab run")
    assert not (run.folder / "log.lcm").exists() and (run.folder / "log.lcm.part").exists()


def test_a_full_disk(tmp_path):
    """The logger's words and the exit code tell; no half-written file has a final name."""
    file = lab.experiment(tmp_path, dt=0.001, duration=600)
    disk = tmp_path / "disk"
    disk.mkdir()
    script = 'mount -t tmpfs -o size=1m lab "$0" || exit 77; "$@"; code=$?; ls "$0"/run; exit $code'
    done = lab.run(file, disk / "run", before=["unshare", "-m", "sh", "-c", script, str(disk)])
    if done.returncode == 77 or "unshare" in done.stderr:
        pytest.skip("may not mount here")
    ends(done, 5, "logger", "No space left on device")
    names = done.stdout.split()
    assert "log.lcm.part" in names and "log.lcm" not in names and "metrics.json" not in names


@pytest.mark.parametrize("change, code, words", [
    (["--set", "robot.model=no/such.urdf"], 3, ["robot.model", "no/such.urdf"]),
    (["--set", "controller.kq=3"], 3, ["kq", "did you mean"]),
    (["--set", "controller.kp=nan"], 3, ["controller.kp", "nan"]),
    (["--set", "simulator.dt=0"], 3, ["simulator.dt", "0"]),
])
def test_bad_experiments(tmp_path, change, code, words):
    done = lab.run(lab.experiment(tmp_path), tmp_path / "run", *change)
    ends(done, code, *words)
    assert len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert not (tmp_path / "run").exists()


def test_an_unwritable_folder(tmp_path):
    done = lab.run(lab.experiment(tmp_path), "/proc/nowhere/run")
    ends(done, 2, "/proc/nowhere/run")


def test_an_experiment_that_is_not_there(tmp_path):
    done = lab.run(str(tmp_path / "none.yaml"), tmp_path / "run")
    ends(done, 3, "none.yaml")


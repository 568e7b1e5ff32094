"""The Slurm engine of lab sweep, on a real Slurm of one node: munged, slurmctld and slurmd of Debian, made for this test.

Runs in a private network namespace (tests/support/netns.sh). Skipped where Slurm is not installed (scripts/lab setup --full
does that) or without root, which slurmd needs.
"""
import os
import shutil
import signal
import subprocess

import pytest

import labrun as lab
import test_sweep

NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel")
PATH = os.environ["PATH"] + ":/usr/sbin:/sbin"
pytestmark = [
    pytest.mark.slurm,
    pytest.mark.skipif(any(shutil.which(name, path=PATH) is None for name in NEEDED), reason="Slurm is not installed"),
    pytest.mark.skipif(os.geteuid() != 0, reason="slurmd needs root"),
    pytest.mark.skipif("LAB_PRIVATE_NETNS" not in os.environ, reason="wants a network of its own"),
]

CONFIG = """
ClusterName=lab
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={dir}/munge/socket
StateSaveLocation={dir}/state
SlurmdSpoolDir={dir}/spool
SlurmctldPidFile={dir}/slurmctld.pid
SlurmdPidFile={dir}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=lab Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


@pytest.fixture(scope="module")
def slurm(tmp_path_factory):
    folder = tmp_path_factory.mktemp("slurm")
    for name in ("munge", "state", "spool"):
        (folder / name).mkdir()
    key = folder / "munge" / "key"
    key.write_bytes(os.urandom(128))
    key.chmod(0o400)
    for parent in [folder, *folder.parents]:  # munge wants its socket to be reachable, and safe
        if parent.parts[1:2] == ("tmp",) and str(parent) != "/tmp":
            parent.chmod(0o755)
    config = folder / "slurm.conf"
    config.write_text(CONFIG.format(dir=folder, host=os.uname().nodename))
    # getaddrinfo, as slurmd asks it, finds nothing on a host whose only address is 127.0.0.1
    subprocess.run(["ip", "address", "add", "10.77.0.1/32", "dev", "lo"], check=True)
    environment = lab.environment(SLURM_CONF=str(config), PATH=PATH)
    daemons = []

    def daemon(*words):
        log = open(folder / f"{words[0]}.log", "w")
        daemons.append(subprocess.Popen(words, env=environment, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL))

    def ready():
        for process in daemons:
            assert process.poll() is None, (folder / f"{process.args[0]}.log").read_text()
        done = subprocess.run(["sinfo", "--noheader", "--format=%T"], env=environment, capture_output=True, text=True)
        return done.stdout.strip() == "idle"

    try:
        at = folder / "munge"
        daemon("munged", "--foreground", f"--socket={at}/socket", f"--key-file={key}", f"--pid-file={at}/pid", f"--log-file={at}/log", f"--seed-file={at}/seed")
        lab.until((at / "socket").exists, "munge's socket")
        daemon("slurmctld", "-D", "-c")
        daemon("slurmd", "-D")
        lab.until(ready, "an idle node")
        yield environment
    finally:
        for process in reversed(daemons):
            process.terminate()
        for process in daemons:
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def test_the_same_files(slurm, tmp_path, monkeypatch):
    for name in ("SLURM_CONF", "PATH"):
        monkeypatch.setenv(name, slurm[name])
    path = test_sweep.sweep_file(tmp_path, """
grid: {controller.kp: [10, 20, 50, 100], simulator.damping: [0, 0.1, 1e6]}
draws: {count: 3, seed: 1, keys: {controller.kd: {normal: [8, 8]}}}
""")
    here, there = tmp_path / "here", tmp_path / "it's there"
    local = test_sweep.sweep(path, here)
    done = test_sweep.sweep(path, there, "--engine", "slurm", "-j", "3")
    assert done.returncode == local.returncode, done.stderr
    assert "of 3 tasks" in done.stderr
    for name in ("sweep.csv", "sweep.html"):
        assert (there / name).read_bytes() == (here / name).read_bytes()
    assert len(list((there / "results").glob("*.jsonl"))) == 3, "the tasks did not share the work"
    assert [task.read_text() for task in sorted((there / "slurm").glob("*.out"))] == ["", "", ""]
    # nothing is missing: no job is submitted
    again = test_sweep.sweep(path, there, "--engine", "slurm")
    assert "Slurm job" not in again.stderr and again.returncode == local.returncode


def test_ctrl_c_cancels_the_job(slurm, tmp_path, monkeypatch):
    for name in ("SLURM_CONF", "PATH"):
        monkeypatch.setenv(name, slurm[name])
    path = test_sweep.sweep_file(tmp_path, "grid: {controller.kp: {from: 10, to: 100, count: 40}}\n", dt=0.001, duration=300)
    out = tmp_path / "out"
    process = test_sweep.start(path, out, "--engine", "slurm", "-j", "2")
    lab.until(lambda: test_sweep.lines(out), "a result")
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=lab.DEADLINE)
    assert process.returncode == 130, stderr
    lab.until(lambda: subprocess.run(["squeue", "--noheader"], env=slurm, capture_output=True, text=True).stdout == "", "an empty queue")
    assert 0 < len(test_sweep.lines(out)) < 40

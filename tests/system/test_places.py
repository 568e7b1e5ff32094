"""Where the lab runs: locales with decimal commas, without HOME, TERM and /proc, where runs cannot be written."""
import json
import os
import subprocess

import pytest

import labrun as lab
from locales import LOCALES, locale

EXPERIMENT = str(lab.ROOT / "experiments" / "cubic_pd.yaml")


def bare(*words, **env):
    """A command in an environment that has nothing but PATH and what is given."""
    return subprocess.run(list(map(str, words)), env={"PATH": os.environ["PATH"], "LAB_BUILD": str(lab.BUILD), **env}, capture_output=True,
                          text=True, timeout=lab.DEADLINE, stdin=subprocess.DEVNULL)


@pytest.mark.parametrize("name", LOCALES[1:])
def test_numbers_have_points_whatever_the_locale(name, tmp_path):
    env = locale(tmp_path, name)
    assert "," in subprocess.run(["bash", "-c", "printf %.1f 1 2>/dev/null"], env={**os.environ, **env}, capture_output=True, text=True).stdout
    (tmp_path / "Procfile").write_text("a: exec sleep 0.3\n")
    done = bare(lab.ROOT / "scripts" / "supervise", "--dir", tmp_path / "group", "--timeout", "30.5", tmp_path / "Procfile", **env)
    assert (done.returncode, done.stdout, done.stderr) == (0, "a 0\n", "")
    done = bare(lab.LAB, "run", EXPERIMENT, "--solo", "--timeout", "60.5", "-o", tmp_path / "run", "--set", "simulator.duration=0.5", "--set",
                "expect={}", **env)
    assert done.returncode == 0, done.stderr
    manifest = json.loads((tmp_path / "run" / "manifest.json").read_text())
    assert 0 < manifest["wall_seconds"] < lab.DEADLINE


def test_without_home_and_term(tmp_path):
    done = bare(lab.LAB, "run", EXPERIMENT, "-o", tmp_path / "run", "--set", "simulator.duration=0.2", "--set", "expect={}")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "run" / "contact.png").exists()
    assert "cache" not in (tmp_path / "run" / "processes" / "renderer.log").read_text() + done.stderr
    for words in (("ls",), ("help",), ("ps",)):
        assert bare(lab.LAB, *words, LAB_RUNS=str(tmp_path)).returncode == 0


def test_where_runs_cannot_be_written_the_way_out_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    done = bare(lab.LAB, "run", EXPERIMENT, LAB_RUNS=str(tmp_path / "file" / "runs"))
    assert done.returncode == 2 and "LAB_RUNS=DIR" in done.stderr and len(done.stderr.splitlines()) == 1
    assert "LAB_RUNS" in bare(lab.LAB, "help").stdout


def test_without_proc(tmp_path):
    script = f"mount -t tmpfs none /proc && exec {lab.LAB} ls"
    done = bare("unshare", "--user", "--map-root-user", "--mount", "bash", "-c", script, LAB_RUNS=str(tmp_path))
    if "unshare" in done.stderr or "mount:" in done.stderr.splitlines()[0]:
        pytest.skip("no mount namespace here")
    assert (done.returncode, done.stderr) == (2, "lab: /proc is not mounted: the lab's scripts need it (mount -t proc proc /proc)\n")


def test_a_clock_that_is_set_ends_no_wait():
    """Spans of time are those since boot (tests/structure/output.py refuses the wall clock): they do not depend on `date`."""
    script = f'. {lab.ROOT}/scripts/lib.sh; expires_in 0.2; EPOCHREALTIME=0 SECONDS=9999; expired && exit 1; pause 0.3; expired'
    assert bare("bash", "-c", script, "lab-x").returncode == 0

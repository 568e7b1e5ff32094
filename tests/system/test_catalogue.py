"""The catalogue as a person uses it: experiments by whole process groups, sweeps, the page that compares five controllers,
and wrong files. (Every experiment in one process, and the figures in docs/experiments.md: experiments_test.)
"""
import json
import re
import subprocess

import pytest

import labrun as lab
from test_report import checked


def call(*words, **extra):
    return subprocess.run([lab.LAB, *map(str, words)], env=lab.environment(**extra), capture_output=True, text=True, timeout=lab.DEADLINE)


@pytest.mark.parametrize("name", ["reach_ct", "stop_move_stop", "com_control", "joint_limits", "noise_and_delay", "missing_tool",
                                  *[pytest.param(name, marks=pytest.mark.robots) for name in ("solo12_air", "tiago_arm")]])
def test_processes_meet_what_is_expected(name, tmp_path):
    if name in ("solo12_air", "tiago_arm") and not lab.robots_are_here():
        pytest.skip("scripts/lab robots has not been here")
    done = lab.run(name, tmp_path / "run", "--set", "renderer.fps=1", "--set", "renderer.size=[160, 120]", "--set", "planner.lead=16")
    assert done.returncode == 0, done.stderr
    expected = json.loads((tmp_path / "run" / "metrics.json").read_text())["verdicts"]
    said = re.findall(r"^(ok|FAILED) +(\S+) ", done.stdout, re.M)
    assert expected and said == [("ok", one["metric"]) for one in expected]
    assert list((tmp_path / "run" / "frames").glob("*.png")) and (tmp_path / "run" / "report.html").exists()


def test_one_page_says_what_a_model_is_worth(tmp_path):
    names = ["reach_ct", "reach_pd", "reach_pd_gravity", "reach_wrong_gravity", "reach_wrong_masses"]
    for name in names:
        done = call("run", name, "--solo", "--no-report", "-o", tmp_path / name)
        assert done.returncode == 0, done.stderr
    done = call("compare", *[tmp_path / name for name in names], "-o", tmp_path / "page.html", "--json")
    assert done.returncode == 0, done.stderr
    rows = {row["metric"]: row for row in json.loads(done.stdout)["metrics"]}
    error, rest = (dict(zip(names, rows[metric]["values"])) for metric in ("max_error", "steady_error_max"))
    assert error["reach_pd"] / error["reach_ct"] == pytest.approx(1775, rel=0.05)
    assert error["reach_wrong_masses"] / error["reach_ct"] == pytest.approx(320, rel=0.05)
    assert rest["reach_pd_gravity"] < 1e-6 * rest["reach_pd"]
    assert 1 - rest["reach_wrong_gravity"] / rest["reach_pd"] == pytest.approx(0.59, abs=0.01)
    text = checked(tmp_path / "page.html").text
    assert all(name in text for name in names)
    for words in ("1770 times worse", "116 times worse", "320 times worse"):  # against the first; three digits
        assert words in text


@pytest.mark.parametrize("name", sorted(path.stem for path in (lab.ROOT / "experiments" / "sweeps").glob("*.yaml")))
def test_every_sweep_runs(name, tmp_path):
    done = call("sweep", name, "-o", tmp_path, "-j", "2")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "sweep.html").exists()


GOOD = """robot:
  model: builtin:manipulator
simulator:
  dt: 0.01
  duration: 3
planner:
  kind: cubic
  goal: [0.5, 0.3, -0.4, 0.2, 0.5, -0.3]
controller:
  kind: pd
  kp: 50
  kd: 10
expect:
  max_error: {max: 1}
"""


@pytest.mark.parametrize("change, words", [
    (("kp: 50", "kq: 50"), ":11: unknown key 'controller.kq'; did you mean 'controller.kp'?"),
    (("controller:", "controler:"), ":9: unknown section 'controler'; did you mean 'controller'?"),
    (("kp: 50", "kp: fifty"), ":11: controller.kp: must be a number, a list of numbers or a map joint: number, not 'fifty'"),
    (("kp: 50", "kp: .nan"), ":11: controller.kp: must be finite, not '.nan'"),
    (("kp: 50", "kp: [50, 50, 50, .nan, 50, 50]"), ":11: controller.kp[3]: must be finite, not '.nan'"),
    (("kp: 50", "kp: {joint2_sholder: 5}"), ":11: controller.kp.joint2_sholder: 'manipulator' has no such joint; did you mean 'joint2_shoulder'?"),
    (("dt: 0.01", "dt: -0.01"), ":4: simulator.dt: -0.01 is too small; give at least 1e-06 (s)"),
    (("dt: 0.01", "\tdt: 0.01"), ":4: not YAML: begins with a tab; indent with spaces"),
    (("[0.5,", "[9,"), ":8: planner.goal: joint 'joint1_base_yaw' cannot be at 9; its limits are -3.141592653589793 .. 3.141592653589793"),
    (("  goal: [0.5, 0.3, -0.4, 0.2, 0.5, -0.3]\n", ""), ":7: planner.goal: is missing; a cubic needs one"),
    (("kind: cubic", "kind: cubik"), ":7: planner.kind: 'cubik' is not known; use one of hold, cubic, "),
    (("builtin:manipulator", "models/simple_3dof_amr.urdf"), ":2: robot.model: 'models/simple_3dof_amr.urdf' cannot be found; did you mean 'models/simple_3dof_arm.urdf'? "),
    (("max_error", "max_eror"), ":14: expect.max_eror: there is no metric 'max_eror'; did you mean 'max_error'?"),
])
def test_wrong_files_are_one_line(change, words, tmp_path):
    (tmp_path / "models").symlink_to(lab.ROOT / "models")
    path = tmp_path / "mine.yaml"
    assert change[0] in GOOD
    path.write_text(GOOD.replace(*change, 1))
    done = lab.run(path, tmp_path / "run")
    assert done.returncode == 3 and done.stdout == "", done
    assert done.stderr.startswith(f"lab run: {path}{words}") and done.stderr.count("\n") == 1, done.stderr
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("name, words", [("sinusoid_tc", "there is no experiment 'sinusoid_tc'; near names: sinusoid_ct "), ("nowhere/x.yaml", "there is no experiment 'nowhere/x.yaml' (")])
def test_missing_files_are_one_line(name, words, tmp_path):
    done = lab.run(name, tmp_path / "run")
    assert done.returncode == 3 and done.stdout == "" and done.stderr.startswith(f"lab run: {words}") and done.stderr.count("\n") == 1, done

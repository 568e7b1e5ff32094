"""lab sweep as a person uses it: against single runs, killed and resumed, stopped, and when something is wrong."""
import csv
import html.parser
import json
import os
import signal
import subprocess

import pytest

import labrun as lab

ARM = """
robot: {{model: "{root}/models/simple_3dof_arm.urdf", armature: 0.2}}
simulator: {{dt: {dt}, duration: {duration}}}
planner: {{kind: sinusoid, amplitude: 0.4}}
controller: {{kind: pd_gravity, kp: 50, kd: 10}}
expect: {{max_error: {{max: 0.2}}}}
"""


def sweep_file(folder, text, dt=0.005, duration=1.0):
    (folder / "arm.yaml").write_text(ARM.format(root=lab.ROOT, dt=dt, duration=duration))
    path = folder / "s.yaml"
    path.write_text("experiment: arm.yaml\n" + text)
    return path


def start(path, out, *options, **how):
    return subprocess.Popen([lab.LAB, "sweep", str(path), "-o", str(out), *options], env=lab.environment(), stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **how)


def sweep(path, out, *options):
    process = start(path, out, *options)
    stdout, stderr = process.communicate(timeout=lab.DEADLINE)
    return subprocess.CompletedProcess(process.args, process.returncode, stdout, stderr)


def lines(out):
    return [line for file in sorted(out.glob("results/*.jsonl")) for line in file.read_text().splitlines()]


def test_rows_are_the_metrics_of_single_runs(tmp_path):
    path = sweep_file(tmp_path, """
grid: {controller.kp: [20, 200], planner.phase: [0, {joint3_elbow: 1}]}
draws: {count: 2, seed: 4, keys: {controller.model.mass_scale: {uniform: [0.5, 1.5]}}}
""")
    out = tmp_path / "out"
    done = sweep(path, out)
    assert done.returncode == 0, done.stderr
    rows = list(csv.DictReader((out / "sweep.csv").open()))
    assert len(rows) == 8
    for row in rows[::3]:
        sets = [word for key in ("controller.kp", "planner.phase", "controller.model.mass_scale") for word in ("--set", f"{key}={row[key]}")]
        run = tmp_path / row["run"]
        code = lab.run(str(tmp_path / "arm.yaml"), run, "--solo", *sets).returncode
        metrics = json.loads((run / "metrics.json").read_text())
        assert code == (0 if row["passed"] == "true" else 1)
        names = [name for name in row if name in metrics and name not in ("run", "complete", "passed", "last_step", "reason")]
        assert len(names) >= 15
        for name in names:
            assert metrics[name] == (float(row[name]) if row[name] else None), name
    assert {row["passed"] for row in rows} == {"true", "false"}, "the two verdicts are not both tried"


def test_killed_and_started_again(tmp_path):
    path = sweep_file(tmp_path, "grid: {controller.kp: {from: 10, to: 100, count: 20}, controller.kd: {from: 5, to: 50, count: 10}}\n", dt=0.001, duration=10)
    whole, out = tmp_path / "whole", tmp_path / "out"
    first = start(path, out, "-j", "1")
    lab.until(lambda: len(lines(out)) >= 20, "20 results")
    first.send_signal(signal.SIGKILL)
    first.communicate()
    before = lines(out)
    assert 20 <= len(before) < 200, "it was over before it was killed"
    assert not (out / "sweep.csv").exists()
    assert sweep(path, out, "-j", "2").returncode == 0
    assert len(lines(out)) == 200 and lines(out)[:len(before)] == before, "a finished run ran again"
    assert sweep(path, whole, "-j", "1").returncode == 0
    for name in ("sweep.csv", "sweep.html"):
        assert (out / name).read_bytes() == (whole / name).read_bytes()
    # nothing to do: quick, and the same
    assert sweep(path, out).returncode == 0 and len(lines(out)) == 200
    assert (out / "sweep.csv").read_bytes() == (whole / "sweep.csv").read_bytes()


def test_ctrl_c_keeps_what_is_done(tmp_path):
    path = sweep_file(tmp_path, "grid: {controller.kp: {from: 10, to: 100, count: 100}}\n", dt=0.001, duration=100)
    out = tmp_path / "out"
    process = start(path, out)
    lab.until(lambda: lines(out), "a result")
    other = sweep(path, out)
    assert other.returncode == 2 and "another sweep is running" in other.stderr
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=lab.DEADLINE)
    assert process.returncode == 130, stderr
    kept = lines(out)
    assert stderr.splitlines()[-1] == f"lab sweep: stopped with {len(kept)} of 100 runs done; the same command continues from there"


def test_bad_files_and_bad_runs(tmp_path):
    out = tmp_path / "out"
    done = sweep(sweep_file(tmp_path, "grid:\n  controler.kp: [1]\n"), out)
    assert done.returncode == 3 and done.stdout == ""
    assert done.stderr == f"lab sweep: {tmp_path}/s.yaml:3: unknown section 'controler'; did you mean 'controller'?\n"
    assert not out.exists()
    done = sweep(tmp_path / "gone.yaml", out)
    assert done.returncode == 3 and done.stderr.count("\n") == 1
    assert sweep(sweep_file(tmp_path, ""), out, "--engine", "cloud").returncode == 2

    # diverged runs are results, values that cannot run are not
    diverge = "grid: {simulator.damping: [0, 1e6]}\n"
    done = sweep(sweep_file(tmp_path, diverge), out)
    assert done.returncode == 0 and "1 of 2 runs ended early" in done.stderr and "diverged" in done.stderr
    rows = list(csv.DictReader((out / "sweep.csv").open()))
    assert rows[0]["reason"] == "" and rows[0]["max_error"] and "diverged" in rows[1]["reason"] and rows[1]["max_error"] == ""
    done = sweep(sweep_file(tmp_path, diverge + "draws: {count: 5, seed: 1, keys: {controller.kd: {normal: [1, 5]}}}\n"), out)
    rows = list(csv.DictReader((out / "sweep.csv").open()))
    assert done.returncode == 1 and any("controller.kd" in row["reason"] and "too small" in row["reason"] for row in rows)
    assert len(rows) == 10

    run = tmp_path / "run"
    run.mkdir()
    (run / "experiment.yaml").write_text("")
    assert sweep(sweep_file(tmp_path, diverge), run).returncode == 2

    mine = tmp_path / "mine"  # a person's own table, and a folder that is only called results
    (mine / "results").mkdir(parents=True)
    (mine / "results" / "0000.jsonl").write_text('{"age": 3}\n')
    (mine / "sweep.csv").write_text("height\n")
    done = sweep(sweep_file(tmp_path, diverge), mine)
    assert done.returncode == 2 and "not empty and not the folder of a sweep" in done.stderr
    assert (mine / "sweep.csv").read_text() == "height\n" and sorted(p.name for p in mine.iterdir()) == ["results", "sweep.csv"]


def test_slurm_that_refuses_is_said(tmp_path, monkeypatch):
    sbatch = tmp_path / "bin" / "sbatch"
    sbatch.parent.mkdir()
    sbatch.write_text("#!/bin/sh\necho sbatch: error: invalid partition specified\nexit 1\n")
    sbatch.chmod(0o755)
    monkeypatch.setenv("PATH", f"{sbatch.parent}:{os.environ['PATH']}")
    done = sweep(sweep_file(tmp_path, "grid: {controller.kp: [10]}\n"), tmp_path / "out", "--engine", "slurm")
    assert done.returncode == 1 and done.stderr == "lab sweep: sbatch failed: sbatch: error: invalid partition specified\n"


def test_what_it_prints(tmp_path):
    path = sweep_file(tmp_path, "grid: {controller.kp: [20, 50]}\nmetrics: [rms_error]\n")
    done = sweep(path, tmp_path / "out", "--dry-run")
    assert done.returncode == 0 and done.stdout == "run,controller.kp\n0,20\n1,50\n" and not (tmp_path / "out").exists()
    assert json.loads(sweep(path, tmp_path / "out", "--dry-run", "--json").stdout)[1] == {"run": 1, "set": {"controller.kp": "50"}}
    done = sweep(path, tmp_path / "out", "--json")
    all = json.loads(done.stdout)
    assert all["complete"] == 2 and all["metrics"]["rms_error"]["smallest"]["run"] == 1 and done.stderr == ""


class Page(html.parser.HTMLParser):
    """Tags that close in order, and nothing from elsewhere."""
    VOID = {"meta", "link", "br"}

    def __init__(self):
        super().__init__()
        self.stack, self.seen = [], {}

    def handle_starttag(self, tag, attributes):
        self.seen[tag] = self.seen.get(tag, 0) + 1
        for name, value in attributes:
            assert name not in ("src", "href") and "url(" not in (value or ""), (tag, name)
        if tag not in self.VOID:
            self.stack.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        self.stack.pop()

    def handle_endtag(self, tag):
        assert self.stack.pop() == tag


@pytest.mark.parametrize("name", sorted(p.stem for p in (lab.ROOT / "experiments" / "sweeps").glob("*.yaml")))
def test_every_sweep_that_comes_with_the_lab(name, tmp_path):
    done = sweep(name, tmp_path / "out")
    assert done.returncode == 0, done.stderr
    table = list(csv.DictReader((tmp_path / "out" / "sweep.csv").open()))
    assert all(row["complete"] == "true" for row in table)
    page = Page()
    page.feed((tmp_path / "out" / "sweep.html").read_text())
    text = (lab.ROOT / "experiments" / "sweeps" / f"{name}.yaml").read_text()
    metrics = text.split("metrics: [")[1].split("]")[0].split(", ")
    assert page.seen["svg"] == len(metrics) * (1 + ("draws:" in text))  # over the grid, and over what is drawn
    assert page.stack == [] and page.seen["title"] > len(table)


def test_dt_teaches_what_it_says(tmp_path):
    """Ten times the error where dt kd is far beyond twice the inertia, and energy from nowhere."""
    assert sweep("dt", tmp_path / "out").returncode == 0
    rows = {float(row["simulator.dt"]): row for row in csv.DictReader((tmp_path / "out" / "sweep.csv").open())}
    assert float(rows[0.1]["final_error"]) > 10 * float(rows[0.01]["final_error"])
    assert float(rows[0.01]["energy_drift_relative"]) < 0.2 and float(rows[0.05]["energy_drift_relative"]) > 10

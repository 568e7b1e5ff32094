"""Groups from Procfiles and experiments: what replaces what, how long they live, and what is said of them afterwards."""
import json
import shlex

import pytest

from labrun import BUILD, ROOT, call, ok, state, until

PATIENT = ["--set", "safety.timeout=0.5"]
CONTROLLER = f"exec {shlex.quote(str(BUILD / 'bin' / 'lab-controller'))} --run-dir $LAB_RUN_DIR"


def write(folder, *lines, name="my.procfile"):
    path = folder / name
    path.write_text("".join(line + "\n" for line in lines))
    return str(path)


def test_one_line_replaces_a_process_and_keeps_the_others(runs, tmp_path):
    file = write(tmp_path, "# mine", f"controller: : \"mine\\\\ is: 'this' # one\"; {CONTROLLER}",
                 "camera: echo frame >$LAB_RUN_DIR/seen; exec sleep 60", "#lab: controller max=3")
    started = call(runs, "up", "-d", "-f", file, *PATIENT)
    ok(started)
    assert "ends     with scripts/lab down" in started.stderr
    ok(call(runs, "wait", "--ready"))
    folder = runs / "my"
    assert sorted(state(folder)) == ["camera", "controller", "logger", "planner", "simulator"]
    until(lambda: (folder / "seen").exists(), "the added process, with LAB_RUN_DIR")
    lines = (folder / "processes" / "Procfile").read_text().splitlines()
    [mine] = [line for line in lines if line.startswith("controller:")]
    assert "\"mine\\\\ is: 'this' # one\"" in mine, "the line as it was written"
    assert lines[-1] == "#lab: controller max=3"
    ok(call(runs, "goal", "joint2_shoulder=0.3", "--duration", "0.5", "--wait"))
    done = call(runs, "report", "my")
    assert (done.returncode, done.stderr) == (0, "")
    page = (folder / "report.html").read_text()
    assert "The run goes on: this page covers its first" in page and "goes on" in page and "10000000000" not in page
    ok(call(runs, "down"))
    [row] = json.loads(ok(call(runs, "ls", "--json")))
    assert (row["name"], row["experiment"], row["verdict"]) == ("my", "live", "ok")
    ok(call(runs, "report", "my"))
    page = (folder / "report.html").read_text()
    assert "The run goes on" not in page and "ended at step" not in page and "10000000000" not in page
    ok(call(runs, "clean", "--yes", "my"))
    assert [p.name for p in folder.iterdir()] == ["seen"], "only what the run itself wrote is removed"


def test_a_whole_group_stands_alone(runs, tmp_path):
    file = write(tmp_path, "one: exec sleep 60", "two: exec sleep 60")
    ok(call(runs, "up", "-d", file))
    until(lambda: state(runs / "my") and sorted(state(runs / "my")) == ["one", "two"], "both processes")
    [row] = json.loads(ok(call(runs, "ls", "--json")))
    assert (row["name"], row["verdict"]) == ("my", "alive")
    ok(call(runs, "down"))
    [row] = json.loads(ok(call(runs, "ls", "--json")))
    assert row["verdict"] == "no log"
    page = ok(call(runs, "report", "my"))
    assert page.strip().endswith("report.html")
    ok(call(runs, "clean", "--yes", "my"))
    assert not (runs / "my").exists()


def test_an_experiment_says_how_long_it_lives_and_stays_if_asked(runs):
    file = str(ROOT / "experiments" / "cubic_pd.yaml")
    ended = call(runs, "up", file, "--set", "renderer.enabled=false", *PATIENT)
    ok(ended)
    assert "after 3 s of simulated time, as fast as it is computed; --stay" in ended.stderr
    ended = call(runs, "up", file, "--set", "renderer.enabled=false", "--set", "simulator.clock=realtime", *PATIENT)
    ok(ended)
    assert "after 3 s (simulator.duration); --stay" in ended.stderr
    stays = call(runs, "up", "-d", file, "--stay", "--set", "renderer.enabled=false", *PATIENT)
    ok(stays)
    assert "ends     with scripts/lab down" in stays.stderr
    ok(call(runs, "wait", "--ready"))
    resolved = (runs / "cubic_pd-3" / "experiment.yaml").read_text()
    assert "  clock: realtime\n" in resolved and "  duration: 1e+07\n" in resolved
    assert "  duration: 3\n" in resolved, "the motion keeps its own"
    ok(call(runs, "goal", "joint2_shoulder=0.3", "--duration", "0.3"))
    ok(call(runs, "down"))
    ok(call(runs, "report", "cubic_pd-3"))


@pytest.mark.parametrize("lines, said", [
    (["controler: x", "planner: y"], "process 'controler' would run beside our own, did you mean: controller?"),
    (["controller: x", "a line of prose"], "my.procfile:2: cannot read the line 'a line of prose'"),
    (["controller: x", "controller: y"], "my.procfile:2: two processes are named 'controller'"),
    (["a: x", "#lab: a max=many"], "my.procfile:2: 'max=many' is not a count"),
    (["a: x", "#lab: b max=1"], "policy for 'b', which is not a process of it"),
    (["# nothing"], "no process in it"),
])
def test_a_procfile_that_cannot_be_right_is_refused(runs, tmp_path, lines, said):
    done = call(runs, "up", "-d", "-f", write(tmp_path, *lines))
    assert done.returncode == 2
    assert done.stderr.startswith("lab up: ") and said in done.stderr and len(done.stderr.splitlines()) == 1
    assert not runs.exists() or not list(runs.iterdir()), "no run is left"


def test_two_files_are_one_of_each(runs, tmp_path):
    mine = write(tmp_path, f"controller: {CONTROLLER}")
    motion = str(ROOT / "experiments" / "cubic_pd.yaml")
    done = call(runs, "up", motion, mine, "--set", "renderer.enabled=false", *PATIENT)
    ok(done)
    assert "from" not in done.stderr and (runs / "my" / "experiment.yaml").read_text().startswith("# As run; made from cubic_pd.yaml")
    assert call(runs, "up", motion, motion).returncode == 2
    assert call(runs, "up", mine, mine).returncode == 2
    whole = write(tmp_path, "a: exec sleep 1", name="whole")
    done = call(runs, "up", whole, "--stay")
    assert done.returncode == 2 and "--set and --stay are for experiments" in done.stderr

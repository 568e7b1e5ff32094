"""Labs that keep running: up, wait, ps, restart, down, and that nothing outlives them."""
import json
import os
import pathlib
import re
import signal
import subprocess

import pytest

import labrun as lab
from labrun import call, ok, state

# A loaded machine may be late by more than the usual watchdog allows; these tests are not about that.
PATIENT = ["--set", "safety.timeout=0.5"]
INTRUDER = str(lab.BUILD / "bin" / "test-controller")


def log_of(folder):
    return lab.until(lambda: (pathlib.Path(folder) / "log.lcm").exists() and (pathlib.Path(folder) / "log.lcm").read_bytes(), "log.lcm")


def test_a_day_in_the_lab(runs):
    ok(call(runs, "up", "-d", *PATIENT))
    ok(call(runs, "wait", "--ready"))
    environment = pathlib.Path(f"/proc/{state(runs / 'live')['logger'][1]}/environ").read_bytes().split(b"\0")
    assert b"LAB_QUOTA_MB=2000" in environment, "2 GB without --quota"
    [there] = json.loads(ok(call(runs, "ps", "--json")))
    assert {p["name"]: p["state"] for p in there["processes"]} == dict.fromkeys(["simulator", "planner", "controller", "logger"], "RUNNING")
    assert all(p["memory"] > 0 and os.path.exists(f"/proc/{p['pid']}") for p in there["processes"])
    assert "accepted" in ok(call(runs, "goal", "joint2_shoulder=0.4", "--duration", "0.5"))
    ok(call(runs, "set", "controller", "kp=80"))
    ok(call(runs, "push", "effector_body", "5", "0", "0"))
    assert json.loads(ok(call(runs, "spy", "echo", "ROBOT_STATE", "--once", "--json")))["message"]["nq"] == 6
    before = state(runs / "live")["controller"][1]
    ok(call(runs, "restart", "controller"))
    status, pid, restarts = state(runs / "live")["controller"]
    assert (status, restarts) == ("running", 1) and pid != before
    done = call(runs, "restart", "controler")
    assert done.returncode == 2 and "did you mean: controller?" in done.stderr
    ok(call(runs, "exec", "--", "true"))
    ok(call(runs, "down"))
    assert (runs / "live" / "log.lcm").exists() and not (runs / "live" / "processes" / "control").exists()
    assert call(runs, "wait", "--exit").returncode == 0
    assert call(runs, "down").returncode == 2


def test_with_a_quota_a_live_lab_keeps_the_newest_of_its_log(runs):
    ok(call(runs, "up", "-d", "--private", "--quota", "0.2", *PATIENT))
    folder = runs / "live"
    earlier = folder / "log.earlier.lcm"
    first = lab.until(lambda: earlier.exists() and earlier.read_bytes(), "the first piece")
    lab.until(lambda: earlier.read_bytes() != first, "the second piece")
    ok(call(runs, "down"))
    pieces = [list(lab.events(path)) for path in (earlier, folder / "log.lcm")]
    states = [[lab.header(data)[2] for channel, data in piece if channel == "ROBOT_STATE"] for piece in pieces]
    assert all(piece[0][0] == "RUN" and piece[1][0] == "TYPE" for piece in pieces)
    assert states[0] + states[1] == list(range(states[0][0], states[1][-1] + 1, 10)), "nothing is lost between them"
    assert states[0][0] > 0 and earlier.stat().st_size < 200e3
    ok(call(runs, "report", "live"))
    assert call(runs, "up", "--quota", "much").returncode == 2


def test_a_lab_elsewhere_is_found_and_an_ended_one_is_not_ready(runs, tmp_path):
    elsewhere = tmp_path / "elsewhere" / "arm"
    assert call(runs, "wait", "--ready").returncode == 2, "there is no lab"
    done = call(runs, "up", "-d", "--private", "-o", str(elsewhere), "nosuch")
    assert done.returncode == 2 and "no process 'nosuch'" in done.stderr
    assert not elsewhere.exists() and not list(runs.glob("*")), "a usage error leaves nothing"
    ok(call(runs, "up", "-d", "--private", "-o", str(elsewhere), *PATIENT))
    assert json.loads((elsewhere / "manifest.json").read_text())["state"] == "running"
    ok(call(runs, "wait", "--ready"))
    [there] = json.loads(ok(call(runs, "ps", "--json")))
    assert {p["state"] for p in there["processes"]} == {"RUNNING"}
    ok(call(runs, "goal", "0.1", "0", "0", "0", "0", "0"))
    ok(call(runs, "down"))
    ended = json.loads((elsewhere / "manifest.json").read_text())
    assert ended["state"] == "ended" and "log.lcm" in ended["files"]
    done = call(runs, "wait", "--ready", "--lab", str(elsewhere))
    assert done.returncode == 4 and "has ended already" in done.stderr
    assert call(runs, "wait", "--ready").returncode == 2


def test_killed_and_restarted_in_lockstep_the_log_is_the_same(runs, tmp_path):
    file = lab.experiment(tmp_path, dt=0.001, duration=8)
    undisturbed = lab.solo(file, tmp_path / "solo")
    ok(call(runs, "up", "-d", "--private", "-f", file, "--set", "planner.lead=4"))
    folder = runs / "motion"
    for victim in ("planner", "controller", "logger"):
        lab.until(lambda: state(folder)[victim][1] > 0, "a pid")
        os.kill(state(folder)[victim][1], signal.SIGKILL)
        lab.until(lambda: state(folder)[victim][2] == 1 and state(folder)[victim][0] == "running", f"{victim} again")
    assert call(runs, "wait", "--exit", "--lab", "motion").returncode == 0
    assert log_of(folder) == undisturbed


def test_four_labs_at_once_do_not_meet(runs, tmp_path):
    file = lab.experiment(tmp_path, dt=0.001, duration=3)
    kinds = {"a": "0.4", "b": "0.4", "c": "0.3", "d": "0.2"}
    for name, amplitude in kinds.items():
        ok(call(runs, "up", "-d", "-f", file, "-o", str(runs / name), "--set", f"planner.amplitude={amplitude}"))
    for name in kinds:
        assert call(runs, "wait", "--exit", "--lab", name).returncode == 0
    for name, amplitude in kinds.items():
        alone = lab.solo(file, tmp_path / f"solo-{name}", "--set", f"planner.amplitude={amplitude}")
        assert log_of(runs / name) == alone


def goals(folder, types):
    """The goals in a run's log, by their first value."""
    actions = [types.input_t.decode(d).action for c, d in lab.events(folder / "log.lcm") if c == "INPUT"]
    return [action.values[0] for action in actions if action.verb == "goal"]


@pytest.mark.parametrize("prefix", ["", "LEFT_"])
def test_two_labs_on_one_host_each_hear_their_own(runs, tmp_path, prefix):
    """As two checkouts or two users start them, or two robots on one bus: every request is in its own lab's log."""
    other = tmp_path / "other"
    try:
        ok(call(runs, "up", "-d", *PATIENT))
        ok(call(other, "up", "-d", *PATIENT, *(["--prefix", prefix] if prefix else [])))
        first, second = (lab.bus_of(folder / "live") for folder in (runs, other))
        assert (first == second) == bool(prefix), "a port of its own, or the same with a prefix"
        for folder in (runs, other):
            ok(call(folder, "wait", "--ready"))
        for i in range(1, 6):
            ok(call(runs, "goal", str(0.01 * i), "0", "0", "0", "0", "0"))
            ok(call(other, "goal", str(-0.01 * i), "0", "0", "0", "0", "0"))
        ok(call(other, "estop"))
        [mine] = json.loads(ok(call(runs, "ps", "--json")))
        assert {p["state"] for p in mine["processes"]} == {"RUNNING"}, "the other's estop"
        ok(call(other, "down"))
        [mine] = json.loads(ok(call(runs, "ps", "--json")))
        assert {p["state"] for p in mine["processes"]} == {"RUNNING"}, "the other's end"
        ok(call(runs, "down"))
    finally:
        call(other, "down", "--all", "--timeout", "5")
    types = lab.generated_types(tmp_path / "types")
    assert goals(runs / "live", types) == [0.01, 0.02, 0.03, 0.04, 0.05]
    assert goals(other / "live", types) == [-0.01, -0.02, -0.03, -0.04, -0.05]


def test_a_bus_that_is_named_is_taken_or_refused(runs, tmp_path):
    ok(call(runs, "up", "-d", *PATIENT))
    url = lab.bus_of(runs / "live")
    other = tmp_path / "other"
    done = subprocess.run([lab.LAB, "up", "-d"], env=lab.environment(LAB_RUNS=str(other), LCM_DEFAULT_URL=url), capture_output=True,
                          text=True, timeout=lab.DEADLINE, stdin=subprocess.DEVNULL)
    assert done.returncode == 2 and "has a lab already, of " in done.stderr, done.stderr
    assert not list(other.glob("*")), "nothing is left of it"


def test_one_that_is_frozen_before_ready_is_named(runs, tmp_path):
    file = lab.experiment(tmp_path)
    stopped = f"bash -c 'kill -STOP $$; exec {lab.BUILD}/bin/lab-controller'"
    ok(call(runs, "up", "-d", "-f", file, "--set", f"processes.controller={stopped}"))
    done = call(runs, "wait", "--ready", "--timeout", "1")
    assert done.returncode == 4 and "controller (never heard)" in done.stderr, done.stderr


def test_another_model_is_told_with_both_hashes(runs, tmp_path):
    file = lab.experiment(tmp_path)
    ok(call(runs, "up", "-d", "-f", file, "--set", f"processes.controller={INTRUDER} other_model"))
    done = lab.until(lambda: (lambda d: d if d.returncode else None)(call(runs, "wait", "--ready", "--lab", "motion")), "the refusal")
    assert done.returncode == 4 and "00000000deadbeef" in done.stderr and "simulator's is" in done.stderr, done.stderr


@pytest.mark.parametrize("victim", ["supervisor", "keeper"])
def test_kill_of_the_supervisor_leaves_nothing(runs, victim):
    ok(call(runs, "up", "-d", *PATIENT))
    ok(call(runs, "wait", "--ready"))
    [there] = json.loads(ok(call(runs, "ps", "--json")))
    if victim == "supervisor":
        os.kill(there["supervisor"], signal.SIGKILL)
    else:
        subprocess.run(["pkill", "-KILL", "-f", f"lab-up --keep {runs}"], check=True)
    lab.until(lambda: not lab.leftovers(runs), "all processes to end")


def test_a_simulator_that_comes_back_brings_a_new_run(runs, tmp_path):
    group = tmp_path / "group"
    ok(call(runs, "up", "-d", "--set", "logger.every=1", *PATIENT))
    ok(call(runs, "wait", "--ready"))
    text = (runs / "live" / "processes" / "Procfile").read_text().replace(str(runs / "live"), "$LAB_RUN_DIR")
    experiment = (runs / "live" / "experiment.yaml").read_text()
    ok(call(runs, "down"))
    (tmp_path / "experiment.yaml").write_text(experiment)
    group.write_text(text.replace("simulator required=yes restart=never", "simulator required=yes restart=always")
                     .replace("$LAB_RUN_DIR/experiment.yaml", str(tmp_path / "experiment.yaml")))
    ok(call(runs, "up", "-d", "-f", str(group)))
    ok(call(runs, "wait", "--ready"))
    folder = runs / "group"
    os.kill(state(folder)["simulator"][1], signal.SIGKILL)
    lab.until(lambda: state(folder)["simulator"][2] == 1, "another life")
    ok(call(runs, "wait", "--ready"))
    ok(call(runs, "down"))
    logs = [lab.header(next(iter(lab.events(p)))[1])[1] for p in (folder / "log.lcm", *folder.glob("log-1.lcm*"))]
    assert len(set(logs)) == 2, "two runs, two logs"


def test_a_reset_is_a_new_run_and_the_old_log_stays(runs, tmp_path):
    ok(call(runs, "up", "-d", "--set", "logger.every=1", *PATIENT))
    ok(call(runs, "wait", "--ready"))
    folder = runs / "live"
    before = state(folder)["simulator"]
    ok(call(runs, "goal", "joint2_shoulder=0.4", "--duration", "0.5"))
    ended = json.loads(ok(call(runs, "reset", "--json")))
    status, pid, restarts = state(folder)["simulator"]
    assert (status, restarts) == ("running", before[2] + 1) and pid != before[1]
    ok(call(runs, "goal", "joint2_shoulder=0.1", "--duration", "0.5"))
    assert "starts" in ok(call(runs, "reset"))
    ok(call(runs, "down"))
    types = lab.generated_types(tmp_path / "types")
    ids = []
    for n, name in enumerate(["log-1.lcm", "log-2.lcm", "log.lcm"]):
        kept = list(lab.events(folder / name))
        ids.append(lab.header(kept[0][1])[1])
        assert kept[0][0] == "RUN" and kept[-1][0] == "END" and {lab.header(d)[1] for _, d in kept} == {ids[-1]}
        first = next(types.robot_state_t.decode(d) for c, d in kept if c == "ROBOT_STATE")
        assert first.step == 0 and not any(first.q), "from the experiment's first state"
        resets = [types.event_t.decode(d) for c, d in kept if c == "EVENT" and types.event_t.decode(d).what == "reset"]
        assert len(resets) == (n < 2) and all(e.step == types.end_t.decode(kept[-1][1]).step for e in resets)
    assert len(set(ids)) == 3 and f"{ids[0] % 2**64:016x}" == ended["run"]


@pytest.mark.parametrize("clock", ["lockstep", "realtime"])
def test_a_python_controller_takes_the_place_by_one_line(runs, tmp_path, clock):
    python = lab.BUILD / "pyenv" / "bin" / "python"
    if not os.access(python, os.X_OK):
        pytest.skip("no Python with LCM here (tests/conformance/pyenv.sh)")
    lab.generated_types(tmp_path / "types")
    file = lab.experiment(tmp_path, dt=0.005, duration=3.0)
    controller = f"env PYTHONPATH={tmp_path}/types {python} {lab.ROOT}/examples/controller.py"
    ok(call(runs, "run", file, "--clock", clock, "-o", str(runs / "python"), "--set", f"processes.controller={controller}", *PATIENT))
    metrics = json.loads((runs / "python" / "metrics.json").read_text())
    assert metrics["complete"] and metrics["rms_error"] < 0.05, metrics


@pytest.mark.parametrize("how", ["killed", "restarted"])
@pytest.mark.parametrize("every", [1, 10])
def test_a_new_logger_goes_on_in_real_time_without_an_effect(runs, tmp_path, every, how):
    ok(call(runs, "up", "-d", "--set", f"logger.every={every}", *PATIENT))
    ok(call(runs, "wait", "--ready"))
    folder = runs / "live"
    lab.until(lambda: any(c == "ROBOT_STATE" for c, _ in lab.events(folder / "log.lcm.part")), "states in the log")
    if how == "killed":
        os.kill(state(folder)["logger"][1], signal.SIGKILL)
    else:
        ok(call(runs, "restart", "logger"))
    left = list(lab.events(folder / "log.lcm.part"))  # readable as it was left
    assert left[0][0] == "RUN"
    lab.until(lambda: state(folder)["logger"][2] == 1 and state(folder)["logger"][0] == "running", "the logger again")
    ok(call(runs, "wait", "--ready"))
    ok(call(runs, "down"))
    types = lab.generated_types(tmp_path / "types")
    happened = [types.event_t.decode(d).what for c, d in lab.events(folder / "log.lcm") if c == "EVENT"]
    assert "holding" not in happened, happened
    steps = [lab.header(d)[2] for c, d in lab.events(folder / "log.lcm") if c == "ROBOT_STATE"]
    assert steps == sorted(steps) and steps[-1] > 100
    telemetry = [types.process_t.decode(d) for c, d in lab.events(folder / "telemetry.lcm") if c == "PROCESS"]
    assert len({p.pid for p in telemetry if p.name == "logger"}) == 2, "of both loggers"


def test_a_controller_that_hangs_is_not_restarted(runs, tmp_path):
    """The first one says nothing from step 5 on, but lives; the next one is the lab's own."""
    types, once = lab.generated_types(tmp_path / "types"), tmp_path / "once"
    controller = f"test -e {once} && exec {lab.BUILD}/bin/lab-controller --run-dir {{run_dir}}; touch {once}; exec {INTRUDER} silent"
    ok(call(runs, "up", "-d", "-f", lab.live_experiment(tmp_path), "--set", f"processes.controller={controller}"))
    folder = runs / "live"

    def last_change_and_step():
        log = list(lab.events(folder / "log.lcm.part"))
        changes = [what for what in (types.event_t.decode(d).what for c, d in log if c == "EVENT") if what in ("running", "holding")]
        return changes[-1:], max((lab.header(d)[2] for c, d in log if c == "ROBOT_STATE"), default=-1)
    lab.until(lambda: (folder / "log.lcm.part").exists() and last_change_and_step()[1] >= 1000, "5 s")  # longer than a stopped one has
    assert last_change_and_step()[0] == ["holding"] and state(folder)["controller"][::2] == ("running", 0)
    ok(call(runs, "restart", "controller"))
    lab.until(lambda: last_change_and_step()[0] == ["running"], "the next one moves the robot")


def test_the_network_that_is_named_carries_the_messages(runs):
    ok(call(runs, "up", "-d", "--network", "lo", *PATIENT))
    assert "?ttl=1&interface=lo&" in lab.bus_of(runs / "live")
    ok(call(runs, "wait", "--ready"))
    ok(call(runs, "down"))


@pytest.mark.parametrize("mode", ["frozen", "replay", "nan", "over"])
def test_a_bad_controller_in_real_time_is_kept_inside_the_limits(runs, tmp_path, mode):
    python = lab.BUILD / "pyenv" / "bin" / "python"
    if not os.access(python, os.X_OK):
        pytest.skip("no Python with LCM here (tests/conformance/pyenv.sh)")
    types = lab.generated_types(tmp_path / "types")
    controller = f"env PYTHONPATH={tmp_path}/types {python} {lab.ROOT}/tests/system/bad_controller.py {mode}"
    file = lab.experiment(tmp_path, dt=0.005, duration=3.0)
    ok(call(runs, "run", file, "--clock", "realtime", "-o", str(runs / "bad"), "--set", f"processes.controller={controller}",
            "--set", "safety.timeout=0.1"))
    urdf = (lab.ROOT / "models" / "simple_3dof_arm.urdf").read_text()
    effort, speed = ([float(x) for x in re.findall(rf'<limit[^>]*\b{what}="([^"]*)"', urdf)] for what in ("effort", "velocity"))
    happened = []
    for channel, data in lab.events(runs / "bad" / "log.lcm"):
        if channel == "ROBOT_STATE":
            state = types.robot_state_t.decode(data)
            assert all(abs(v) <= most for v, most in zip(state.v, speed)), state.step
            assert all(abs(tau) <= most for tau, most in zip(state.tau, effort)), state.step
        elif channel == "EVENT":
            event = types.event_t.decode(data)
            happened.append(event.what)
    wanted = {"nan": "command_rejected", "over": "effort_clamped"}.get(mode, "holding")
    assert wanted in happened and "holding" in happened and [e for e in happened if e in ("holding", "running")][-1] == "running", happened

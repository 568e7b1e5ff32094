"""Requests to a running robot in both clocks, and what the watchdog does when its controller is killed."""
import json
import math
import os
import signal
import subprocess

import pytest

import labrun as lab

SEND = str(lab.BUILD / "bin" / "lab-send")
# Without the pause the controller is back before the watchdog notices that it was gone.
LIVE = """
robot: {{model: "builtin:manipulator"}}
simulator: {{clock: realtime, dt: 0.001, duration: {duration}}}
planner: {{kind: sinusoid, amplitude: 0.3}}
controller: {{kind: computed_torque, kp: 100, kd: 20}}
renderer: {{enabled: false}}
processes: {{controller: "while :; do {controller} --run-dir {{run_dir}}; sleep 0.1; done"}}
"""


def send(run, *words):
    """lab-send on the private bus of a run."""
    pid = str(run.pid("simulator"))
    enter = ["nsenter", "-t", pid, "-n"] if os.geteuid() == 0 else ["nsenter", "-t", pid, "-U", "-n", "--preserve-credentials"]
    url = "udpm://239.255.76.67:7667?ttl=0"
    return subprocess.run([*enter, "env", "LCM_DEFAULT_URL=" + url, SEND, *words], capture_output=True, text=True, timeout=lab.DEADLINE)


def ok(done):
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(autouse=True)
def namespaces_or_skip():
    works = subprocess.run(["unshare", "-n", "true"] if os.geteuid() == 0 else ["unshare", "-Urn", "true"], capture_output=True)
    if works.returncode != 0:
        pytest.skip("no network namespaces here: a run has a port of its own, which a stranger cannot know")


def frozen_at(run):
    """The newest step, once two looks agree while PROCESS messages go on."""
    seen = run.step()
    size = os.path.getsize(run.folder / "telemetry.lcm.part")
    lab.until(lambda: os.path.getsize(run.folder / "telemetry.lcm.part") > size, "more telemetry")
    return seen if run.step() == seen else None


def test_pause_step_resume_and_live_gains_in_lockstep(tmp_path):
    file = lab.experiment(tmp_path, dt=0.001, duration=600)
    with lab.Running(file, tmp_path / "run") as run:
        run.wait_for_step(100)
        paused = json.loads(ok(send(run, "pause", "--json")))
        step = paused["step"] - 1
        assert lab.until(lambda: frozen_at(run), "the run to stand still") <= step
        assert json.loads(ok(send(run, "step", "5", "--json")))["step"] == step + 1
        assert json.loads(ok(send(run, "pause", "--json")))["step"] == step + 6, "five steps, not one more"
        assert "accepted, from step" in ok(send(run, "set", "controller", "kp=80"))
        assert "accepted, from step" in ok(send(run, "payload", "link2", "0.5", "--com", "0,0,0.1"))
        for words, why in [(["set", "controller", "kq=1"], "has no 'kq'"), (["set", "controller", "kp=1,2"], "expected 1 or 3"),
                           (["goal", "1", "2"], "expected 3"), (["goal", "100", "0", "0"], "its limits are"),
                           (["goal", "--frame", "nowhere", "--position", "9,0,0"], "no frame 'nowhere'"),
                           (["reset"], "in lockstep"), (["push", "nowhere", "1", "2", "3"], "no frame 'nowhere'"),
                           (["payload", "nowhere", "1"], "no frame 'nowhere'"), (["payload", "link2", "-1"], "payload of -1 kg")]:
            done = send(run, *words)
            assert done.returncode == 7 and why in done.stderr, done.stderr
        done = send(run, "goal", "1", "x", "2")
        assert done.returncode == 2 and "'x' is not a number" in done.stderr
        for words in (["1", "--frame", "tool"], ["--position", "1,2,3"], [], ["--frame", "tool", "--position", "1,2"]):
            assert send(run, "goal", *words).returncode == 2, words
        ok(send(run, "resume"))
        run.wait_for_step(step + 500)
        run.process.send_signal(signal.SIGINT)
        assert run.finish().returncode == 130
    inputs = [data for channel, data in lab.events(run.folder / "log.lcm") if channel == "INPUT"]
    assert [lab.header(data)[2] for data in inputs] == [step + 6] * 2


def test_no_answer(tmp_path):
    done = subprocess.run([lab.ISOLATE, SEND, "--timeout", "0.5", "estop"], env=lab.environment(), capture_output=True, text=True, timeout=30)
    assert done.returncode == 7 and "unconfirmed" in done.stderr


def check_log(folder, tmp_path, timeout=0.02, dt=0.001):
    """Reads nothing but the log: speed, effort, and how long after the last command the robot was held."""
    types = lab.generated_types(tmp_path)
    last_command, held, ran, slipped = None, 0, 0, False
    state_time, speed, effort = {}, 0.0, 0.0
    for channel, data in lab.events(folder / "log.lcm"):
        if channel == "ROBOT_STATE":
            state = types.robot_state_t.decode(data)
            state_time[state.step] = state.utime
            speed, effort = max(speed, *map(abs, state.v)), max(effort, *map(abs, state.tau))
        elif channel == "COMMAND":
            last_command = types.command_t.decode(data).state_step
        elif channel == "EVENT":
            event = types.event_t.decode(data)
            if event.what == "holding":
                held += 1
                used = int(event.why.rsplit(" ", 1)[1])
                assert event.step - used <= timeout / dt, event.why
                if not slipped:  # by the wall clock too, unless the machine stood still
                    assert event.utime - state_time[used] <= timeout * 1e6, event.why
            slipped |= event.what == "clock_slipped"
            ran += event.what == "running"
    assert last_command is not None
    return held, ran, speed, effort


def test_killed_controllers_are_survived(tmp_path):
    kills = int(os.environ.get("LAB_TEST_KILLS", 8))
    file = tmp_path / "live.yaml"
    file.write_text(LIVE.format(duration=600, controller=lab.BUILD / "bin" / "lab-controller") + "")
    with lab.Running(str(file), tmp_path / "run") as run:
        run.wait_for_step(300)
        for _ in range(kills):
            before = run.step()
            os.kill(run.pid("controller"), signal.SIGKILL)
            # not before it runs again: the next kill must hit a new process
            def runs_again():
                seen = [e for e in events_of(run, tmp_path) if e.step > before and e.what in ("holding", "running")]
                return any(e.what == "holding" for e in seen) and seen[-1].what == "running"
            lab.until(runs_again, "held and running again")
        run.process.send_signal(signal.SIGINT)
        assert run.finish().returncode == 130
    held, ran, speed, effort = check_log(run.folder, tmp_path)
    assert held >= kills and ran >= kills
    assert speed < 3.15 and effort <= 150


def events_of(run, tmp_path):
    types = lab.generated_types(tmp_path)
    return [types.event_t.decode(data) for channel, data in lab.events(run.folder / "log.lcm.part") if channel == "EVENT"]


def test_a_goal_comes_between_a_cycle_and_it_goes_on(tmp_path):
    """By the log: no reference jumps, whatever the moment at which the requests came."""
    file = tmp_path / "live.yaml"
    file.write_text(LIVE.format(duration=600, controller=lab.BUILD / "bin" / "lab-controller"))
    a, b, aside = [0.4, 0.2, 0, 0, 0, 0], [-0.4, 0, 0.3, 0, 0, 0], [0, 0.5, 0.5, 0, 0, 0.3]
    cycle = ["--set", "planner.kind=point_to_point", "--set", f"planner.targets=[{a}, {b}]", "--set", "planner.dwell=0.1", "--set", "safety.timeout=0.5"]
    with lab.Running(str(file), tmp_path / "run", *cycle) as run:
        run.wait_for_step(700)
        there = json.loads(ok(send(run, "goal", *map(str, aside), "--json")))["step"]
        run.wait_for_step(there + 1500)
        back = json.loads(ok(send(run, "set", "planner", "motion=on", "--json")))["step"]
        done = send(run, "set", "planner", "motion=off")
        assert done.returncode == 7 and "motion=on" in done.stderr
        run.wait_for_step(back + 2500)
        run.process.send_signal(signal.SIGINT)
        assert run.finish().returncode == 130
    types = lab.generated_types(tmp_path)
    references = [types.reference_t.decode(d) for c, d in lab.events(run.folder / "log.lcm") if c == "REFERENCE"]
    # quintics of T >= 0.5 s over d <= 0.8 rad, from speeds below 3 and accelerations below 20: the jerk is at most
    # 60 d / T^3 + 36 v / T^2 + 9 a / T < 1200, the acceleration a + 6 d / T^2 + 4 v / T < 50. An answer may skip steps.
    for p, r in zip(references, references[1:]):
        h = (r.step - p.step) * 0.001
        for i in range(6):
            assert abs(r.v[i] - p.v[i]) <= 50 * h and abs(r.a[i] - p.a[i]) <= 1200 * h, (p.step, r.step, i)
            assert abs(r.q[i] - p.q[i] - h * (r.v[i] + p.v[i]) / 2) <= 1200 * h * h * h, (p.step, r.step, i)
    rests = [r for r in references if not any(r.v)]
    assert any(max(abs(x - y) for x, y in zip(r.q, aside)) < 1e-9 for r in rests if r.step < back)
    visited = [target for r in rests if r.step > back for target in (a, b) if max(abs(x - y) for x, y in zip(r.q, target)) < 1e-9]
    assert a in visited and b in visited


def effector(q):
    """Position and rotation (columns) of the manipulator's effector_body, from its table in docs/sample_models.md."""
    def times(a, b):
        return [[sum(a[r][k] * b[k][c] for k in range(3)) for c in range(3)] for r in range(3)]

    def about(axis, angle):
        c, s = math.cos(angle), math.sin(angle)
        return [[c, -s, 0], [s, c, 0], [0, 0, 1]] if axis == "z" else [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    R, p = [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [0, 0, 0]
    for axis, up, turned, angle in zip("zyyzyz", (0.15, 0.15, 0.45, 0.2, 0.2, 0.1), (0, 0, math.pi / 2, 0, 0, 0), q):
        p = [p[r] + R[r][2] * up for r in range(3)]
        R = times(R, times(about("y", turned), about(axis, angle)))
    return p, R


@pytest.mark.parametrize("clock", ["lockstep", "realtime"])
def test_a_frame_goes_where_it_is_sent(tmp_path, clock):
    """By forward kinematics from the robot's table; the simulator refuses what is too far and says how far."""
    file = tmp_path / "live.yaml"
    file.write_text(LIVE.format(duration=600, controller=lab.BUILD / "bin" / "lab-controller"))
    with lab.Running(str(file), tmp_path / "run", "--set", "planner.kind=hold", "--set", f"simulator.clock={clock}",
                     "--set", "simulator.q0=[0.3, 0.4, -0.5, 0.2, 0.6, 0.1]", "--set", "safety.timeout=0.5") as run:
        run.wait_for_step(200)
        done = send(run, "goal", "--frame", "effector_body", "--position", "10,0,0.3")
        assert done.returncode == 7 and "out of reach: 9.05 m from the target" in done.stderr, done.stderr
        step = json.loads(ok(send(run, "goal", "--frame", "effector_body", "--position", "0.4,-0.2,0.6", "--duration", "1", "--json")))["step"]
        run.wait_for_step(step + 1100)
        last = json.loads(ok(send(run, "goal", "--frame", "effector_body", "--position", "0.5,0.1,0.5", "--rpy", "0,1.5,0.3", "--duration", "1", "--json")))["step"]
        run.wait_for_step(last + 2000)
        run.process.send_signal(signal.SIGINT)
        assert run.finish().returncode == 130
    types = lab.generated_types(tmp_path)
    log = list(lab.events(run.folder / "log.lcm"))
    asked = [types.input_t.decode(d).action for c, d in log if c == "INPUT"]
    assert [(a.verb, a.target, a.n) for a in asked] == [("goal", "effector_body", 3), ("goal", "effector_body", 7)]
    assert not [types.event_t.decode(d).why for c, d in log if c == "EVENT" and types.event_t.decode(d).what == "action_ignored"]
    references = {r.step: r for r in (types.reference_t.decode(d) for c, d in log if c == "REFERENCE")}
    between = max(s for s in references if s < last)
    assert max(abs(a - b) for a, b in zip(effector(references[between].q)[0], (0.4, -0.2, 0.6))) < 1.1e-6
    assert not any(references[between].v)
    p, R = effector(references[max(references)].q)
    assert max(abs(a - b) for a, b in zip(p, (0.5, 0.1, 0.5))) < 1.1e-6
    # Rz(0.3) Ry(1.5): the tool's axis, and the one across it
    z, y = [row[2] for row in R], [row[1] for row in R]
    assert max(abs(a - b) for a, b in zip(z, (math.sin(1.5) * math.cos(0.3), math.sin(1.5) * math.sin(0.3), math.cos(1.5)))) < 2e-6
    assert max(abs(a - b) for a, b in zip(y, (-math.sin(0.3), math.cos(0.3), 0))) < 2e-6
    states = [types.robot_state_t.decode(d) for c, d in log if c == "ROBOT_STATE"]
    assert max(abs(a - b) for a, b in zip(effector(states[-1].q)[0], (0.5, 0.1, 0.5))) < 5e-3, "and the robot follows"


def test_goal_push_and_stop_in_real_time(tmp_path):
    file = tmp_path / "live.yaml"
    file.write_text(LIVE.format(duration=600, controller=lab.BUILD / "bin" / "lab-controller"))
    goal = [0.2, 0.4, -0.3, 0.1, 0.5, -0.2]
    with lab.Running(str(file), tmp_path / "run", "--set", "planner.kind=hold", "--set", "simulator.noise.q=1e-5", "--set", "simulator.delay=0.002") as run:
        run.wait_for_step(200)
        ok(send(run, "payload", "effector_body", "0.2"))
        ok(send(run, "goal", *map(str, goal), "--duration", "1"))
        ok(send(run, "push", "effector_body", "10", "0", "0", "--for", "0.2"))
        step = json.loads(ok(send(run, "estop", "--json")))["step"]
        ok(send(run, "rearm"))
        ok(send(run, "payload", "effector_body", "0"))
        run.wait_for_step(step + 2500)
        run.process.send_signal(signal.SIGINT)
        assert run.finish().returncode == 130
    types = lab.generated_types(tmp_path)
    states = [types.robot_state_t.decode(d) for c, d in lab.events(run.folder / "log.lcm") if c == "ROBOT_STATE"]
    events = [types.event_t.decode(d).what for c, d in lab.events(run.folder / "log.lcm") if c == "EVENT"]
    assert max(abs(a - b) for a, b in zip(states[-1].q, goal)) < 2e-3
    assert [e for e in events if e in ("estop", "rearm")] == ["estop", "rearm"] and [e for e in events if e in ("holding", "running")][-1] == "running"
    # the true states follow from the log in real time too, where every message has arrived
    done = subprocess.run([lab.BUILD / "bin" / "lab-experiment", "evaluate", run.folder], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and "the run ended at step" in done.stdout or "is not in the log" in done.stderr, done.stderr


@pytest.mark.robots
def test_a_goal_for_a_finger_that_follows_is_refused_by_name(tmp_path):
    if subprocess.run([lab.LAB, "robots", "--path"], capture_output=True).returncode != 0:
        pytest.skip("needs scripts/lab robots")
    panda = str(lab.ROOT / "experiments" / "panda_reach.yaml")
    with lab.Running(panda, tmp_path / "run", "--set", "renderer.enabled=false", "--set", "simulator.duration=600") as run:
        run.wait_for_step(100)
        refused = send(run, "goal", "panda_finger_joint2=0.01")
        assert refused.returncode == 2
        assert "goal: 'panda_finger_joint2' follows 'panda_finger_joint1'; give a goal for that one" in refused.stderr
        ok(send(run, "goal", "panda_finger_joint1=0.01", "--duration", "1"))


def test_where_two_labs_answer_a_request_must_say_which(tmp_path):
    """Two simulators with the same channels on one bus, as on two hosts of one network."""
    tool = str(lab.BUILD / "bin" / "lab-experiment")
    file = lab.experiment(tmp_path)
    for name in ("1", "2"):
        (tmp_path / name).mkdir()
        subprocess.run([tool, "resolve", file, "--set", f"seed={name}", "-o", str(tmp_path / name / "experiment.yaml")], check=True)
    both = (f"for i in 1 2; do {lab.BUILD}/bin/lab-simulator --run-dir {tmp_path}/$i 2>/dev/null & done;"
            f"until {SEND} pause 2>&1 | tee {tmp_path}/said | grep -q several; do :; done; cat {tmp_path}/said;"
            f"run=$(sed -n 's/.*--run: *//p' {tmp_path}/said); {SEND} --run ${{run% *}} pause; echo $?")
    done = subprocess.run([lab.ISOLATE, "bash", "-c", both], env=lab.environment(), capture_output=True, text=True, timeout=lab.DEADLINE)
    assert "several labs are on this bus: say which with --run: " in done.stdout, done.stderr
    assert "the run has not started" in done.stderr and done.stdout.endswith("\n7\n"), done.stderr


@pytest.mark.parametrize("clock", ["lockstep", "realtime"])
def test_what_is_accepted_happens_and_get_says_what_is_in_force(tmp_path, clock):
    file = tmp_path / "live.yaml"
    file.write_text(LIVE.format(duration=600, controller="").replace("processes:", "#"))
    with lab.Running(str(file), tmp_path / "run", "--set", "planner.kind=hold", "--set", f"simulator.clock={clock}", "--set", "safety.timeout=0.5") as run:
        run.wait_for_step(200)
        # too fast for the joint: refused with its limit and a time that would do, which then is accepted, and reached
        done = send(run, "goal", "joint2_shoulder=1", "--duration", "0.05")
        assert done.returncode == 7 and "limits of joint 'joint2_shoulder': speed" in done.stderr, done
        would_do = done.stderr.rsplit("; ", 1)[1].split()[0]
        done = json.loads(ok(send(run, "goal", "joint2_shoulder=1", "--duration", would_do, "--wait", "--json")))
        assert done["reached"] and done["reached_step"] - done["step"] >= float(would_do) / 0.001 - 5
        # not reached: another goal comes first, or the time is up
        done = send(run, "goal", "joint2_shoulder=0", "--duration", "300", "--wait", "--timeout", "0.5")
        assert done.returncode == 1 and "goal not reached: the reference has not arrived there" in done.stderr, done
        # gains: of the law, as they are now
        assert ok(send(run, "get", "controller", "kp")) == "100\n"
        ok(send(run, "set", "controller", "kp=80"))
        after = json.loads(ok(send(run, "get", "controller", "--json")))
        assert after["controller.kp"] == {"value": "80", "unit": "1/s2"} and after["controller.kd"]["value"] == "20"
        assert "controller.stiffness" not in after and ok(send(run, "get", "planner", "motion")).startswith("goal 0,0,")
        for words, why in ((["set", "controller", "stiffness=1,2"], "computed_torque does not use stiffness; it has kp, kd"),
                           (["set", "controller", "kp=abc"], "kp is 'abc', must be a number")):
            done = send(run, *words)
            assert done.returncode == 7 and why in done.stderr, done
        done = send(run, "get", "controller", "kpp")
        assert done.returncode == 2 and "did you mean 'controller.kp'" in done.stderr, done
        run.process.send_signal(signal.SIGINT)
        assert run.finish().returncode == 130
    types = lab.generated_types(tmp_path)
    ignored = [types.event_t.decode(d).why for c, d in lab.events(run.folder / "log.lcm") if c == "EVENT" and types.event_t.decode(d).what == "action_ignored"]
    assert not ignored, ignored

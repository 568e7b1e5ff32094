"""The same experiment gives the same bytes, whatever happens around it."""
import json
import os
import shutil
import signal
import subprocess
import threading

import pytest

import labrun as lab


@pytest.fixture(scope="module")
def quiet(tmp_path_factory):
    folder = tmp_path_factory.mktemp("quiet")
    file = lab.experiment(folder)
    return file, lab.solo(file, folder / "solo")


def same_log(done, folder, wanted):
    assert done.returncode == 0, done.stderr
    assert (folder / "log.lcm").read_bytes() == wanted


def test_five_processes_write_what_solo_writes(quiet, tmp_path):
    file, wanted = quiet
    same_log(lab.run(file, tmp_path / "run", "--set", "renderer.enabled=true", "--set", "renderer.fps=5",
                     "--set", "renderer.size=[160,120]"), tmp_path / "run", wanted)
    names = {p.name for p in (tmp_path / "run").iterdir()}
    assert {"log.lcm", "telemetry.lcm", "frames", "contact.png", "metrics.json", "manifest.json", "processes",
            "experiment.yaml"} <= names
    assert len(list((tmp_path / "run" / "frames").glob("*.png"))) == 11  # 0 to 2 s at 5 a second
    assert not [p for p in (tmp_path / "run").rglob("*") if p.suffix in (".part", ".state", ".pid", ".lock") or p.name.startswith(".")]


def test_a_disturbed_robot_is_the_same_robot_everywhere(tmp_path):
    """Noise, delay, pushes and payloads are functions of seed and step, not of process, loss or load."""
    file = lab.experiment(tmp_path)
    disturbed = [word for key in ("seed=7", "simulator.noise.q=1e-3", "simulator.noise.v=0.05", "simulator.delay=0.01",
                                  "simulator.pushes=[{time: 0.5, duration: 0.3, frame: link2, force: [0, 5, 0]}]",
                                  "simulator.payloads=[{time: 1, frame: link2, mass: 1}]") for word in ("--set", key)]
    wanted = lab.solo(file, tmp_path / "solo", *disturbed)
    same_log(lab.run(file, tmp_path / "run", *disturbed, LAB_FAULT_DROP="5,7"), tmp_path / "run", wanted)
    figures = [json.loads((tmp_path / name / "metrics.json").read_text()) for name in ("solo", "run")]
    assert figures[0] == figures[1] and figures[0]["complete"]
    other = lab.solo(file, tmp_path / "other", *disturbed, "--set", "seed=8")
    assert other != wanted, "another seed, other noise"


@pytest.mark.robots
def test_a_robot_whose_fingers_follow_each_other(tmp_path):
    """The Panda: eight numbers for nine joints, in five processes as in one; both meet what it expects."""
    if subprocess.run([lab.LAB, "robots", "--path"], capture_output=True).returncode != 0:
        pytest.skip("needs scripts/lab robots")
    file, plain = str(lab.ROOT / "experiments" / "panda_reach.yaml"), ("--set", "renderer.enabled=false")
    wanted = lab.solo(file, tmp_path / "solo", *plain)
    same_log(lab.run(file, tmp_path / "run", *plain), tmp_path / "run", wanted)
    joints = json.loads((tmp_path / "run" / "metrics.json").read_text())["joints"]
    assert [j["name"] for j in joints] == ["panda_joint%d" % i for i in range(1, 8)] + ["panda_finger_joint1"]


@pytest.mark.parametrize("order", ["reversed", "controller,logger,simulator,planner", "logger,simulator"])
def test_start_order(quiet, tmp_path, order):
    file, wanted = quiet
    same_log(lab.run(file, tmp_path / "run", "--order", order), tmp_path / "run", wanted)


@pytest.mark.parametrize("percent", [5, 30])
def test_packets_lost_in_the_endpoints(quiet, tmp_path, percent):
    file, wanted = quiet
    same_log(lab.run(file, tmp_path / "run", LAB_FAULT_DROP=f"{percent},7"), tmp_path / "run", wanted)


def test_packets_dropped_by_a_firewall(quiet, tmp_path):
    if shutil.which("nft") is None:
        pytest.skip("no nft")
    file, wanted = quiet
    rules = "add table ip lab; add chain ip lab input { type filter hook input priority 0; }; " \
            "add rule ip lab input udp dport 7667 numgen random mod 100 < 5 counter drop"
    script = f'nft "{rules}" || exit 77; "$@"; code=$?; nft list ruleset >{tmp_path}/rules; exit $code'
    done = lab.run(file, tmp_path / "run", before=[lab.ISOLATE, "sh", "-c", script, "_"])
    if done.returncode == 77:
        pytest.skip("nft may not set rules here")
    same_log(done, tmp_path / "run", wanted)
    assert "packets 0 " not in (tmp_path / "rules").read_text()


def test_liblcm_back_end(quiet, tmp_path):
    file, wanted = quiet
    same_log(lab.run(file, tmp_path / "run", LAB_BUS="liblcm"), tmp_path / "run", wanted)


def test_two_busy_loops_beside_it(quiet, tmp_path):
    file, wanted = quiet
    loops = [subprocess.Popen(["sh", "-c", "while :; do :; done"]) for _ in range(2)]
    try:
        same_log(lab.run(file, tmp_path / "run"), tmp_path / "run", wanted)
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def test_messages_really_travel(quiet, tmp_path):
    """At least two packets a step leave for the bus, by the kernel's own count."""
    file, wanted = quiet
    script = f'"$@"; code=$?; grep ^Udp: /proc/net/snmp >{tmp_path}/snmp; exit $code'
    same_log(lab.run(file, tmp_path / "run", before=[lab.ISOLATE, "sh", "-c", script, "_"]), tmp_path / "run", wanted)
    names, values = [line.split() for line in (tmp_path / "snmp").read_text().splitlines()[:2]]
    steps = sum(channel == "ROBOT_STATE" for channel, _ in lab.events(tmp_path / "run" / "log.lcm"))
    assert int(values[names.index("OutDatagrams")]) >= 2 * steps


def test_a_stopped_controller_freezes_the_run_and_changes_nothing(tmp_path):
    file = lab.experiment(tmp_path, dt=0.001, duration=60)
    wanted = lab.solo(file, tmp_path / "solo")
    types = lab.generated_types(tmp_path / "types")
    with lab.Running(file, tmp_path / "run") as run:
        run.wait_for_step(100)
        controller = run.pid("controller")
        os.kill(controller, signal.SIGSTOP)

        def still_for_half_a_second():
            steps = [p.step for p in lab.telemetry(run.folder, types) if p.name == "simulator"]
            return len(steps) > 5 and len(set(steps[-5:])) == 1 and steps[-1]
        frozen = lab.until(still_for_half_a_second, "the step count does not freeze")
        assert 100 <= frozen < 60000
        os.kill(controller, signal.SIGCONT)
        same_log(run.finish(), run.folder, wanted)


def test_the_last_bit_of_a_gain_changes_the_command_and_nothing_before_it(quiet, tmp_path):
    file, _ = quiet
    types = lab.generated_types(tmp_path / "types")
    logs = []
    for gain in ("100", "100.00000000000001"):
        lab.solo(file, tmp_path / gain, "--set", f"controller.kp={gain}")
        logs.append(list(lab.events(tmp_path / gain / "log.lcm")))
    assert len(logs[0]) == len(logs[1])
    decoders = {"ROBOT_STATE": types.robot_state_t, "REFERENCE": types.reference_t, "COMMAND": types.command_t}
    for (channel, one), (other_channel, other) in zip(*logs):
        assert channel == other_channel
        if channel not in decoders:
            continue
        a, b = decoders[channel].decode(one), decoders[channel].decode(other)
        a.run = b.run = 0  # the run's id is a hash of the experiment, gain included
        if hasattr(a, "digest"):
            a.digest = b.digest = 0  # the same
        if a.encode() != b.encode():
            assert channel == "COMMAND"
            assert tuple(a.tau) != tuple(b.tau)
            return
    pytest.fail("the gain changed nothing")


def test_a_thinned_log_holds_every_tenth_step_and_the_last(quiet, tmp_path):
    file, _ = quiet
    wanted = lab.solo(file, tmp_path / "solo", "--set", "logger.every=10", "--set", "simulator.duration=0.525")
    same_log(lab.run(file, tmp_path / "run", "--set", "logger.every=10", "--set", "simulator.duration=0.525"),
             tmp_path / "run", wanted)
    steps = [lab.header(data)[2] for channel, data in lab.events(tmp_path / "run" / "log.lcm") if channel == "ROBOT_STATE"]
    assert steps == [*range(0, 105, 10), 105]


def test_two_runs_at_once_do_not_hear_each_other(quiet, tmp_path):
    file, wanted = quiet
    results = {}

    def one(name):
        results[name] = lab.run(file, tmp_path / name)
    threads = [threading.Thread(target=one, args=(name,)) for name in ("a", "b")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for name in ("a", "b"):
        same_log(results[name], tmp_path / name, wanted)


def test_stock_tools_read_the_log(quiet, tmp_path):
    """lcm-logplayer plays it, lcm-logger hears all of it, and lcm-gen's own classes decode every event."""
    file, wanted = quiet
    log = tmp_path / "run" / "log.lcm"
    same_log(lab.run(file, tmp_path / "run"), tmp_path / "run", wanted)
    types = lab.generated_types(tmp_path / "types")
    kinds = {"RUN": "run_t", "TYPE": "type_t", "INPUT": "input_t", "EVENT": "event_t", "END": "end_t",
             "ROBOT_STATE": "robot_state_t", "REFERENCE": "reference_t", "COMMAND": "command_t"}
    count = 0
    for channel, data in lab.events(log):
        getattr(types, kinds[channel]).decode(data)
        count += 1
    assert count == 3 * 401 + 2 + sum(c == "TYPE" for c, _ in lab.events(log))

    player, logger = shutil.which("lcm-logplayer"), shutil.which("lcm-logger")
    assert player and logger, "the stock tools are in scripts/packages.txt"
    # The first event, played until it is heard, tells that the logger listens; heard again at the end, it tells that
    # all before it is in the file (the logger flushes only when something new comes).
    heard_again = f"PYTHONPATH={lab.ROOT}/tests/system python3 -c 'import labrun; " \
                  f"exit([c for c, _ in labrun.events(\"{tmp_path}/heard.lcm\")][-1:] != [\"RUN\"])'"
    script = f'''
      {logger} -q -f {tmp_path}/heard.lcm & logger=$!
      trap 'kill $logger 2>/dev/null' EXIT
      while [ ! -s {tmp_path}/heard.lcm ]; do {player} -s 1000 {tmp_path}/first.lcm >/dev/null; done
      {player} {log} >/dev/null
      until {heard_again}; do {player} -s 1000 {tmp_path}/first.lcm >/dev/null; done'''
    raw = log.read_bytes()
    first = next(lab.events(log))
    (tmp_path / "first.lcm").write_bytes(raw[:28 + len(first[0]) + len(first[1])])
    subprocess.run([lab.ISOLATE, "sh", "-c", script], check=True, timeout=lab.DEADLINE, env=lab.environment(),
                   stdin=subprocess.DEVNULL)
    heard = [event for event in lab.events(tmp_path / "heard.lcm") if event[0] != "RUN"]
    played = iter([event for event in lab.events(log) if event[0] != "RUN"])
    assert all(event in played for event in heard), "what was heard is not what is in the log, in its order"
    assert len(heard) > 0.8 * count  # the stock logger's queue is short; on a busy machine it drops some

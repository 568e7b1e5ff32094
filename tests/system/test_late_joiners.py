"""Programs that join in the middle, and what is left of a lab: a late spy knows RUN and every type; a log of real time is played
by stock lcm-logplayer; a process whose simulator is gone ends at its deadline. ctest runs this in a private network."""
import json
import shutil
import struct
import subprocess
import time

import pytest

import labrun as lab
from labrun import call, ok

EVERY_TYPE = {f"lab.{path.stem}" for path in (lab.ROOT / "lcmtypes").glob("*.lcm")}
SOON = 5  # s in which a program that comes late knows all


@pytest.fixture(scope="module")
def types(tmp_path_factory):
    return lab.generated_types(tmp_path_factory.mktemp("types"))


def port_of(folder):
    return int(lab.bus_of(folder).split(":")[2].split("?")[0])


def learn(bus, types):
    """Listens as long as a late program may have to; gives the RUN messages and the sources by name."""
    runs, sources = [], {}
    end = time.monotonic() + SOON
    while time.monotonic() < end and not (runs and EVERY_TYPE <= set(sources)):
        channel, data = bus.receive() or ("", b"")
        if channel == "RUN":
            runs.append(types.run_t.decode(data))
        elif channel == "TYPE":
            message = types.type_t.decode(data)
            sources[message.name] = message.source
    return runs, sources


def undisturbed(folder, types):
    """No process counts what is repeated for others as foreign, doubled or late. (In the first second it may not know its peers yet.)"""
    telemetry = [process for process in lab.telemetry(folder, types) if process.step >= 0]
    assert {process.name for process in telemetry} == {"simulator", "planner", "controller", "logger"}
    for name in {process.name for process in telemetry}:
        later = [process for process in telemetry if process.name == name][10:]
        counts = {(process.rejected, process.foreign, process.malformed) for process in later}
        assert len(later) > 10 and len(counts) == 1, (name, counts, later[-1].last_rejected)


def begins_as_ever(events, types):
    """RUN once, then TYPE by name, once each, and nothing of both later."""
    kinds = [channel for channel, _ in events]
    count = kinds.count("TYPE")
    names = [types.type_t.decode(data).name for _, data in events[1:1 + count]]
    assert kinds[0] == "RUN" and kinds.count("RUN") == 1 and kinds[1:1 + count] == ["TYPE"] * count
    assert names == sorted(set(names)) and "lab.robot_state_t" in names


def stamps(log):
    """The time of each event, with its channel."""
    raw, at, out = log.read_bytes(), 0, []
    while at < len(raw):
        _, _, utime, channel_size, data_size = struct.unpack_from(">IqqII", raw, at)
        out.append((raw[at + 28:at + 28 + channel_size].decode(), utime))
        at += 28 + channel_size + data_size
    return out


def play(log, tmp_path):
    """Stock lcm-logplayer plays a log at its own speed; gives how long that took, and what was heard."""
    bus, heard = lab.Bus(port=7999), []
    began = time.monotonic()
    player = subprocess.Popen([shutil.which("lcm-logplayer"), "-l", "udpm://239.255.76.67:7999?ttl=0", str(log)],
                              stdout=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
    try:
        while player.poll() is None and time.monotonic() < began + lab.DEADLINE:
            message = bus.receive()
            heard += [message[0]] if message else []
        assert player.poll() == 0, "lcm-logplayer waits for ever"
    finally:
        player.kill()
        player.wait()
    return time.monotonic() - began, heard


def test_a_live_lab_introduces_itself_and_its_log_has_one_clock(runs, tmp_path, types):
    folder = runs / "live"
    ok(call(runs, "up", "-d", "-f", lab.live_experiment(tmp_path)))
    ok(call(runs, "wait", "--ready"))
    heard, sources = learn(lab.Bus(port=port_of(folder)), types)
    assert set(sources) == EVERY_TYPE
    assert all(sources[f"lab.{path.stem}"] == path.read_text() for path in (lab.ROOT / "lcmtypes").glob("*.lcm"))
    assert "clock: realtime" in heard[0].experiment
    shown = json.loads(ok(call(runs, "spy", "echo", "RUN", "--once", "--json", "--timeout", str(SOON))))
    assert shown["message"]["run"] == heard[0].run and shown["message"]["joint_names"] == heard[0].joint_names
    ok(call(runs, "down"))

    undisturbed(folder, types)
    log = folder / "log.lcm"
    begins_as_ever(list(lab.events(log)), types)
    times = stamps(log)
    back = [(before, after) for before, after in zip(times, times[1:]) if after[1] < before[1]]
    assert not back, back[:3]
    assert times[0][1] == next(t for channel, t in times if channel == "ROBOT_STATE")
    assert abs(times[0][1] * 1e-6 - log.stat().st_mtime) < 600, "it is the wall clock"
    ok(call(runs, "report", "live"))

    length = (times[-1][1] - times[0][1]) * 1e-6
    took, played = play(log, tmp_path)
    assert took < length + 5 and played[0] == "RUN" and "END" in played, (took, length)


def test_a_lockstep_run_introduces_itself_and_its_log_stays_the_same(runs, tmp_path, types):
    folder, file = runs / "motion", lab.experiment(tmp_path, dt=0.001, duration=100)
    ok(call(runs, "up", "-d", "-f", file))
    lab.until(lambda: call(runs, "pause").returncode == 0, "the run is paused")
    heard, sources = learn(lab.Bus(port=port_of(folder)), types)
    assert set(sources) == EVERY_TYPE
    shown = json.loads(ok(call(runs, "spy", "echo", "RUN", "--once", "--json", "--timeout", str(SOON))))
    assert shown["message"]["run"] == heard[0].run
    ok(call(runs, "down"))
    undisturbed(folder, types)
    written = list(lab.events(folder / "log.lcm"))
    begins_as_ever(written, types)
    assert written[-1][0] == "END" and len(written) > 20
    before_end = (folder / "log.lcm").read_bytes()[:-(28 + len("END") + len(written[-1][1]))]
    assert lab.solo(file, tmp_path / "solo").startswith(before_end)


@pytest.mark.parametrize("name", ["logger", "planner", "controller"])
def test_a_process_ends_at_its_deadline(name, tmp_path):
    url = "udpm://239.255.76.67:7680?ttl=0"
    own = tmp_path / "own"
    own.mkdir()

    def start(program, *words):
        return subprocess.Popen([lab.BUILD / "bin" / program, "-l", url, *words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, cwd=own)

    def end_of(process, least, code, words):
        began = time.monotonic()
        _, err = process.communicate(timeout=20)
        assert process.returncode == code and words in err, err
        assert time.monotonic() - began > least

    # no simulator at all
    end_of(start(f"lab-{name}", "--run-dir", str(own), "--ready", "0.5"), 0.4, 4, "no RUN from the simulator in 0.5 s")
    # one that dies
    simulator = start("lab-simulator", "--experiment", lab.live_experiment(tmp_path))
    process = start(f"lab-{name}", "--run-dir", str(own), "--deadline", "1")
    bus = lab.Bus(port=7680)

    def is_ready():
        channel, data = bus.receive() or ("", b"")
        return channel == "PROCESS" and name.encode() in data and b"READY" in data
    try:
        lab.until(is_ready, f"{name} is ready")
        simulator.kill()
        simulator.communicate()
        end_of(process, 0.7, 7, "nothing from the simulator in 1 s")
    finally:
        for left in (simulator, process):
            left.kill()
            left.communicate()

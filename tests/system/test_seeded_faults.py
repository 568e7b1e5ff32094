"""Seeded faults in labs that keep running: each part is killed, crashed, stopped and restarted, in both clocks.

What must hold: in lockstep the log is the undisturbed run's. In real time HOLDING begins within safety.timeout of the last
command and ends at most 1 s after the restart, and every log is whole. A lab whose supervisor is killed leaves nothing.
A tenth of the faults by default; all 200 with LAB_TEST_FAULTS=all.
"""
import os
import pathlib
import random
import signal
import time

import labrun as lab
import pytest
from labrun import call, ok, state

ALL = os.environ.get("LAB_TEST_FAULTS") == "all"
SIGNALS = {"KILL": signal.SIGKILL, "SEGV": signal.SIGSEGV, "STOP": signal.SIGSTOP}
TIMEOUT = 0.2  # s, safety.timeout: a loaded machine is late by itself, but not by this
# what a restarted process may cost beyond the contract's second: reading the log, and our polling
AFTER_RESTART = 1.0

# (part, fault) that a lab survives, and those that end it
SURVIVED = [(part, fault) for part in ("planner", "controller", "logger") for fault in ("KILL", "SEGV", "STOP", "RESTART")]
SURVIVED += [("simulator", "RESTART"), ("supervisor", "STOP")]
FATAL = [(part, fault) for part in ("simulator", "supervisor") for fault in ("KILL", "SEGV")] + [("simulator", "STOP")]
PER_LAB = 5  # faults; fewer than the ten short lives after which a process is given up


def plan(kinds, count, seed):
    """`count` faults in lots of at most PER_LAB: all kinds before any comes again, in an order that the seed decides."""
    rng = random.Random(seed)
    chosen = []
    while len(chosen) < count:
        chosen += rng.sample(kinds, min(len(kinds), count - len(chosen)))
    return [chosen[i:i + PER_LAB] for i in range(0, count, PER_LAB)]


def name_of(lot):
    return "-".join(f"{part}_{fault}".lower() for part, fault in lot)


def supervisor_of(folder):
    words = (folder / "processes" / "state").read_text().split()
    return int(words[1])


def inject(runs, folder, part, fault):
    """Does it, and waits until the part runs again. Returns when it was started again, in s since boot."""
    if part == "supervisor":
        supervisor = supervisor_of(folder)
        os.kill(supervisor, SIGNALS[fault])
        lab.until(lambda: pathlib.Path(f"/proc/{supervisor}/stat").read_text().rpartition(")")[2].split()[0] != "T", "to go on")
        return time.clock_gettime(time.CLOCK_BOOTTIME)
    before = lab.until(lambda: state(folder)[part][1] and state(folder)[part], f"a pid of {part}")
    if fault == "RESTART":
        ok(call(runs, "restart", part, "--lab", folder.name))
    else:
        os.kill(before[1], SIGNALS[fault])

    def again():
        status, pid, restarts = state(folder)[part]
        return status == "running" and restarts > before[2] and pid not in (0, before[1])
    lab.until(again, f"{part} again after {fault}")
    for line in (folder / "processes" / "state").read_text().splitlines():
        words = line.split()
        if words[0] == "process" and words[1] == part:
            return int(words[4]) / 1000
    raise AssertionError(f"no {part} in the state")


def whole(log):
    """The events of a log, whose steps rise. (In real time, what happened while there was no logger is not in it.)"""
    events = list(lab.events(log))
    steps = [lab.header(data)[2] for channel, data in events if channel == "ROBOT_STATE"]
    assert events[0][0] == "RUN" and steps and all(a < b for a, b in zip(steps, steps[1:])), log
    return events


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("undisturbed")
    file = lab.experiment(folder, dt=0.001, duration=8)
    return file, lab.solo(file, folder / "solo")


@pytest.mark.parametrize("lot", plan(SURVIVED, 80 if ALL else 8, seed=1), ids=name_of)
def test_in_lockstep_the_log_is_the_undisturbed_one(runs, undisturbed, lot):
    file, wanted = undisturbed
    ok(call(runs, "up", "-d", "--private", "-f", file))
    folder = runs / "motion"
    rng = random.Random(name_of(lot))
    for part, fault in lot:
        if not (folder / "processes" / "control").exists():
            break  # it has ended before this fault came: nothing to disturb
        part_of_it = folder / "log.lcm.part"
        enough = rng.randrange(1, 300_000)
        lab.until(lambda: not part_of_it.exists() or part_of_it.stat().st_size > enough, "progress")
        if part_of_it.exists():
            inject(runs, folder, part, fault)
    assert call(runs, "wait", "--exit", "--lab", "motion").returncode == 0
    assert (folder / "log.lcm").read_bytes() == wanted


def changes(log, types):
    """The changes of state in the log so far: holding, running."""
    found = []
    for channel, data in lab.events(log):
        if channel == "EVENT":
            event = types.event_t.decode(data)
            if event.what in ("holding", "running"):
                found.append(event.what)
    return found


@pytest.mark.parametrize("lot", plan(SURVIVED, 100 if ALL else 10, seed=2), ids=name_of)
def test_in_real_time_the_robot_is_held_and_goes_on(runs, tmp_path, lot):
    types = lab.generated_types(tmp_path / "types")
    ok(call(runs, "up", "-d", "--set", f"safety.timeout={TIMEOUT}", "--set", "logger.every=1"))
    ok(call(runs, "wait", "--ready"))
    folder = runs / "live"
    for part, fault in lot:
        started = inject(runs, folder, part, fault)
        ok(call(runs, "wait", "--ready"))
        if part == "controller":
            log = folder / "log.lcm.part"
            lab.until(lambda: changes(log, types)[-1:] == ["running"], "RUNNING again")
            assert time.clock_gettime(time.CLOCK_BOOTTIME) - started < AFTER_RESTART + 1, f"{part} {fault}: held for too long"
    ok(call(runs, "down"))
    for log in [folder / "log.lcm", *folder.glob("log-*.lcm")]:
        last_command = 0
        for channel, data in whole(log):
            step = lab.header(data)[2]
            if channel == "COMMAND":
                last_command = step
            elif channel == "EVENT" and types.event_t.decode(data).what == "holding" and last_command:
                late = (step - last_command) * 0.001
                assert late <= TIMEOUT + 0.05, f"{log}: held {late} s after the last command, at step {step}"


@pytest.mark.parametrize("clock", ["realtime", "lockstep"])
@pytest.mark.parametrize("part, fault", FATAL * 2 if ALL else FATAL[::3])
def test_of_a_lab_that_dies_nothing_is_left_but_a_whole_log(runs, undisturbed, part, fault, clock):
    ok(call(runs, "up", "-d", "-f", undisturbed[0], "--set", f"simulator.clock={clock}", "--set", "simulator.duration=3600"))
    folder = runs / "motion"
    log = folder / "log.lcm.part"
    lab.until(lambda: log.exists() and log.stat().st_size > 20_000, "a log")
    os.kill(supervisor_of(folder) if part == "supervisor" else state(folder)[part][1], SIGNALS[fault])
    lab.until(lambda: not lab.leftovers(folder), "all processes to end")
    code = call(runs, "wait", "--exit", "--lab", "motion").returncode
    assert code == 5 if part == "simulator" else code != 0
    whole(log if log.exists() else folder / "log.lcm")

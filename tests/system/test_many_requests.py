"""Seeded requests to live labs, judged by a monitor that reads nothing but the logs. They are LAB_TEST_REQUESTS (100) for
each of three labs, and as many at 167 a second for a lab whose controller is killed meanwhile."""
import collections
import json
import os
import random
import shutil
import signal
import subprocess
import time

import pytest

import labrun as lab
from labrun import ok, state

COUNT = int(os.environ.get("LAB_TEST_REQUESTS", 100))
RATE = 100000 / 600  # requests a second
NOBODY = 65534
FOLLOWING = """
robot: {{model: "{root}/models/simple_3dof_arm.urdf", armature: 0.2}}
simulator: {{clock: realtime, dt: 0.001, duration: 36000}}
planner: {{kind: sinusoid, amplitude: 0.4}}
controller: {{kind: pd, kp: 100, kd: 20}}
logger: {{every: 1}}
safety: {{timeout: 0.5}}
renderer: {{enabled: false}}
"""


@pytest.fixture(scope="module")
def types(tmp_path_factory):
    return lab.generated_types(tmp_path_factory.mktemp("types"))


class Checkout:
    """A lab of its own files, and of a user."""

    def __init__(self, folder, user, prefix):
        self.root, self.runs, self.user, self.prefix = folder / "project", folder / "runs", user, prefix
        for name in ("scripts", "experiments", "models"):
            shutil.copytree(lab.ROOT / name, self.root / name, symlinks=True)
        self.runs.mkdir()
        if user:
            os.chown(self.runs, user, user)

    def call(self, *words):
        words = [str(self.root / "scripts" / "lab"), *words]
        if self.user:
            words = ["setpriv", f"--reuid={self.user}", f"--regid={self.user}", "--clear-groups", *words]
        return subprocess.run(words, env=lab.environment(LAB_RUNS=str(self.runs), LAB_PREFIX=self.prefix), capture_output=True,
                              text=True, timeout=lab.DEADLINE, stdin=subprocess.DEVNULL)

    def start(self, types):
        ok(self.call("up", "-d", "--set", "logger.every=10", "--set", "safety.timeout=0.5"))
        ok(self.call("wait", "--ready"))
        self.bus = lab.Bus(int(lab.bus_of(self.runs / "live").split(":")[2].split("?")[0]))
        self.run = None
        while self.run is None:
            message = self.bus.receive()
            if message and message[0] == self.prefix + "ROBOT_STATE":
                self.run = lab.header(message[1])[1]

    def ask(self, types, sender, number, data):
        """The reply, or None when there is none; repeated as verbs do."""
        for _ in range(10):
            self.bus.send(self.prefix + "REQUEST", data)
            again = time.monotonic() + 0.1
            while time.monotonic() < again:
                message = self.bus.receive()
                if message and message[0] == self.prefix + "REPLY":
                    reply = types.reply_t.decode(message[1])
                    if (reply.sender, reply.id) == (sender, number):
                        return reply
        return None


def any_action(rng):
    return rng.choice([dict(verb="goal", values=[rng.uniform(-0.3, 0.3) for _ in range(6)]),
                       dict(verb="set", target="controller", key="kp", values=[rng.uniform(80, 120)]),
                       dict(verb="set", target="controller", key="kd", values=[rng.uniform(15, 25)]),
                       dict(verb="push", target="effector_body", values=[0, 0, 0, rng.uniform(-1, 1), 0, 0, 0.01]),
                       dict(verb="goal", values=[1.0])])  # refused: one value of six


def test_three_labs_of_two_users_each_log_what_they_accepted(tmp_path, types):
    """Some requests name no run, some the run of another lab: those nobody accepts."""
    if os.geteuid() == 0:
        for folder in [tmp_path, *tmp_path.parents][:-1]:
            folder.chmod(folder.stat().st_mode | 0o011)
    other = NOBODY if os.geteuid() == 0 else None  # without rights: three checkouts of one user
    labs = [Checkout(tmp_path / name, user, prefix) for name, user, prefix in (("a", None, ""), ("b", other, ""), ("c", other, "LEFT_"))]
    accepted, strange = {}, 0
    try:
        for one in labs:
            one.start(types)
        rng = random.Random(3)
        turns = [one for one in labs for _ in range(min(COUNT, 1000))]
        rng.shuffle(turns)
        for number, one in enumerate(turns, 1):
            kind = rng.random()
            if kind < 0.02:  # meant for another lab
                strange += 1
                run = rng.choice([there for there in labs if there is not one]).run
                one.bus.send(one.prefix + "REQUEST", lab.request(types, "monitor", number, run=run, **any_action(rng)))
                continue
            run = 0 if kind < 0.1 else one.run
            reply = one.ask(types, "monitor", number, lab.request(types, "monitor", number, run=run, **any_action(rng)))
            assert reply is not None, f"no answer to request {number}"
            if reply.ok:
                accepted[number] = one
        for one in labs:
            ok(one.call("down"))
    finally:
        for one in labs:
            one.call("down", "--all", "--timeout", "5")
    assert strange > 0 and len(accepted) > len(turns) / 2
    found = collections.defaultdict(list)
    for one in labs:
        for channel, data in lab.events(one.runs / "live" / "log.lcm"):
            if channel == "INPUT":
                message = types.input_t.decode(data)
                assert message.sender == "monitor"
                found[message.id].append(one)
    assert found == {number: [one] for number, one in accepted.items()}


def test_a_restarted_controller_has_every_gain_before_its_first_command(runs, tmp_path, types):
    """tau of every COMMAND in the log is that of the gains whose INPUT holds at its step, also of the first one after a
    kill; the requests cost no tick and no memory."""
    file = tmp_path / "following.yaml"
    file.write_text(FOLLOWING.format(root=lab.ROOT))
    ok(lab.call(runs, "up", "-d", "-f", str(file), "--quota", "0"))
    ok(lab.call(runs, "wait", "--ready"))
    folder = runs / "following"
    bus = lab.Bus()
    simulator = state(folder)["simulator"][1]
    before, kills, begin = lab.memory(simulator), 0, time.monotonic()
    rng = random.Random(4)
    count = max(COUNT, 500)
    for number in range(1, count + 1):
        key, around = rng.choice([("kp", 100), ("kd", 20)])
        values = [around * rng.uniform(0.8, 1.2) for _ in range(3)]
        bus.send("REQUEST", lab.request(types, "many", number, "set", target="controller", key=key, values=values))
        if number % max(count // 5, 1000) == 250:
            os.kill(state(folder)["controller"][1], signal.SIGKILL)
            kills += 1
        time.sleep(max(0.0, begin + number / RATE - time.monotonic()))
    lab.until(lambda: state(folder)["controller"][0] == "running" and state(folder)["controller"][2] == kills, "the controller again")
    grown = lab.memory(simulator) - before
    [there] = json.loads(ok(lab.call(runs, "ps", "--json")))
    ok(lab.call(runs, "down"))

    gains = {"kp": [100.0] * 3, "kd": [20.0] * 3}
    states, references, checked, missed, inputs, largest = {}, {}, 0, 0, 0, 0.0
    for channel, data in in_order(lab.events(folder / "log.lcm"), types):
        if channel == "INPUT":
            gains[data.action.key] = list(data.action.values)
            inputs += 1
        elif channel == "ROBOT_STATE":
            states[data.step] = data
        elif channel == "REFERENCE":
            references[data.step] = data
        else:
            x, r = states.get(data.state_step), references.get(data.reference_step)
            if x is None or r is None:  # the logger missed it
                missed += 1
                continue
            tau = [p * (a - b) + d * (c - e) for p, d, a, b, c, e in zip(gains["kp"], gains["kd"], r.q, x.q, r.v, x.v)]
            largest = max(largest, *(abs(one - two) for one, two in zip(tau, data.tau)))
            checked += 1
    [overruns] = [one["overruns"] for one in there["processes"] if one["name"] == "simulator"]
    print(f"{count} requests, {inputs} inputs, {kills} kills; {checked} commands, {missed} of something not logged, differ by "
          f"at most {largest} Nm; {overruns} overruns, memory {grown:+d} bytes")
    assert inputs >= 0.99 * count, "a packet may be lost, and 64 are taken in a step"
    assert kills >= 1 and checked > 1000 and missed < 0.1 * checked
    assert largest < 1e-9, "Nm; a product and a sum may be one instruction, with one rounding"
    assert grown < 20e6


def in_order(events, types):
    """Whatever the order of arrival: sorted by step, INPUT by number before what it holds for."""
    kinds = {"INPUT": (0, types.input_t), "ROBOT_STATE": (1, types.robot_state_t), "REFERENCE": (2, types.reference_t),
             "COMMAND": (3, types.command_t)}
    decoded = [(channel, kinds[channel][1].decode(data)) for channel, data in events if channel in kinds]
    decoded.sort(key=lambda one: (getattr(one[1], "state_step", one[1].step), kinds[one[0]][0], getattr(one[1], "input_seq", 0)))
    return decoded

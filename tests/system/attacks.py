#!/usr/bin/env python3
"""Attacks on a run by a program that reads everything on its bus and sends from a socket of its own.

usage: attacks.py [--all | NAME..] [--clock lockstep|realtime] [--seed N] [--json] [-o DIR]

Each attack goes on during one whole run. A run is unaffected when it ends with 0 and, in lockstep, its log is that of a
quiet run byte for byte; in real time, when from 1 s on every joint is within 1e-3 rad of the quiet run (for how many ticks a
robot waits for its first command varies, and that error decays with 0.1 s) and the robot was not held.
To be run in a network namespace of its own: tests/support/netns.sh tests/system/attacks.py --all
"""
import argparse
import json
import os
import pathlib
import random
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

import labrun as lab

GROUP, PORT = "239.255.76.67", 7667
SHORT, FRAGMENT = 0x4C433032, 0x4C433033
FAR = 1 << 62
EXPERIMENT = """
name: attacked
robot: {{model: "{root}/models/simple_3dof_arm.urdf", armature: 0.2}}
simulator: {{dt: 0.001, duration: {duration}, clock: {clock}}}
planner: {{kind: sinusoid, amplitude: 0.4}}
controller: {{kind: computed_torque, kp: 100, kd: 20}}
safety: {{timeout: 0.1}}
renderer: {{enabled: false}}
"""
DURATION = {"lockstep": 15.0, "realtime": 2.5}  # s of simulation time
SETTLED = 1000                                  # steps
MEMORY = 20 << 20                               # bytes that a process may grow beyond the quiet run


class Bus:
    """A socket that sends, and one that reads what the lab says."""

    def __init__(self, seed):
        self.out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        self.sequence = 0
        self.random = random.Random(seed)
        self.seen = {}     # channel: newest message
        self.history = []  # ROBOT_STATE messages
        self.over = False
        self.sent = 0
        self.reader = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.reader.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.reader.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        self.reader.bind((GROUP, PORT))
        self.reader.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                               socket.inet_aton(GROUP) + socket.inet_aton("127.0.0.1"))
        self.reader.settimeout(0.05)
        self.own = self.out.getsockname()
        self.thread = threading.Thread(target=self.listen, daemon=True)
        self.thread.start()

    def listen(self):
        while not self.over:
            try:
                packet, sender = self.reader.recvfrom(65536)
            except socket.timeout:
                continue
            if sender[1] == self.out.getsockname()[1] or packet[:4] != struct.pack(">I", SHORT):
                continue
            channel, _, data = packet[8:].partition(b"\0")
            self.seen[channel.decode("latin1")] = data
            if channel == b"ROBOT_STATE" and len(self.history) < 2000:
                self.history.append(data)

    def raw(self, packet):
        try:
            self.out.sendto(packet, (GROUP, PORT))
            self.sent += 1
        except OSError:
            pass  # the kernel's queue is full

    def short(self, channel, data):
        self.sequence += 1
        self.raw(struct.pack(">II", SHORT, self.sequence) + channel.encode("latin1") + b"\0" + data)

    def fragment(self, size, offset, number, parts, body, channel=b""):
        self.sequence += 1
        self.raw(struct.pack(">IIIIHH", FRAGMENT, self.sequence, size, offset, number, parts) + channel + body)

    def copy(self, channel):
        return self.seen.get(channel)

    def close(self):
        self.over = True
        self.thread.join()
        self.out.close()
        self.reader.close()


def with_step(data, step):
    return data[:24] + struct.pack(">q", step) + data[32:]


def with_run(data, run):
    return data[:16] + struct.pack(">q", run) + data[24:]


def step_of(data):
    return lab.header(data)[2]


def with_noise(data, rng, after=36):
    """Other numbers in the content: the last doubles of the message."""
    out = bytearray(data)
    for at in range(max(after, len(out) - 60), len(out) - 12, 8):
        out[at:at + 8] = struct.pack(">d", rng.uniform(-50, 50))
    return bytes(out)


# --- the attacks: name -> function(bus), called about two hundred times a second ---------------------------------------
ATTACKS = {}
CHANNELS = ("RUN", "ROBOT_STATE", "REFERENCE", "COMMAND", "EVENT", "END", "ACK", "NEED", "PROCESS", "INPUT", "REPLY")
NAMES = ("simulator", "planner", "controller", "logger")


def attack(name):
    def add(function):
        ATTACKS[name] = function
        return function
    return add


def forged(types):
    """Messages of channels that are not said in every run."""
    event = types.event_t()
    event.process, event.what, event.who, event.why = "controller", "holding", "nobody", "forged"
    end = types.end_t()
    end.reason = "forged"
    state = {"EVENT": event, "END": end, "INPUT": types.input_t(), "REPLY": types.reply_t(), "NEED": types.need_t(),
             "ACK": types.ack_t()}
    state["INPUT"].input_seq, state["INPUT"].sender, state["INPUT"].action = 1, "nobody", types.action_t()
    state["INPUT"].action.verb, state["INPUT"].action.target, state["INPUT"].action.key = "set", "controller", "kp"
    state["INPUT"].action.n, state["INPUT"].action.values = 1, [0.0]
    state["NEED"].process, state["NEED"].sender = "simulator", "logger"
    state["ACK"].process, state["ACK"].complete_to, state["ACK"].closed = "logger", FAR, True
    return {channel: message.encode() for channel, message in state.items()}


def message(bus, channel):
    """The newest message of a channel, or a forged one with this run's id; None before the run is known."""
    if channel in bus.seen:
        return bus.seen[channel]
    state = bus.copy("ROBOT_STATE")
    return with_step(with_run(bus.forged[channel], lab.header(state)[1]), step_of(state)) \
        if state and channel in bus.forged else None


def define(types):
    for channel in CHANNELS:
        @attack(f"doubled {channel}")
        def doubled(bus, channel=channel):
            if data := message(bus, channel):
                bus.short(channel, data)

        @attack(f"{channel} for the next step with other content")
        def altered(bus, channel=channel):
            if data := message(bus, channel):
                bus.short(channel, with_noise(with_step(data, step_of(data) + 1), bus.random))

        @attack(f"{channel} of step 2^62")
        def far(bus, channel=channel):
            if data := message(bus, channel):
                bus.short(channel, with_step(data, FAR))

        @attack(f"{channel} of another type")
        def other_type(bus, channel=channel):
            if data := message(bus, "REFERENCE" if channel != "REFERENCE" else "COMMAND"):
                bus.short(channel, data)

        @attack(f"truncated {channel}")
        def truncated(bus, channel=channel):
            if data := message(bus, channel):
                bus.short(channel, data[:bus.random.randrange(len(data))])

    for name in NAMES:
        @attack(f"a second {name} with another pid")
        def second(bus, name=name):
            if data := bus.copy("PROCESS"):
                process = types.process_t.decode(data)
                process.name, process.pid, process.state, process.utime = name, 4242, "READY", process.utime + 10**12
                bus.short("PROCESS", process.encode())

        @attack(f"a {name} of another launch")
        def other_launch(bus, name=name):
            if data := bus.copy("PROCESS"):
                process = types.process_t.decode(data)
                process.name, process.nonce, process.model_hash = name, process.nonce + 1, 17
                bus.short("PROCESS", process.encode())

    @attack("states of this run once more")
    def replayed(bus):
        if bus.history:
            bus.short("ROBOT_STATE", bus.random.choice(bus.history))

    @attack("a NaN in COMMAND")
    def not_a_number(bus):
        if data := bus.copy("COMMAND"):
            bus.short("COMMAND", data[:-20] + struct.pack(">d", float("nan")) + data[-12:])

    @attack("a fragment at 64 MB")
    def far_fragment(bus):
        bus.fragment(64 << 20, (64 << 20) - 1, 1, 2, b"x")

    @attack("first fragments without an end")
    def first_fragments(bus):
        bus.fragment(16 << 20, 0, 0, 300, b"x" * 1000, b"RUN\0")

    @attack("fragments that contradict each other")
    def contradictions(bus):
        bus.sequence -= 1
        bus.fragment(bus.random.randrange(1, 1 << 20), bus.random.randrange(1 << 20), bus.random.randrange(9), 9, b"x" * 30)

    @attack("random bytes")
    def noise(bus):
        bus.raw(bus.random.randbytes(bus.random.randrange(1, 1400)))

    @attack("random bytes on COMMAND")
    def noise_on_command(bus):
        bus.short("COMMAND", bus.random.randbytes(bus.random.randrange(1, 1400)))

    @attack("RUN asked for, without an end")
    def ask_for_run(bus):
        need = types.need_t()
        need.step, need.process, need.sender = -1, "simulator", "stranger"
        for _ in range(20):
            bus.short("NEED", need.encode())

    @attack("channels of others")
    def others(bus):
        for i in range(20):
            bus.short(f"OTHER_{bus.random.randrange(1000)}", bus.random.randbytes(100))

    @attack("a long channel name")
    def long_name(bus):
        bus.short("C" * bus.random.choice((63, 64, 200)), b"x" * 40)

    @attack("a flood of 10,000 packets a second")
    def flood(bus):
        for _ in range(50):
            bus.short("COMMAND", bus.seen.get("COMMAND", b"x"))


# --- one run ----------------------------------------------------------------------------------------------------------
def write_experiment(folder, clock):
    path = pathlib.Path(folder) / "attacked.yaml"
    path.write_text(EXPERIMENT.format(root=lab.ROOT, clock=clock, duration=DURATION[clock]))
    return str(path)


def peak_memory(pid):
    try:
        for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
            if line.startswith("VmHWM"):
                return int(line.split()[1]) << 10
    except OSError:
        pass
    return 0


def attacked_run(folder, clock, function, seed, forged_messages):
    """The run in `folder`, under the attack (None: quiet). Returns exit code, stderr, packets sent, peak memory by name."""
    bus = Bus(seed)
    bus.forged = forged_messages
    memory = {}
    with lab.Running(write_experiment(folder, clock), folder / "run", "--no-report", LAB_ISOLATED="net",
                     LCM_DEFAULT_URL=f"udpm://{GROUP}:{PORT}?ttl=0") as run:
        pids = {}
        looked = 0
        while run.process.poll() is None:
            if function:
                function(bus)
            if time.monotonic() - looked > 0.2:
                looked = time.monotonic()
                for name in NAMES:
                    if name not in pids and "ROBOT_STATE" in bus.seen:
                        pids[name] = run.pid(name)
                    if name in pids:
                        memory[name] = max(memory.get(name, 0), peak_memory(pids[name]))
            time.sleep(0.005)
        done = run.finish()
    bus.close()
    return done.returncode, done.stderr, bus.sent, memory


def states(folder, types):
    out = {}
    for channel, data in lab.events(folder / "run" / "log.lcm"):
        if channel == "ROBOT_STATE":
            state = types.robot_state_t.decode(data)
            out[state.step] = state.q
    return out


def held(folder, types):
    return sum(types.event_t.decode(data).what == "holding" for channel, data in lab.events(folder / "run" / "log.lcm")
               if channel == "EVENT")


class Judge:
    """Quiet runs of both clocks, and what an attacked one is compared with."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.types = lab.generated_types(self.folder)
        define(self.types)
        self.forged = forged(self.types)
        self.quiet = {}

    def quiet_run(self, clock):
        if clock not in self.quiet:
            folder = pathlib.Path(tempfile.mkdtemp(prefix=f"quiet_{clock}.", dir=self.folder))
            code, err, _, memory = attacked_run(folder, clock, None, 0, self.forged)
            assert code == 0, err
            self.quiet[clock] = ((folder / "run" / "log.lcm").read_bytes() if clock == "lockstep" else states(folder, self.types), memory)
        return self.quiet[clock]

    def attack(self, name, clock, seed):
        """What was affected, in words; empty when nothing was."""
        log, quiet_memory = self.quiet_run(clock)
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.folder))
        code, err, sent, memory = attacked_run(folder, clock, ATTACKS[name], seed, self.forged)
        faults = []
        if code != 0:
            faults.append(f"exit {code}: {err.strip().splitlines()[-1:]}")
        elif clock == "lockstep":
            if (folder / "run" / "log.lcm").read_bytes() != log:
                faults.append("another log")
        else:
            q = states(folder, self.types)
            off = max(abs(a - b) for step in q.keys() & log.keys() if step >= SETTLED for a, b in zip(q[step], log[step]))
            if off > 1e-3:
                faults.append(f"{off:.3g} rad off")
            if times := held(folder, self.types):
                faults.append(f"held {times} times")
        if sent < 50:
            faults.append(f"only {sent} packets were sent")
        faults += [f"{process} grew by {(size - quiet_memory[process]) >> 20} MB" for process, size in memory.items()
                   if size - quiet_memory.get(process, size) > MEMORY]
        return ", ".join(faults)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*")
    parser.add_argument("--all", action="store_true", help="every attack")
    parser.add_argument("--clock", choices=DURATION, action="append", help="default: both")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("-o", dest="folder", help="keep the runs here")
    options = parser.parse_args()
    folder = options.folder or tempfile.mkdtemp(prefix="attacks.")
    os.makedirs(folder, exist_ok=True)
    judge = Judge(folder)
    names = list(ATTACKS) if options.all else options.names
    if unknown := [name for name in names if name not in ATTACKS]:
        parser.error(f"no attack '{unknown[0]}'; there are: {'; '.join(ATTACKS)}")
    results = {}
    for clock in options.clock or list(DURATION):
        for name in names:
            results[f"{clock}: {name}"] = fault = judge.attack(name, clock, options.seed)
            if not options.json:
                print(f"{'unaffected' if not fault else 'AFFECTED':10} {clock:9} {name}{': ' + fault if fault else ''}", flush=True)
    bad = sum(bool(fault) for fault in results.values())
    print(json.dumps(results, indent=2) if options.json else f"{len(results) - bad} of {len(results)} unaffected")
    if not options.folder:
        subprocess.run(["rm", "-rf", folder], check=False)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())

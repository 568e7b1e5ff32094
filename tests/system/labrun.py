"""Runs of the lab for the system tests: start one, wait for evidence with a deadline, read what it left.

Every run goes through scripts/lab run, so it has its own bus and its processes die with it.
"""
import importlib
import os
import pathlib
import socket
import struct
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("LAB_BUILD", ROOT / "build" / "release"))
LAB = str(ROOT / "scripts" / "lab")
ISOLATE = str(ROOT / "scripts" / "isolate")
DEADLINE = float(os.environ.get("LAB_TEST_DEADLINE", 90))  # s, for anything that is waited for

MOTION = """
robot: {{model: "{root}/models/simple_3dof_arm.urdf", armature: 0.2}}
simulator: {{dt: {dt}, duration: {duration}}}
planner: {{kind: sinusoid, amplitude: 0.4}}
controller: {{kind: computed_torque, kp: 100, kd: 20}}
renderer: {{enabled: false}}
"""


def experiment(folder, dt=0.005, duration=2.0):
    """A short motion of the sample arm, without pictures. Returns the file."""
    path = pathlib.Path(folder) / "motion.yaml"
    path.write_text(MOTION.format(root=ROOT, dt=dt, duration=duration))
    return str(path)


LIVE = """
robot: {{model: "{root}/models/simple_3dof_arm.urdf", armature: 0.2}}
simulator: {{dt: 0.005, duration: 600, clock: realtime}}
planner: {{kind: sinusoid, amplitude: 0.4}}
controller: {{kind: pd, kp: 100, kd: 20}}
safety: {{timeout: 0.5}}
renderer: {{enabled: false}}
"""


def live_experiment(folder):
    """The arm in motion for minutes, in real time. Returns the file."""
    path = pathlib.Path(folder) / "live.yaml"
    path.write_text(LIVE.format(root=ROOT))
    return str(path)


def environment(**extra):
    return {**os.environ, "LAB_BUILD": str(BUILD), **extra}


def run(file, folder, *options, before=(), **extra):
    """One whole run. `before` is a command line that runs it, such as isolate with a firewall."""
    return subprocess.run([*before, LAB, "run", file, "-o", str(folder), *options], env=environment(**extra),
                          capture_output=True, text=True, timeout=DEADLINE, stdin=subprocess.DEVNULL)


def solo(file, folder, *options):
    """The log of the same experiment in one process."""
    done = run(file, folder, "--solo", *options)
    assert done.returncode == 0, done.stderr
    return (pathlib.Path(folder) / "log.lcm").read_bytes()


def until(condition, what, deadline=DEADLINE):
    """Polls until the condition gives something; fails with `what` after the deadline."""
    end = time.monotonic() + deadline
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        os.sched_yield()
        time.sleep(0.01)  # the pace of polling, not a guess of how long things take
    raise AssertionError(f"{what}: not within {deadline} s")


class Running:
    """A run in the background; ended with the `with` block, whatever happens."""

    def __init__(self, file, folder, *options, **extra):
        self.folder = pathlib.Path(folder)
        self.process = subprocess.Popen([LAB, "run", file, "-o", str(folder), *options], env=environment(**extra),
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                        stdin=subprocess.DEVNULL)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()

    def finish(self):
        out, err = self.process.communicate(timeout=DEADLINE)
        return subprocess.CompletedProcess(self.process.args, self.process.returncode, out, err)

    def pid(self, name):
        """The pid of lab-NAME of this run, once it is there."""
        def look():
            for entry in pathlib.Path("/proc").iterdir():
                if not entry.name.isdigit():
                    continue
                try:
                    words = (entry / "cmdline").read_bytes().split(b"\0")
                except OSError:
                    continue
                if words[0].endswith(f"lab-{name}".encode()) and any(str(self.folder).encode() in w for w in words):
                    return int(entry.name)
            return None
        return until(look, f"no process lab-{name}")

    def step(self):
        """The newest whole step in the log that is being written; -1 before the first."""
        for name in ("log.lcm", "log.lcm.part"):
            path = self.folder / name
            if path.exists():
                return max((header(data)[2] for channel, data in events(path) if channel == "ROBOT_STATE"), default=-1)
        return -1

    def wait_for_step(self, step):
        return until(lambda: self.step() >= step, f"step {step}")


def events(path):
    """(channel, data) of each whole event of an LCM log."""
    raw = pathlib.Path(path).read_bytes()
    at = 0
    while at + 28 <= len(raw):
        magic, _, _, channel_size, data_size = struct.unpack_from(">IqqII", raw, at)
        assert magic == 0xEDA1DA01, f"no event at byte {at} of {path}"
        if at + 28 + channel_size + data_size > len(raw):
            return
        channel = raw[at + 28:at + 28 + channel_size].decode()
        yield channel, raw[at + 28 + channel_size:at + 28 + channel_size + data_size]
        at += 28 + channel_size + data_size


def header(data):
    """utime, run, step"""
    return struct.unpack_from(">qqq", data, 8)


def generated_types(folder):
    """The messages as lcm-gen's Python classes (they need no LCM)."""
    sources = sorted(str(p) for p in (ROOT / "lcmtypes").glob("*.lcm"))
    subprocess.run(["lcm-gen", "-p", "--ppath", str(folder), *sources], check=True)
    sys.path.insert(0, str(folder))
    for name in [m for m in sys.modules if m == "lab" or m.startswith("lab.")]:
        del sys.modules[name]
    try:
        return importlib.import_module("lab")
    finally:
        sys.path.pop(0)


def telemetry(folder, types):
    """PROCESS messages so far, in order."""
    for name in ("telemetry.lcm", "telemetry.lcm.part"):
        path = pathlib.Path(folder) / name
        if path.exists():
            return [types.process_t.decode(data) for channel, data in events(path) if channel == "PROCESS"]
    return []


def call(runs, *words):
    """A verb of the labs in the folder `runs`."""
    return subprocess.run([LAB, *words], env=environment(LAB_RUNS=str(runs)), capture_output=True, text=True,
                          timeout=DEADLINE, stdin=subprocess.DEVNULL)


def ok(done):
    assert done.returncode == 0, done.stderr
    return done.stdout


def state(folder):
    """Processes by name, as the supervisor sees them: status, pid, restarts."""
    found = {}
    for line in (pathlib.Path(folder) / "processes" / "state").read_text().splitlines():
        words = line.split()
        if words[0] == "process":
            found[words[1]] = (words[2], int(words[3]), int(words[5]))
    return found


def bus_of(folder):
    """The URL of a lab's bus."""
    return (pathlib.Path(folder) / "processes" / "state").read_text().split("\nurl ")[1].split()[0]


def memory(pid):
    """Bytes of a process in RAM."""
    return int(pathlib.Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def leftovers(folder):
    """Processes whose command line or working folder names the folder."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit() or int(entry.name) == os.getpid():
            continue
        try:
            line = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
        except OSError:
            continue
        if str(folder) in line:
            found.append(line)
    return found


class Bus:
    """Plain LCM over UDP on this host, in few lines: what a program without our libraries sends and hears."""
    GROUP = "239.255.76.67"

    def __init__(self, port=7667, timeout=0.2):
        self.port, self.sequence = port, 0
        self.out, self.reader = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
        self.out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        self.out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
        for option in (socket.SO_REUSEADDR, socket.SO_REUSEPORT):
            self.reader.setsockopt(socket.SOL_SOCKET, option, 1)
        self.reader.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        self.reader.bind((self.GROUP, port))
        self.reader.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(self.GROUP) + socket.inet_aton("127.0.0.1"))
        self.reader.settimeout(timeout)

    def send(self, channel, data):
        self.sequence += 1
        self.out.sendto(struct.pack(">II", 0x4C433032, self.sequence) + channel.encode() + b"\0" + data, (self.GROUP, self.port))

    def receive(self):
        """(channel, data) of the next message that is one packet; None when there was none for the time-out."""
        try:
            packet = self.reader.recv(65536)
        except socket.timeout:
            return None
        channel, _, data = packet[8:].partition(b"\0")
        return channel.decode(errors="replace"), data


def request(types, sender, number, verb, run=0, **action):
    """The bytes of a REQUEST; action: target, key, text, values."""
    message = types.request_t()
    message.utime, message.run, message.step, message.sender, message.id = int(time.time() * 1e6), run, -1, sender, number
    message.action.verb = verb
    for name, value in action.items():
        setattr(message.action, name, value)
    message.action.n = len(message.action.values)
    return message.encode()


def robots_are_here():
    """True when scripts/lab robots has fetched the real robots."""
    done = subprocess.run([LAB, "robots", "--path"], env=environment(), capture_output=True, text=True)
    return done.returncode == 0

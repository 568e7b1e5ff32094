#!/usr/bin/env python3
"""lab bench live: how fast a live lab answers, and what many requests cost it

usage: lab bench live [--estops N] [--flood N] [--requests N] [--seconds S] [--json]

  --estops N     emergency stops of each round (200); the time from sending one to hearing its EVENT
  --flood N      packets a second of a stranger's COMMANDs in the second round (10000)
  --requests N   requests in the last round (5000)
  --seconds S    .. spread over this time (30)
  --json         one JSON object instead of lines

Starts a lab at 1 kHz in a network of its own. The times include this program's own, some tens of us. As root the simulator
has SCHED_FIFO. Use a quiet machine.

example: lab bench live --estops 1000
"""
import argparse
import json
import multiprocessing
import os
import pathlib
import queue
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "system"))
import labrun as lab  # noqa: E402


class Bus:
    """Sends requests, and hears EVENT, REPLY and PROCESS with the time of each."""

    def __init__(self, types):
        self.types, self.id, self.over, self.udp = types, 0, False, lab.Bus()
        self.events, self.process, self.replies = queue.Queue(), None, 0
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        while not self.over:
            message = self.udp.receive()
            heard = time.perf_counter()
            if message is None:
                continue
            channel, data = message
            if channel == "EVENT":
                self.events.put((self.types.event_t.decode(data).what, heard))
            elif channel == "REPLY":
                self.replies += 1
            elif channel == "PROCESS":
                process = self.types.process_t.decode(data)
                if process.name == "simulator":
                    self.process = process

    def request(self, verb, **action):
        self.id += 1
        data = lab.request(self.types, f"bench:{os.getpid()}", self.id, verb, **action)
        sent = time.perf_counter()
        self.udp.send("REQUEST", data)
        return sent

    def wait_for(self, what):
        """When that event was heard."""
        end = time.monotonic() + 10
        while time.monotonic() < end:
            try:
                seen, heard = self.events.get(timeout=0.5)
            except queue.Empty:
                continue
            if seen == what:
                return heard
        sys.exit(f"lab bench live: no EVENT '{what}' in 10 s")


def flood(rate, sent):
    """COMMANDs of a stranger, a hundred at a time, until it is ended."""
    bus, n = lab.Bus(), 0
    next_burst = time.monotonic()
    while True:
        for _ in range(100):
            n += 1
            bus.send("COMMAND", bytes(200))
        sent.value = n
        next_burst += 100 / rate
        time.sleep(max(0, next_burst - time.monotonic()))


def quantiles(seconds):
    ordered = sorted(1e3 * s for s in seconds)
    return {"p50": ordered[len(ordered) // 2], "p99": ordered[len(ordered) * 99 // 100], "max": ordered[-1]}


def estops(bus, count):
    """ms from each request to its event."""
    found = []
    for _ in range(count):
        sent = bus.request("estop")
        found.append(bus.wait_for("estop") - sent)
        bus.request("rearm")
        bus.wait_for("running")
    return quantiles(found)


def many_requests(bus, count, seconds):
    """Live gains, evenly in time: what they cost the simulator. Windows with requests and windows without take turns."""
    lab.until(lambda: bus.process, "PROCESS of the simulator")
    begin, replies, windows = bus.process, bus.replies, 5
    size = lab.memory(begin.pid)
    overruns = {True: 0, False: 0}
    for window in range(2 * windows):
        asked, before, start = window % 2 == 0, bus.process, time.monotonic()
        for i in range(count // windows if asked else 0):
            bus.request("set", target="controller", key="kp", values=[80 + i % 40])
            time.sleep(max(0, start + (i + 1) * seconds / count - time.monotonic()))
        time.sleep(max(0.3, start + seconds / windows + 0.3 - time.monotonic()))  # PROCESS comes ten times a second
        overruns[asked] += bus.process.overruns - before.overruns
    return {"requests": count // windows * windows, "replies": bus.replies - replies, "overruns": overruns[True],
            "overruns_without": overruns[False], "lateness_p99_us": bus.process.lateness_p99,
            "memory_growth_bytes": lab.memory(begin.pid) - size}


def measure(options, runs):
    def call(*words):
        done = lab.call(runs, *words)
        if done.returncode:
            sys.exit(f"lab bench live: lab {words[0]}: {done.stderr.strip()}")
    call("up", "-d", "--set", "safety.timeout=0.1")
    try:
        call("wait", "--ready")
        bus = Bus(lab.generated_types(runs / "types"))
        result = {"estop_ms": estops(bus, options.estops)}
        sent = multiprocessing.Value("q", 0)
        stranger = multiprocessing.Process(target=flood, args=(options.flood, sent), daemon=True)
        stranger.start()
        begin = time.monotonic()
        result["estop_flooded_ms"] = estops(bus, options.estops)
        result["flood_per_s"] = round(sent.value / (time.monotonic() - begin))
        stranger.terminate()
        result["many"] = many_requests(bus, options.requests, options.seconds)
        bus.over = True
        return result
    finally:
        call("down")


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1].split("\n")[0], description=__doc__.split("\n\n")[0])
    parser.add_argument("--estops", type=int, default=200, help="emergency stops of each round")
    parser.add_argument("--flood", type=float, default=10000, help="packets a second")
    parser.add_argument("--requests", type=int, default=5000)
    parser.add_argument("--seconds", type=float, default=30)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if "LAB_PRIVATE_NETNS" not in os.environ:
        netns = str(ROOT / "tests" / "support" / "netns.sh")
        return subprocess.call([netns, sys.executable, __file__, *sys.argv[1:]])
    with tempfile.TemporaryDirectory() as folder:
        result = measure(options, pathlib.Path(folder))
    if options.json:
        print(json.dumps(result))
        return 0
    for key, what in (("estop_ms", "quiet"), ("estop_flooded_ms", f"under {result['flood_per_s']} packets/s")):
        print(f"estop, {what}: p50 {result[key]['p50']:.2f} ms, p99 {result[key]['p99']:.2f} ms, max {result[key]['max']:.2f} ms")
    print("{requests} requests: {replies} replies, {overruns} overruns ({overruns_without} in the same time without), "
          "lateness p99 {lateness_p99_us:.0f} us, memory {memory_growth_bytes:+d} bytes"
          .format(**result["many"]))
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""The other side of the Python conformance test: python_lcm.py echo URL | python_lcm.py log FILE TYPES

echo: answers every message on PING with the same bytes on PONG, until one says b"stop".
log:  reads every event of FILE with Python `lcm`, decodes it with lcm-gen -p classes in TYPES, encodes it again and
      demands the same bytes; prints the number of events.
"""
import importlib
import sys

import lcm

CHANNELS = {"ROBOT_STATE": "robot_state_t", "RUN": "run_t", "INPUT": "input_t", "COMMAND": "command_t"}


def echo(url):
    bus = lcm.LCM(url)
    done = []

    def answer(_, data):
        bus.publish("PONG", data)
        if data == b"stop":
            done.append(True)

    bus.subscribe("PING", answer).set_queue_capacity(0)
    while not done:
        bus.handle()


def read_log(path, types):
    sys.path.insert(0, types)
    count = 0
    for event in lcm.EventLog(path, "r"):
        name = CHANNELS[event.channel]
        kind = getattr(importlib.import_module("lab." + name), name)
        assert kind.decode(event.data).encode() == event.data, f"event {event.eventnum} on {event.channel}"
        count += 1
    print(count)


if sys.argv[1] == "echo":
    echo(sys.argv[2])
else:
    read_log(sys.argv[2], sys.argv[3])

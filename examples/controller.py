#!/usr/bin/env python3
"""A controller of one's own, in Python: PD towards the reference, in lockstep and in real time.

It needs the package `lcm` (PyPI) and the messages as Python:

    lcm-gen -p --ppath types lcmtypes/*.lcm

One line puts it in the controller's place, in an experiment or a Procfile; the numbers are kp and kd:

    processes: {controller: "env PYTHONPATH=types python3 examples/controller.py 100 20"}

What a controller must do (docs/extend.md): take RUN; say PROCESS some ten times a second, with the launch's nonce; and
answer every ROBOT_STATE, once it has the REFERENCE of the same step, with the COMMAND for it - the same bytes again when
the state comes again. The law is `effort`; the rest can stay as it is.
"""
import os
import sys
import time

import lcm
from lab import command_t, need_t, process_t, reference_t, robot_state_t, run_t

KP, KD = map(float, sys.argv[1:3]) if len(sys.argv) > 2 else (100.0, 20.0)


def effort(state, reference):
    """tau = kp e + kd e', one number per joint (of one degree of freedom each) in model order."""
    return [KP * (q_ref - q) + KD * (v_ref - v)
            for q_ref, q, v_ref, v in zip(reference.q, state.q, reference.v, state.v)]


class Controller:
    def __init__(self):
        self.bus = lcm.LCM(os.environ["LCM_DEFAULT_URL"])
        self.run = None
        self.references = {}  # by step, the last few
        self.state = None     # waits for its reference
        self.answers = {}     # by step: sent again when the simulator repeats a state
        for channel, handler in [("RUN", self.on_run), ("REFERENCE", self.on_reference), ("ROBOT_STATE", self.on_state)]:
            self.bus.subscribe(channel, handler).set_queue_capacity(0)

    def on_run(self, _, data):
        if self.run is None:
            self.run = run_t.decode(data)

    def on_reference(self, _, data):
        reference = reference_t.decode(data)
        if self.run and reference.run == self.run.run:
            self.references[reference.step] = reference
            self.references.pop(reference.step - 300, None)
            self.answer()

    def on_state(self, _, data):
        state = robot_state_t.decode(data)
        if self.run and state.run == self.run.run:
            self.state = state
            self.answer()

    def answer(self):
        if self.state is None or self.state.step not in self.references:
            return
        state, reference = self.state, self.references[self.state.step]
        if state.step not in self.answers:
            command = command_t()
            command.utime, command.run, command.step = state.utime, state.run, state.step
            command.state_step, command.reference_step, command.input_seq = state.step, reference.step, state.input_seq
            command.tau = effort(state, reference)
            command.nv = len(command.tau)
            self.answers[state.step] = command.encode()
            self.answers.pop(state.step - 2, None)
        self.bus.publish("COMMAND", self.answers[state.step])
        self.state = None

    def say(self):
        process = process_t()
        process.utime, process.name, process.pid = int(time.time() * 1e6), "controller", os.getpid()
        process.state, process.nonce = "STARTING", int(os.environ.get("LAB_LAUNCH", 0))
        if self.run:
            process.run, process.model_hash, process.state = self.run.run, self.run.model_hash, "RUNNING" if self.answers else "READY"
            process.step = max(self.answers, default=-1)
        self.bus.publish("PROCESS", process.encode())
        if not self.run:
            need = need_t()
            need.step, need.process, need.sender = -1, "simulator", "controller"
            self.bus.publish("NEED", need.encode())

    def serve(self):
        said = 0.0
        while True:
            if time.monotonic() - said > 0.05:
                said = time.monotonic()
                self.say()
            self.bus.handle_timeout(50)


if __name__ == "__main__":
    try:
        Controller().serve()
    except KeyboardInterrupt:
        pass

#!/usr/bin/env python3
"""same_run.py sees every difference but the wording that it is to leave out: logs made by hand."""
import contextlib
import io
import os
import struct
import sys
import tempfile
import unittest
from unittest import mock

import same_run

FINGERPRINT = b"12345678"
STATE = """package lab;
struct robot_state_t {  // %s
  int64_t utime; int64_t run; int64_t step;
  int32_t nq;
  double q[nq];  /* rad */
  int64_t digest;
}"""
EVENT = "struct event_t { int64_t utime; int64_t run; int64_t step; string what; string why; }"
NESTED = "struct pair_t { float xy[2]; } struct input_t { int64_t utime; int64_t run; int64_t step; int8_t n; pair_t pairs[n][1]; }"


def text(words):
    return struct.pack(">i", len(words) + 1) + words.encode() + b"\0"


def head(step):
    return FINGERPRINT + struct.pack(">qqq", 1000 * step, 7, step)


def type_message(name, source, channel):
    return "TYPE", head(-1) + text("lab." + name) + struct.pack(">q", 9) + text(source) + struct.pack(">i", 1) + text(channel)


def log(comment="state", q=(0.5, 1.5), digest=1, what="clamped", why="too much", y=2.0, run="name: a\nseed: 0\n", tail=()):
    return [("RUN", FINGERPRINT + text(run)),
            type_message("robot_state_t", STATE % comment, "ROBOT_STATE"),
            type_message("event_t", EVENT, "EVENT"),
            type_message("input_t", NESTED, "INPUT"),
            ("INPUT", head(0) + struct.pack(">bff", 1, 1.0, y)),
            ("ROBOT_STATE", head(0) + struct.pack(">i", len(q)) + struct.pack(f">{len(q)}d", *q) + struct.pack(">q", digest)),
            ("EVENT", head(0) + text(what) + text(why)), *tail]


class SameRun(unittest.TestCase):
    def write(self, name, messages):
        path = os.path.join(self.folder.name, name)
        with open(path, "wb") as f:
            for number, (channel, data) in enumerate(messages):
                f.write(struct.pack(">Iqqii", 0xEDA1DA01, number, 0, len(channel), len(data)) + channel.encode() + data)
        return path

    def compare(self, a, b):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()) as out, \
                contextlib.redirect_stderr(io.StringIO()):
            self.folder = mock.Mock()
            self.folder.name = folder
            with mock.patch.object(sys, "argv", ["same_run", self.write("a", a), self.write("b", b)]):
                return same_run.main(), out.getvalue()

    def test_wording_and_its_digests_are_left_out(self):
        self.assertEqual(self.compare(log(), log()), (0, ""))
        self.assertEqual(self.compare(log(), log(comment="the robot", digest=2, why="over the limit")), (0, ""))

    def test_everything_else_counts(self):
        for change, expected in [({"q": (0.5, 1.5000000000000002)}, "event 5 ROBOT_STATE q[1]: '1.5 (3ff8000000000000)'"),
                                 ({"q": (-0.0, 1.5)}, "event 5 ROBOT_STATE q[0]"),
                                 ({"q": (0.5,)}, "event 5 ROBOT_STATE nq: 2 != 1"),
                                 ({"what": "halted"}, "event 6 EVENT what: 'clamped' != 'halted'"),
                                 ({"y": 3.0}, "event 4 INPUT pairs[0][0].xy[1]"),
                                 ({"run": "name: a\nseed: 1\n"}, "event 0 RUN data"),
                                 ({"tail": [("END", FINGERPRINT)]}, "7 events against 8")]:
            code, out = self.compare(log(), log(**change))
            self.assertEqual(code, 1, change)
            self.assertIn(expected, out)

    def test_what_is_no_log(self):
        self.assertEqual(self.compare(log(), log()[:1] + [("TYPE", b"short")])[0], 2)


if __name__ == "__main__":
    unittest.main()

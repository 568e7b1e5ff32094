#!/usr/bin/env python3
"""Two logs tell the same run: equal but for the wording that a release may change.

usage: same_run.py A/log.lcm B/log.lcm

Compares all messages in order, except TYPE's `source`, EVENT's `why` and the digests that follow from them
(ROBOT_STATE and END). Messages are decoded with the types that the log itself carries. Prints the first differences.
Exit code: 0 the same, 1 different, 2 not a log.
"""
import re
import struct
import sys

IGNORED = {"type_t": {"source"}, "event_t": {"why"}, "robot_state_t": {"digest"}, "end_t": {"digest", "check"}}
PRIMITIVES = {"boolean": "b", "byte": "B", "int8_t": "b", "int16_t": "h", "int32_t": "i", "int64_t": "q", "float": "f",
              "double": "d"}
SYNC = 0xEDA1DA01
SHOWN = 10


class Damaged(Exception):
    pass


def events(path):
    """(number, timestamp, channel, data) of each event."""
    with open(path, "rb") as f:
        log = f.read()
    at = 0
    while at < len(log):
        if at + 28 > len(log):
            raise Damaged(f"{path}: cut off at byte {at}")
        sync, number, time, channel, data = struct.unpack_from(">Iqqii", log, at)
        end = at + 28 + channel + data
        if sync != SYNC or channel < 0 or data < 0 or end > len(log):
            raise Damaged(f"{path}: no event at byte {at}")
        yield number, time, log[at + 28:at + 28 + channel].decode(), log[at + 28 + channel:end]
        at = end


def members(source):
    """name -> [(type, name, dimensions)] of each struct of an .lcm text."""
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", source, flags=re.S)
    structs = {}
    for name, body in re.findall(r"struct\s+(\w+)\s*\{(.*?)\}", text, re.S):
        structs[name] = [(kind.split(".")[-1], member, re.findall(r"\[\s*(\w+)\s*\]", dimensions))
                         for kind, member, dimensions in re.findall(r"([\w.]+)\s+(\w+)((?:\s*\[\s*\w+\s*\])*)\s*;", body)
                         if kind != "const"]
    return structs


class Reader:
    def __init__(self, data, structs):
        self.data, self.at, self.structs = data, 8, structs  # 8: the fingerprint, compared apart

    def one(self, kind):
        if kind in PRIMITIVES:
            value, = struct.unpack_from(">" + PRIMITIVES[kind], self.data, self.at)
            size = struct.calcsize(PRIMITIVES[kind])
            bits = self.data[self.at:self.at + size]
            self.at += size
            # floats are compared by their bits
            return f"{value!r} ({bits.hex()})" if kind in ("float", "double") else value
        if kind == "string":
            length = self.one("int32_t")
            self.at += length
            return self.data[self.at - length:self.at - 1].decode(errors="backslashreplace")
        return self.message(kind)

    def array(self, kind, sizes):
        return [self.array(kind, sizes[1:]) for _ in range(sizes[0])] if sizes else self.one(kind)

    def message(self, kind):
        values = {}
        for member_kind, name, dimensions in self.structs[kind]:
            values[name] = self.array(member_kind, [int(d) if d.isdigit() else values[d] for d in dimensions])
        return values


# by which the other types are read
TYPE = members("""struct type_t {
  int64_t utime; int64_t run; int64_t step; string name; int64_t fingerprint; string source;
  int32_t nchannels; string channels[nchannels];
}""")


def read(path):
    """Each event as (number, timestamp, channel, fingerprint, values)."""
    log = list(events(path))
    structs, types = dict(TYPE), {"TYPE": "type_t"}
    for _, _, channel, data in log:
        if channel == "TYPE":
            known = Reader(data, TYPE).message("type_t")
            structs.update(members(known["source"]))
            types.update({carried: known["name"].split(".")[-1] for carried in known["channels"]})
    for number, time, channel, data in log:
        kind = types.get(channel)
        values = Reader(data, structs).message(kind) if kind else {"data": data[8:].hex()}
        for name in IGNORED.get(kind, ()):
            values.pop(name, None)
        yield number, time, channel, data[:8].hex(), values


def differences(a, b, path=""):
    if isinstance(a, dict) and isinstance(b, dict):
        for name in list(a) + [name for name in b if name not in a]:
            yield from differences(a.get(name), b.get(name), f"{path}.{name}")
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for i, (x, y) in enumerate(zip(a, b)):
            yield from differences(x, y, f"{path}[{i}]")
    elif isinstance(a, str) and isinstance(b, str) and "\n" in a + b:
        yield from differences(a.splitlines(), b.splitlines(), path)
    elif a != b:
        yield f"{path}: {a!r} != {b!r}"


def main():
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        logs = [list(read(path)) for path in sys.argv[1:]]
    except (OSError, Damaged, struct.error, KeyError, IndexError) as problem:
        print(f"same_run: {problem}", file=sys.stderr)
        return 2
    found = 0
    for a, b in zip(*logs):
        values_a, values_b = ({"number": e[0], "timestamp": e[1], "channel": e[2], "fingerprint": e[3], **e[4]} for e in (a, b))
        for text in differences(values_a, values_b):
            found += 1
            if found <= SHOWN:
                print(f"event {a[0]} {a[2]} {text[1:]}")
    if len(logs[0]) != len(logs[1]):
        found += 1
        print(f"{len(logs[0])} events against {len(logs[1])}")
    if found > SHOWN:
        print(f".. {found} differences")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

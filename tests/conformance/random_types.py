#!/usr/bin/env python3
"""Random .lcm type trees and messages as lcm-gen sees them: random_types.py FOLDER SEED COUNT

Writes FOLDER/cases.jsonl, one tree a line: the sources, and for each type its fingerprint, and messages that
lcm-gen's Python code encoded, with their content. Needs lcm-gen and nothing but Python's standard library.
"""
import importlib
import json
import os
import random
import struct
import subprocess
import sys

INTS = {"int8_t": 8, "int16_t": 16, "int32_t": 32, "int64_t": 64}
WORDS = ["alpha", "b", "_c", "q", "Pose", "x1", "very_long_member_name_of_a_field", "n", "data", "utime"]
BLANKS = [" ", "  ", "\n", "\t", " /* a note */ ", " // one; line {\n", "\n/**\n * doc\n */\n"]


class Tree:
    """Some packages of structs that use each other."""

    def __init__(self, rng, number):
        self.rng = rng
        self.types = []  # {"name", "fields": [{"name", "type", "dims"}]}
        self.files = []
        packages = [f"t{number}", f"t{number}.sub", f"t{number}.sub.deep"][: rng.randint(1, 3)]
        for i in range(rng.randint(1, 3)):
            text = ""
            for package in rng.sample(packages, rng.randint(1, len(packages))):
                text += f"package{self.blank()}{package};\n"
                for _ in range(rng.randint(1, 3)):
                    text += self.struct(package)
            self.files.append((f"f{i}.lcm", text))

    def blank(self):
        return self.rng.choice(BLANKS) if self.rng.random() < 0.2 else " "

    def struct(self, package):
        rng = self.rng
        me = {"name": f"{package}.s{len(self.types)}_t", "fields": []}
        text = f"struct{self.blank()}{me['name'].rsplit('.', 1)[1]}{self.blank()}{{\n"
        for i in range(rng.randint(0, 7)):
            if rng.random() < 0.1:
                text += f"  const int16_t K{i} = {rng.randint(-99, 99)}, L{i} = 0x{i:x};\n"
            kind = rng.choice(list(INTS) * 2 + ["byte", "float", "double", "double", "string", "boolean", "struct"])
            counts = [f["name"] for f in me["fields"] if f["type"] in INTS and not f["dims"]]
            dims = []
            for _ in range(rng.choice([0, 0, 0, 1, 1, 2, 3])):
                dims.append(rng.choice(counts) if counts and rng.random() < 0.6 else rng.choice(["1", "2", "0x3", "4"]))
            spelled = kind
            if kind == "struct":
                choices = [t["name"] for t in self.types]
                if any(d in counts for d in dims):
                    choices.append(me["name"])  # recursion must be able to end
                if not choices:
                    continue
                kind = rng.choice(choices)
                spelled = kind.rsplit(".", 1)[1] if kind.rsplit(".", 1)[0] == package and rng.random() < 0.5 else kind
            name = f"{rng.choice(WORDS)}{i}"
            me["fields"].append({"name": name, "type": kind, "dims": dims})
            text += f"  {spelled}{self.blank()}{name}" + "".join(f"[{d}]" for d in dims) + ";\n"
        self.types.append(me)
        return text + "}\n"

    def find(self, name):
        return next(t for t in self.types if t["name"] == name)

    def value(self, kind, depth):
        """A random value of a type, as JSON and as what the generated class wants."""
        rng = self.rng
        if kind in INTS:
            v = rng.choice([0, 1, -1, rng.getrandbits(INTS[kind] - 1), -(1 << (INTS[kind] - 1))])
        elif kind == "byte":
            v = rng.getrandbits(8)
        elif kind == "boolean":
            v = rng.random() < 0.5
        elif kind == "float":
            v = struct.unpack(">f", struct.pack(">f", rng.uniform(-1e6, 1e6)))[0]
        elif kind == "double":
            v = rng.choice([0.0, -0.0, 5e-324, 1.7e308, rng.uniform(-9, 9)])
        elif kind == "string":
            v = rng.choice(["", "x", "joint 1", "Grüße, 世界", "q" * 300])
        else:
            return self.message(self.find(kind), depth + 1)
        return v, v

    def message(self, kind, depth=0):
        package, short = kind["name"].rsplit(".", 1)
        out = getattr(importlib.import_module(f"{package}.{short}"), short)()
        content, counts = {}, {}
        used = {d for f in kind["fields"] for d in f["dims"]}
        for f in kind["fields"]:
            if f["name"] in used:
                counts[f["name"]] = 0 if depth > 2 else self.rng.choice([0, 1, 1, 2, 3])
                plain = real = counts[f["name"]]
            else:
                plain, real = self.array(f, 0, counts, depth)
            if f["dims"] and f["type"] == "byte":
                real = to_bytes(real)
            content[f["name"]] = plain
            setattr(out, f["name"], real)
        return content, out

    def array(self, f, dim, counts, depth):
        if dim == len(f["dims"]):
            return self.value(f["type"], depth)
        d = f["dims"][dim]
        n = counts[d] if d in counts else int(d, 0)
        both = [self.array(f, dim + 1, counts, depth) for _ in range(n)]
        return [b[0] for b in both], [b[1] for b in both]


def to_bytes(v):
    return bytes(v) if not v or isinstance(v[0], int) else [to_bytes(x) for x in v]


def main():
    folder, seed, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    os.makedirs(folder, exist_ok=True)
    sys.path.insert(0, folder)
    sys.dont_write_bytecode = True
    with open(os.path.join(folder, "cases.jsonl.part"), "w") as out:
        for i in range(count):
            rng = random.Random(seed * 1000 + i)
            tree = Tree(rng, i)
            paths = []
            for name, text in tree.files:
                paths.append(os.path.join(folder, f"t{i}_{name}"))
                with open(paths[-1], "w") as f:
                    f.write(text)
            subprocess.run(["lcm-gen", "-p", "--ppath", folder] + paths, check=True, stdout=subprocess.DEVNULL)
            importlib.invalidate_caches()
            cases = []
            for kind in tree.types:
                package, short = kind["name"].rsplit(".", 1)
                made = getattr(importlib.import_module(f"{package}.{short}"), short)
                messages = []
                for _ in range(3):
                    content, message = tree.message(kind)
                    messages.append({"hex": message.encode().hex(), "content": content})
                cases.append({"type": kind["name"], "fingerprint": made._get_packed_fingerprint().hex(), "messages": messages})
            line = {"sources": [{"file": f, "text": t} for f, t in tree.files], "cases": cases}
            out.write(json.dumps(line) + "\n")
    os.rename(os.path.join(folder, "cases.jsonl.part"), os.path.join(folder, "cases.jsonl"))


main()

#!/usr/bin/env python3
"""What our reader, Debian's urdfdom, MuJoCo and Pinocchio do with the URDF corpus, as docs/urdf_corpus.md.

usage: tests/oracle/run.sh --urdf-corpus      (builds what is needed, writes docs/urdf_corpus.md)
       urdf_corpus.py READER FILE             (one file; inside, so that a crash or a hang stays there)

Each file is read by each reader in a process of its own, with a time-out. A reader that accepts a file computes
inverse and forward dynamics with it (urdfdom computes nothing: its numbers are looked at).
"""
import json
import multiprocessing.pool
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
TIMEOUT = 20  # seconds; the slowest sound answer takes two
PEERS = ("urdfdom", "mujoco", "pin")


def read_pin(path):
    import numpy as np
    import pinocchio as pin

    model = pin.buildModelFromUrdf(path)
    data = model.createData()
    finite = True
    pin.seed(1)
    for k in range(3):
        q = pin.neutral(model)
        if k:
            q = pin.integrate(model, q, np.random.default_rng(k).uniform(-1, 1, model.nv))
        one = np.ones(model.nv)
        finite &= bool(np.isfinite(pin.rnea(model, data, q, k * one, one)).all())
        finite &= bool(np.isfinite(pin.aba(model, data, q, k * one, one)).all())
    return finite


def read_mujoco(path):
    import mujoco
    import numpy as np

    model = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(model)
    finite = True
    for k in range(3):
        data.qpos[:] = model.qpos0 + np.random.default_rng(k).uniform(-k, k, model.nq) / 2
        data.qvel[:] = k
        mujoco.mj_forward(model, data)
        finite &= bool(np.isfinite(data.qacc).all())
        mujoco.mj_inverse(model, data)
        finite &= bool(np.isfinite(data.qfrc_inverse).all())
    return finite


def read_here(reader, path):
    """Prints finite or nan; exit 1 when the reader refuses."""
    try:
        finite = {"pin": read_pin, "mujoco": read_mujoco}[reader](path)
    except Exception as error:  # noqa: BLE001: whatever it throws is a refusal
        print(error, file=sys.stderr)
        sys.exit(1)
    print("\n" + ("finite" if finite else "nan"))


def outcome_of(reader, path, urdfdom, scratch):
    """refused, told (accepted, but something was printed), accepted, nan, crash or hang."""
    command = [urdfdom, path] if reader == "urdfdom" else [sys.executable, __file__, reader, path]
    try:
        run = subprocess.run(command, capture_output=True, timeout=TIMEOUT, cwd=scratch, check=False)
    except subprocess.TimeoutExpired:
        return "hang"
    if run.returncode < 0:
        return "crash"
    if run.returncode != 0:
        return "refused"
    words = run.stdout.decode(errors="replace").split()
    if words[-1:] != ["finite"]:
        return "nan"
    return "told" if run.stderr.strip() or len(words) > 1 else "accepted"


def judge(wanted, outcome):
    """well, or what is wrong with it."""
    if outcome in ("crash", "hang", "nan"):
        return outcome
    if wanted.startswith("error"):
        return {"refused": "well", "told": "told", "accepted": "silent"}[outcome]
    if wanted.startswith("warning"):
        return "silent" if outcome == "accepted" else "well"
    return "refuses" if outcome == "refused" else "well"


MEANING = [
    ("well", "refuses what is wrong, says something where a look is due, takes what is sound"),
    ("told", "something wrong is accepted, with a message printed"),
    ("silent", "something wrong or doubtful is accepted without a word"),
    ("nan", "accepted, and a result is not a number"),
    ("refuses", "something sound is refused"),
    ("crash", "the process dies"),
    ("hang", f"no answer within {TIMEOUT} s"),
]


def cell(text):
    return text.replace("|", "\\|").replace("<", "&lt;").replace("$", "\\$")


def main(build):
    scratch = tempfile.mkdtemp(prefix="urdf_corpus_")
    run = subprocess.run([f"{build}/bin/urdf_corpus_write", f"{ROOT}/tests/core/urdf/corpus.txt", scratch],
                         capture_output=True, text=True, check=True)
    cases = [json.loads(line) for line in run.stdout.splitlines()]

    def ask(job):
        case, reader = job
        path = os.path.join(scratch, case["file"])
        case[reader] = outcome_of(reader, path, f"{build}/bin/urdfdom_read", scratch)

    with multiprocessing.pool.ThreadPool(2) as pool:
        pool.map(ask, [(case, reader) for case in cases for reader in PEERS], chunksize=1)
    subprocess.run(["rm", "-r", scratch], check=False)

    import importlib.metadata as metadata

    urdfdom = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", "liburdfdom-dev"], capture_output=True, text=True,
                             check=True).stdout.split("-")[0].split("+")[0]
    names = ["urdfdom " + urdfdom, "MuJoCo " + metadata.version("mujoco"),
             "Pinocchio " + metadata.version("pin")]
    readers = ["outcome", *PEERS]
    counts = {r: [judge(c["wanted"], c[r]) for c in cases] for r in readers}
    out = ["# The URDF corpus and what readers do with it", "",
           f"{len(cases)} malformed and odd files of `tests/core/urdf/corpus.txt`. Written by `tests/oracle/run.sh "
           "--urdf-corpus`; do not edit.", "",
           "| files handled | ours | " + " | ".join(names) + " |", "|---|---|---|---|---|"]
    for key, meaning in MEANING:
        row = [str(counts[r].count(key)) for r in readers]
        out.append(f"| **{key}**: {meaning} | " + " | ".join(row) + " |")
    out += ["", "Below: refused, told (accepted, and something printed), accepted (without a word), nan, crash, hang. Bold: "
            "not handled well.", "", "| file | ours | " + " | ".join(names) + " |", "|---|---|---|---|---|"]
    for k, case in enumerate(cases):
        row = []
        for r in readers:
            text = case[r] if counts[r][k] == "well" else f"**{case[r]}**"
            if r == "outcome" and case["wanted"] != "ok":
                text += ": " + cell(case["wanted"].split(": ", 1)[1])
            row.append(text)
        out.append(f"| {cell(case['name'])} | " + " | ".join(row) + " |")
    return "\n".join(out) + "\n"


if __name__ == "__main__":
    if len(sys.argv) == 3:
        read_here(sys.argv[1], sys.argv[2])
    elif len(sys.argv) == 2:
        print(main(sys.argv[1]), end="")
    else:
        sys.exit(__doc__)

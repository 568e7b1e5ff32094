"""Names that are not UTF-8, have control bytes, are empty or huge: every program shows them escaped, in text and JSON, and goes on.
ctest runs this in a private network."""
import json
import re
import subprocess
import threading
import time

import pytest

import labrun as lab

URL = "udpm://239.255.76.67:7667?ttl=0"
BIN = lab.BUILD / "bin"
NAMES = {b"Ger\xe4t": "Ger\\xe4t", b"a\x1b[2Jb": "a\\u001b[2Jb", b"": "''", b"n" * 300: "n" * 40 + ".." + "n" * 12 + " (300 bytes)",
         b"two\nlines": "two\\nlines", b"\xe2\x80\xaeabc": "\\u202eabc"}
ARM = (lab.ROOT / "models" / "simple_3dof_arm.urdf").read_bytes()
EXPERIMENT = """
robot: {model: arm.urdf, armature: 0.2}
simulator: {dt: 0.005, duration: 0.2}
planner: {kind: sinusoid, amplitude: 0.4}
controller: {kind: computed_torque, kp: 100, kd: 20}
renderer: {fps: 10, size: [64, 48]}
"""


def clean(data):
    """The text, which must be UTF-8 without control characters but line feeds."""
    text = data.decode("utf-8")
    assert not re.search("[\x00-\x09\x0b-\x1f\x7f-\x9f\u202a-\u202e]", text), text[:400]
    return text


def call(*words, code=0, cwd=None, stdin=b""):
    done = subprocess.run(list(map(str, words)), env=lab.environment(LCM_DEFAULT_URL=URL), cwd=cwd, input=stdin,
                          capture_output=True, timeout=lab.DEADLINE)
    assert done.returncode == code, (words, done.returncode, done.stderr.decode(errors="replace"))
    clean(done.stderr)
    return clean(done.stdout)


@pytest.fixture(scope="module")
def process(tmp_path_factory):
    """Makes the bytes of a PROCESS whose name is any bytes."""
    types = lab.generated_types(tmp_path_factory.mktemp("types"))

    def make(name, step):
        message = types.process_t()
        message.name, message.state, message.pid = "N" * len(name), "RUNNING", 7
        message.step, message.utime = step, int(time.time() * 1e6)
        return message.encode().replace(b"N" * len(name) + b"\0", name + b"\0", 1) if name else message.encode()
    return make


@pytest.fixture
def strangers(process):
    """While the test runs: PROCESS messages of all names, and channels that are called so."""
    bus, stop = lab.Bus(), threading.Event()

    def talk():
        step = 0
        while not stop.wait(0.01):
            step += 1
            for name in NAMES:
                bus.sequence += 1
                head = lab.struct.pack(">II", 0x4C433032, bus.sequence)
                bus.out.sendto(head + b"PROCESS\0" + process(name, step), (bus.GROUP, bus.port))
                if 0 < len(name) < 60:
                    bus.out.sendto(head + name + b"\0" + process(name, step), (bus.GROUP, bus.port))
    thread = threading.Thread(target=talk)
    thread.start()
    yield
    stop.set()
    thread.join()


def test_spy(strangers):
    for words in (("who", "--for", "0.3"), ("list", "--for", "0.3")):
        text = call(BIN / "lab-spy", *words)
        for name, shown in NAMES.items():
            if words[0] == "who" or 0 < len(name) < 60:
                assert re.search(f"^{re.escape(shown)} ", text, re.M), (words, shown, text)
    heard = {entry["name"] for entry in json.loads(call(BIN / "lab-spy", "who", "--for", "0.3", "--json"))}
    assert heard == {"Ger\\xe4t", "a\x1b[2Jb", "", "n" * 300, "two\nlines", "\u202eabc"}
    assert "Ger\\xe4t" in {entry["channel"] for entry in json.loads(call(BIN / "lab-spy", "list", "--for", "0.3", "--json"))}
    for line in call(BIN / "lab-spy", "echo", "*", "-n", "40", "--json").splitlines():
        json.loads(line)
    assert "Ger\\xe4t" in call(BIN / "lab-spy", "echo", "*", "-n", "40")
    assert r"Ger\\xe4t" in call(BIN / "lab-spy", "echo", "Ger*", "-n", "2", "--field", "pid", "--field", "name")


def test_ps_is_not_blinded(strangers, runs):
    lab.ok(lab.call(runs, "up", "cubic_pd", "-d", "--stay"))
    lab.ok(lab.call(runs, "wait", "--ready", "--timeout", "60"))
    [one] = json.loads(lab.ok(lab.call(runs, "ps", "--json")))
    states = {p["name"]: p["state"] for p in one["processes"]}
    assert states["simulator"] in ("RUNNING", "HOLDING") and states["logger"] == "RUNNING", states
    lab.ok(lab.call(runs, "down"))


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """An arm with a Latin-1 link and joint, another with control characters, and an experiment with the first."""
    folder = tmp_path_factory.mktemp("arm")
    joint, link = (re.findall(rb'<' + kind + rb' name="([^"]+)"', ARM)[1] for kind in (b"joint", b"link"))
    for name, new in (("arm", b"Ger\xe4t"), ("odd", b"a&#27;[2Jb&#10;c"), ("huge", b"n" * 5000)):
        text = ARM.replace(b'"' + joint + b'"', b'"' + new + b'_j"').replace(b'"' + link + b'"', b'"' + new + b'"')
        (folder / f"{name}.urdf").write_bytes(text)
    (folder / "x.yaml").write_text(EXPERIMENT)
    return folder


def test_robots(arm):
    for name, shown in (("arm", "Ger\\xe4t"), ("odd", "a\\u001b[2Jb\\nc"), ("huge", "n" * 40 + "..")):
        file = arm / f"{name}.urdf"
        for verb in ("info", "tree"):
            text = call(BIN / "lab-model", verb, file)
            assert shown in text and max(map(len, text.splitlines())) < 400, text[:400]
            json.loads(call(BIN / "lab-model", verb, file, "--json"))
        json.loads(call(BIN / "lab-model", "check", file, "--json", "--notes"))
        json.loads(call(BIN / "lab-model", "eval", file, stdin=b'{"states": [{"q": [0, 0, 0]}]}'))
        call(BIN / "lab-experiment", "check", arm / "x.yaml", "--set", f"robot.model={file}")


def test_a_run_of_a_robot_whose_links_are_latin_1(arm):
    for folder, options in (("solo", ["--solo"]), ("run", [])):
        assert "Ger\\xe4t" in call(lab.LAB, "run", arm / "x.yaml", "-o", arm / folder, *options)
        page = clean((arm / folder / "report.html").read_bytes())
        assert "Ger\\xe4t" in page
        assert any("Ger\\xe4t" in joint["name"] for joint in json.loads((arm / folder / "metrics.json").read_text())["joints"])
    assert (arm / "solo" / "log.lcm").read_bytes() == (arm / "run" / "log.lcm").read_bytes()
    call(BIN / "lab-experiment", "compare", arm / "solo", arm / "run", "-o", arm / "compare.html")
    clean((arm / "compare.html").read_bytes())
    call(BIN / "lab-renderer", arm / "solo", "--times", "0", "--size", "64x48", "-o", arm / "pictures")

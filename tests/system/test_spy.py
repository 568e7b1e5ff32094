"""lab-spy on a bus that is not ours: stock Python LCM publishes, the types are foreign. ctest runs this in a private network."""
import json
import os
import signal
import subprocess

import pytest

import labrun as lab

SPY = str(lab.BUILD / "bin" / "lab-spy")
PYTHON = lab.BUILD / "pyenv" / "bin" / "python3"
URL = "udpm://239.255.76.67:7667?ttl=0"
TYPES = """package geo;

struct point_t { double x; double y; }
struct pose_t {
  int64_t  seq;
  string   name;
  double   position[3];
  int32_t  n;
  float    ranges[n];
  point_t  corners[2];
  boolean  good;
}
struct stranger_t { int32_t whatever; }
"""
# sends everything a hundred times a second, on an absolute grid: POSE, a pose_t; STRANGE, a stranger_t; TYPE, when asked to,
# with the text of both; on PROCESS, one of the lab's and one that is none; and on BAD.. what a decoder may choke on
PUBLISHER = """
import struct, sys, time
sys.path[:0] = sys.argv[1:3]
import geo, lcm
from lab import process_t, type_t
bus, teach = lcm.LCM(%r), len(sys.argv) > 3
strange, hint = geo.stranger_t(), type_t()
hint.name, hint.source = "geo.pose_t", open(sys.argv[3]).read() if teach else ""
pose = geo.pose_t()
pose.name, pose.n, pose.ranges, pose.good = "münster", 2, [0.5, float("nan")], True
pose.corners = [geo.point_t(), geo.point_t()]
pose.corners[1].x = 7.25
life = process_t()
life.name, life.state, life.pid = "planner", "RUNNING", 7
began, k = time.monotonic(), 0
while True:
    k += 1
    pose.seq, pose.position = k, [k, -k, 0.125]
    data = pose.encode()
    count = len(geo.pose_t._get_packed_fingerprint()) + 8 + 4 + len("münster".encode()) + 1 + 24
    if teach: bus.publish("TYPE", hint.encode())
    bus.publish("POSE", data)
    bus.publish("STRANGE", strange.encode())
    life.step, life.utime = 3 * k, 10_000 * k
    bus.publish("PROCESS", life.encode())
    bus.publish("PROCESS", b"nobody")
    bus.publish("BAD_SHORT", data[:3])
    bus.publish("BAD_EMPTY", b"")
    bus.publish("BAD_CUT", data[:-1])
    bus.publish("BAD_LONG", data + b"x")
    bus.publish("BAD_HUGE", data[:count] + struct.pack(">i", 2_000_000_000) + data[count + 4:])
    bus.publish("BAD_NEGATIVE", data[:count] + struct.pack(">i", -5) + data[count + 4:])
    bus.publish("BAD_TEXT", b"\\x00\\xffhello")
    time.sleep(max(0, began + k * 0.01 - time.monotonic()))
""" % URL
BAD = ["BAD_SHORT", "BAD_EMPTY", "BAD_CUT", "BAD_LONG", "BAD_HUGE", "BAD_NEGATIVE", "BAD_TEXT"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    if not os.access(PYTHON, os.X_OK):
        pytest.skip("no Python with LCM here (tests/conformance/pyenv.sh)")
    folder = tmp_path_factory.mktemp("spy")
    (folder / "types" / "deep").mkdir(parents=True)
    (folder / "types" / "deep" / "geo.lcm").write_text(TYPES)
    subprocess.run(["lcm-gen", "-p", "--ppath", str(folder / "python"), str(folder / "types" / "deep" / "geo.lcm")], check=True)
    lab.generated_types(folder / "lab")
    (folder / "publish.py").write_text(PUBLISHER)
    return folder


@pytest.fixture(scope="module", params=["files", "TYPE messages"])
def bus(request, folder):
    """A publisher is there; gives the options with which a spy knows its types."""
    teach = [str(folder / "types" / "deep" / "geo.lcm")] if request.param == "TYPE messages" else []
    publisher = subprocess.Popen([str(PYTHON), str(folder / "publish.py"), str(folder / "python"), str(folder / "lab"), *teach])
    spy("echo", "POSE", "--once", "--timeout", "30")  # it has begun
    yield [] if teach else ["--types", str(folder / "types")]
    publisher.kill()
    publisher.wait()


def spy(*words, code=0):
    done = subprocess.run([SPY, *map(str, words), "-l", URL], capture_output=True, text=True, timeout=60)
    assert done.returncode == code, done.stderr
    return done.stdout if code == 0 else done.stderr


def messages(*words):
    return [json.loads(line) for line in spy(*words, "--json").splitlines()]


def known(*words):
    """Messages from the first on whose type is known: a TYPE message may come later than we."""
    return [m for m in messages(*words) if "error" not in m or not m["error"].startswith("unknown type")]


def test_list_counts_and_names(bus):
    there = {c["channel"]: c for c in json.loads(spy("list", "--for", "2", "--json", *bus))}
    pose = there["POSE"]
    assert pose["type"] == "geo.pose_t" and pose["senders"] == 1 and pose["lost"] == 0
    assert 80 < pose["hz"] < 120  # 100 on an absolute grid: late ones are made up for
    # two other roads to the same figure: the count over the time, and the periods' bounds
    assert abs(pose["count"] / 2 - pose["hz"]) < 0.2 * pose["hz"]
    assert pose["period_min_ms"] <= 1000 / pose["hz"] <= pose["period_max_ms"]
    assert abs(pose["bytes_per_s"] * 2 / pose["count"] - 98) < 5  # 8 + 8 + 4 + 8 + 1 + 24 + 4 + 8 + 32 + 1 = 98 bytes each
    assert there["STRANGE"]["type"] == "geo.stranger_t" and set(BAD) <= set(there)
    lines = spy("list", "--for", "0.5", *bus).splitlines()
    assert lines[0].split()[:4] == ["channel", "type", "count", "hz"] and any(line.split()[:2] == ["POSE", "geo.pose_t"] for line in lines)


def test_hz_of_a_pattern(bus):
    there = json.loads(spy("hz", "PO*", "--for", "0.5", "--json", *bus))
    assert [c["channel"] for c in there] == ["POSE"] and there[0]["count"] > 5


def test_echo_shows_the_whole_message(bus):
    [first, *_, last] = known("echo", "POSE", "-n", "8", *bus)
    assert last["type"] == "geo.pose_t" and last["size"] == 98
    m = last["message"]
    assert m["seq"] > first["message"]["seq"] and m["position"] == [m["seq"], -m["seq"], 0.125]
    assert m["name"] == "münster" and m["ranges"] == [0.5, None] and m["good"] is True
    assert m["corners"] == [{"x": 0, "y": 0}, {"x": 7.25, "y": 0}]
    text = spy("echo", "POSE", "-n", "8", *bus)
    assert "POSE (geo.pose_t, 98 bytes)" in text and 'name: "münster"' in text and "ranges: [0.5, nan]" in text and "x: 7.25" in text


def test_echo_of_fields(bus):
    if not bus:
        pytest.skip("the first messages may be of a type that is not known yet")
    values = [line.split() for line in spy("echo", "POSE", "--field", "position[1]", "--field", "corners[1].x", "-n", "3", *bus).splitlines()]
    assert len(values) == 3 and all(float(a) < 0 and float(b) == 7.25 for a, b in values)
    [one] = messages("echo", "POSE", "--field", "seq", "--once", *bus)
    assert list(one) == ["seq"]
    for wrong in ("speed", "position[3]", "ranges[2]", "corners[0].z"):
        assert f"has no '{wrong}'" in spy("echo", "POSE", "--field", wrong, "--once", *bus, code=2)


def test_who_knows_processes_and_how_fast_they_go(bus):
    [one] = json.loads(spy("who", "--for", "0.5", "--json"))
    assert (one["name"], one["pid"], one["state"]) == ("planner", 7, "RUNNING")
    assert abs(one["rate"] - 300) < 1e-6  # steps per second of its own clock
    lines = [line.split() for line in spy("who", "--for", "0.5").splitlines()]
    assert [line[0] for line in lines] == ["name", "planner"] and lines[0][-1] == "dropped"


def test_once_is_one(bus):
    assert len(messages("echo", "POSE", "--once", *bus)) == 1


def test_what_is_not_known_is_shown_as_that(folder, bus):
    if not bus:
        pytest.skip("all types are taught here")
    [seen] = messages("echo", "STRANGE", "--once")
    assert seen["error"].startswith("unknown type ? ") and len(seen["head"]) == 24
    assert seen["error"].split()[-1] == seen["head"][:16], "the fingerprint"
    assert "unknown type" in spy("echo", "STRANGE", "--once")


@pytest.mark.parametrize("channel", BAD)
def test_wrong_data_is_told_and_survived(bus, channel):
    seen = messages("echo", channel, "-n", "5", *bus)
    assert len(seen) == 5 and all("error" in m and "message" not in m for m in seen)
    if channel in ("BAD_HUGE", "BAD_NEGATIVE"):
        bad = [m for m in seen if not m["error"].startswith("unknown type")]
        assert bad and all("needs 8000000000 bytes" in m["error"] or "-5" in m["error"] for m in bad), seen


def test_types_that_cannot_be_used_are_a_warning_and_the_rest_is_used(folder, bus):
    if not bus:
        pytest.skip("the types come from the bus")
    broken = folder / "broken"
    broken.mkdir(exist_ok=True)
    (broken / "x.lcm").write_text("package x;\nstruct a_t { int32_t n; double v[m]; }\n")
    (broken / "y.lcm").write_text("package alike; struct stranger_t { int32_t whatever; }")  # as geo.stranger_t
    words = ["--types", "/nowhere", "--types", str(folder / "python"), "--types", str(broken), *bus]
    done = subprocess.run([SPY, "echo", "STRANGE", "--once", "--json", *words, "-l", URL], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["type"] == "alike.stranger_t|geo.stranger_t"
    assert done.stderr.splitlines() == [
        "lab-spy: warning: /nowhere: there is no such file or folder",
        f"lab-spy: warning: {folder}/python: there is no .lcm file in this folder",
        f"lab-spy: warning: {broken}/x.lcm:2: array size 'm' is neither a number nor a member or constant declared before"]
    there = {c["channel"]: c["type"] for c in json.loads(spy("list", "--for", "0.5", "--json", *words))}
    assert there["STRANGE"] == "alike.stranger_t|geo.stranger_t" and there["POSE"] == "geo.pose_t"


def test_wrong_use_is_one_line():
    assert spy("echo", "POSE", "-n", "0", code=2)


def test_silence_ends_with_124_and_ctrl_c_with_130(folder):
    assert "nothing on SILENT in 0.3 s" in spy("echo", "SILENT", "--once", "--timeout", "0.3", code=124)
    running = subprocess.Popen([SPY, "echo", "SILENT", "-l", URL], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    lab.until(lambda: any(c in open(f"/proc/{running.pid}/net/udp").read() for c in [":1DF3"]), "the spy to listen")  # port 7667
    running.send_signal(signal.SIGINT)
    assert running.wait(10) == 130

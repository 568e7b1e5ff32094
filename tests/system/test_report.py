"""report.html and compare: one file that needs nothing else, the same bytes again, and a line for what is missing."""
import html.parser
import json
import os
import re
import shutil
import subprocess

import pytest

import labrun as lab

VOID = {"meta", "img", "br"}


class Checker(html.parser.HTMLParser):
    """Every tag is closed in its turn; collects text, tags and what is fetched from somewhere."""

    def __init__(self, text):
        super().__init__()
        self.open, self.text, self.fetched, self.count = [], "", [], {}
        self.feed(text)
        self.close()
        assert not self.open, f"left open: {self.open}"

    def handle_starttag(self, tag, attributes):
        self.count[tag] = self.count.get(tag, 0) + 1
        self.fetched += [value for name, value in attributes if name in ("src", "href", "xlink:href", "data")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):  # in SVG
        self.handle_starttag(tag, attributes)
        self.open.pop()

    def handle_endtag(self, tag):
        if tag in VOID:
            return
        assert self.open and self.open[-1] == tag, f"</{tag}> closes {self.open[-3:]}"
        self.open.pop()
        if tag in ("td", "th", "tr"):
            self.text += " "

    def handle_data(self, data):
        self.text += data


def call(*words, **extra):
    return subprocess.run([lab.LAB, *map(str, words)], env=lab.environment(**extra), capture_output=True, text=True, timeout=120)


def checked(path):
    raw = path.read_text()
    assert len(raw) < 2_000_000
    assert "http" not in raw and "@import" not in raw and "url(" not in raw and "<script" not in raw
    page = Checker(raw)
    assert all(source.startswith("data:image/png;base64,") for source in page.fetched)
    return page


REACH = """
robot: {{model: "{root}/models/simple_3dof_arm.urdf", armature: 0.2}}
simulator: {{dt: 0.005, duration: 2}}
planner: {{kind: quintic, goal: [0.5, 0.4, -0.3], duration: 1}}
controller: {{kind: {kind}, kp: 100, kd: 20}}
renderer: {{enabled: false}}
expect: {{max_error: {{max: 0.5}}, reach_count: {{min: 1, max: 1}}}}
"""


def reach(folder, kind):
    path = folder / f"{kind}.yaml"
    path.write_text(REACH.format(root=lab.ROOT, kind=kind))
    return path


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A PD and a computed torque run, in solo; their folders."""
    folder = tmp_path_factory.mktemp("runs")
    for kind in ("pd", "computed_torque"):
        done = call("run", reach(folder, kind), "-o", folder / kind, "--solo")
        assert done.returncode == 0, done.stderr
    return folder


def test_run_makes_it_and_it_is_the_same_again(runs):
    page = runs / "pd" / "report.html"
    before = page.read_bytes()
    checker = checked(page)
    assert checker.count["svg"] > 10  # two per joint, error, tool, energy, legends
    done = call("report", runs / "pd")
    assert done.returncode == 0 and done.stdout == f"{page}\n" and done.stderr == ""
    assert page.read_bytes() == before
    assert not list((runs / "pd").glob("*.part"))


def test_it_says_what_the_metrics_say(runs):
    metrics = json.loads((runs / "pd" / "metrics.json").read_text())
    text = checked(runs / "pd" / "report.html").text
    assert "as expected" in text and "joint3_elbow" in text and "kind: quintic" in text
    for name in ("max_error", "rms_tool_error", "steady_error_max", "work"):
        shown = re.findall(rf"\b{name} ([−0-9.e+-]+) ", text)
        assert shown, name
        for number in shown:  # four digits
            assert float(number.replace("−", "-")) == pytest.approx(metrics[name], rel=6e-4), name
    assert metrics["reach_count"] == 1 and len(metrics["reaches"]) == 1
    for missing in ("No pictures: this run was not rendered", "No loop times", "No events"):
        assert missing in text, missing


def test_metrics_are_the_same_bytes_again(runs, tmp_path):
    done = call("run", reach(tmp_path, "pd"), "-o", tmp_path / "again", "--solo", "--no-report")
    assert done.returncode == 0, done.stderr
    assert not (tmp_path / "again" / "report.html").exists()
    assert (tmp_path / "again" / "metrics.json").read_bytes() == (runs / "pd" / "metrics.json").read_bytes()


def test_a_run_of_processes_has_pictures_and_loop_times(tmp_path):
    done = call("run", reach(tmp_path, "pd"), "-o", tmp_path / "run", "--set", "renderer.enabled=true", "--set", "renderer.fps=2",
                "--set", "renderer.size=[160, 120]")
    assert done.returncode == 0, done.stderr
    assert "report.html" in done.stdout
    page = checked(tmp_path / "run" / "report.html")
    assert page.count["img"] == 1 and "No loop times" not in page.text
    for process in ("simulator", "planner", "controller", "logger"):
        assert re.search(rf"{process}\s*% of [0-9]+ loops", page.text), process


def test_stale_pictures_are_drawn_again(tmp_path):
    """The log of a longer run takes the place of the old one: its pictures take the place of the old ones."""
    looks = ("--set", "renderer.enabled=true", "--set", "renderer.fps=2", "--set", "renderer.size=[160, 120]")
    for name, duration in (("run", 2), ("longer", 3)):
        done = call("run", reach(tmp_path, "pd"), "-o", tmp_path / name, *looks, "--set", f"simulator.duration={duration}")
        assert done.returncode == 0, done.stderr
    run = tmp_path / "run"
    done = call("report", run)
    assert done.returncode == 0 and done.stderr == "", done  # these are of this log
    (run / "frames" / "notes.txt").write_text("mine")
    pictures = {p.name: p.read_bytes() for p in (tmp_path / "longer" / "frames").glob("*.png")}
    assert sorted(pictures) != sorted(p.name for p in (run / "frames").glob("*.png"))
    for name in ("log.lcm", "experiment.yaml"):
        shutil.copy(tmp_path / "longer" / name, run / name)
    # as they are, they are not shown: they are those of another run
    done = subprocess.run([lab.BUILD / "bin" / "lab-experiment", "report", run], capture_output=True, text=True)
    page = checked(run / "report.html")
    assert "show another run" in page.text and "img" not in page.count
    done = call("report", run)
    assert done.returncode == 0 and "drawn again" in done.stderr and done.stderr.count("\n") == 1, done
    assert {p.name: p.read_bytes() for p in (run / "frames").glob("*.png")} == pictures
    assert (run / "contact.png").read_bytes() == (tmp_path / "longer" / "contact.png").read_bytes()
    assert checked(run / "report.html").count["img"] == 1 and (run / "frames" / "notes.txt").read_text() == "mine"
    assert not list(run.glob(".pictures*"))
    assert call("report", run).stderr == ""


@pytest.mark.parametrize("what,words", [("missing", "there is no log.lcm"), ("empty", "log.lcm is empty"), ("cut", "The run ended at step"),
                                        ("noise", "has no RUN message")])
def test_broken_runs_get_a_page(runs, tmp_path, what, words):
    folder = tmp_path / what
    shutil.copytree(runs / "pd", folder)
    log = folder / "log.lcm"
    whole = log.read_bytes()
    if what == "missing":
        log.unlink()
    else:
        log.write_bytes({"empty": b"", "cut": whole[:len(whole) * 2 // 3], "noise": b"\x00\x7f" * 5000}[what])
    done = call("report", folder)
    assert done.returncode == 1 and done.stderr.startswith("lab report: "), done
    assert words in checked(folder / "report.html").text


@pytest.mark.parametrize("state", ["changed", "cut", "killed"])
def test_who_reads_a_damaged_log_says_so_and_fails(runs, tmp_path, state):
    folder = tmp_path / "run"
    shutil.copytree(runs / "pd", folder)
    log = folder / "log.lcm"
    whole = bytearray(log.read_bytes())
    if state == "changed":
        whole[len(whole) // 2] ^= 4
    log.write_bytes(whole if state == "changed" else whole[:len(whole) * 2 // 3])
    if state == "killed":
        log.rename(folder / "log.lcm.part")
    words = "digest|is not whole|no event" if state == "changed" else "there is no END"
    for verb in (["report", folder], ["compare", folder, runs / "pd"],
                 ["render", folder, "--times", "0", "--size", "64x48", "-o", tmp_path / "pictures"]):
        done = call(*verb)
        assert done.returncode == 1 and re.search(words, done.stderr), (verb, done)
    page = checked(folder / "report.html").text
    assert ("The log is damaged" in page) == (state == "changed") and "Motion" in page
    assert (tmp_path / "pictures" / "0000.png").exists() or list((tmp_path / "pictures").glob("*.png"))


def test_the_last_lines_of_a_process_that_died_are_shown(tmp_path):
    done = call("run", reach(tmp_path, "pd"), "-o", tmp_path / "run", "--set", "processes.controller=echo my <last> words; exit 9")
    assert done.returncode == 5, done.stderr
    text = checked(tmp_path / "run" / "report.html").text
    assert "ended with exit 5" in text and "controller (exit 9)" in text and "my <last> words" in text


def test_text_in_a_run_is_text_on_the_page(runs, tmp_path):
    folder = tmp_path / "run"
    shutil.copytree(runs / "pd", folder)
    with open(folder / "experiment.yaml", "a") as file:
        file.write('# <script>alert("&")</script> <b>\n')
    assert call("report", folder).returncode == 0
    assert '# <script>alert("&")</script> <b>' in checked(folder / "report.html").text


def test_wrong_runs(runs, tmp_path):
    for words in (["report", "ghost"], ["compare", runs / "pd", "ghost"], ["compare", runs / "pd"], ["report", "--fast"], ["compare", runs / "pd", runs / "pd", "-o"]):
        done = call(*words, LAB_RUNS=str(tmp_path))
        assert done.returncode == 2 and done.stdout == "" and done.stderr.count("\n") == 1, done
    done = call("compare", runs / "pd", runs / "pd", "-o", "/proc/nowhere/x.html")
    assert done.returncode == 3 and done.stderr.count("\n") == 1


def test_compare(runs, tmp_path):
    page = tmp_path / "compare.html"
    done = call("compare", runs / "pd", runs / "computed_torque", "-o", page)
    assert done.returncode == 0, done.stderr
    assert re.search(r"^controller.kind +pd +computed_torque$", done.stdout, re.M)
    before = page.read_bytes()
    again = call("compare", runs / "pd", runs / "computed_torque", "-o", page, "--json")
    assert page.read_bytes() == before
    result = json.loads(again.stdout)
    first, second = (json.loads((runs / kind / "metrics.json").read_text()) for kind in ("pd", "computed_torque"))
    assert [key["key"] for key in result["keys"]] == ["controller.kind"]
    for row in result["metrics"]:
        if row["metric"] in ("max_error", "rms_error", "max_tool_error"):
            a, b = first[row["metric"]], second[row["metric"]]
            assert row["values"] == [a, b]
            assert row["improvement_percent"][1] == pytest.approx(100 * (a - b) / a)
            assert row["times_better"][1] == pytest.approx(a / b) and a / b > 10
    text = checked(page).text
    assert "2 runs side by side" in text and "times better" in text


def test_compare_other_robots(runs, tmp_path):
    done = call("run", "cubic_pd", "-o", tmp_path / "big", "--solo", "--no-report")
    assert done.returncode == 0, done.stderr
    done = call("compare", runs / "pd", tmp_path / "big", runs / "computed_torque", "-o", tmp_path / "x.html")
    assert done.returncode == 0, done.stderr
    assert "The robots differ" in done.stdout and "max_tool_error" in done.stdout and "\nmax_error " not in done.stdout
    assert "The robots differ" in checked(tmp_path / "x.html").text


def test_memory_does_not_grow_with_the_log(tmp_path):
    """190 MB for 200,000 steps, if each of them were kept; the program itself, and 32 MB of steps, are 46 MB. A full disk is said."""
    run = tmp_path / "long"
    done = call("run", "sinusoid_ct", "--solo", "--no-report", "-o", run, "--set", "simulator.dt=0.001",
                "--set", "simulator.duration=200", "--set", "expect={}")
    assert done.returncode == 0, done.stderr
    program = lab.BUILD / "bin" / "lab-experiment"
    for words in (["evaluate", run], ["report", run], ["compare", run, run]):
        child = subprocess.Popen([program, *words], stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        assert status == 0 and usage.ru_maxrss < 80 << 10, (words, status, usage.ru_maxrss)
    done = subprocess.run([program, "evaluate", run], env={**os.environ, "TMPDIR": "/dev/full"}, capture_output=True, text=True)
    assert done.returncode == 3 and done.stderr.count("\n") == 1, done.stderr
    assert "for the steps of a long run" in done.stderr and "TMPDIR" in done.stderr

"""lab bench core, without peers and in short blocks: its lines, its JSON, its picture, its verdict; never its speed."""
import json
import pathlib
import re
import subprocess
import xml.dom.minidom

LAB = pathlib.Path(__file__).resolve().parents[2] / "scripts/lab"
LINE = re.compile(r"[a-z]+ [a-z0-9_:]+ [a-z_]+ \d+\.\d \d+\.\d")
CHECK = re.compile(r"# check [a-z]+ [a-z0-9_:]+( \S+=[-+.e\d]+)+")

# one robot, two libraries that agree: ours is twice as fast in rnea, half as fast in aba; two lines of one cell: the better
AGREE = """# 2026-01-01, some CPU
# check lcmlab r trM=2.5 |g|=10 aba(rnea(a))-a=1e-14
lcmlab r rnea 50.0 51.0
lcmlab r aba 200.0 201.0
lcmlab chain:10 rnea 100.0 100.0
# check pinocchio r trM=2.5 |g|=10.000000001 aba(rnea(a))-a=2e-14
pinocchio r rnea 100.0 101.0
pinocchio r aba 150.0 151.0
pinocchio r aba 100.0 101.0
"""


def bench(*words):
    return subprocess.run([LAB, "bench", "core", *words], capture_output=True, text=True)


def judge(tmp_path, text):
    (tmp_path / "lines").write_text(text)
    return bench("--from", tmp_path / "lines", "--json", "-o", tmp_path / "out")


def test_measures_and_prints_lines(tmp_path):
    robots = ["simple_3dof_arm", "manipulator", "humanoid", "chain:3", "tree:10"]
    done = bench("--peers", "none", "--quick", "--rounds", "1", "--robots", ",".join(robots), "-o", tmp_path)
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stdout.partition("\n\n")[0].splitlines()[1:]]
    checks = [line for line in lines if line.startswith("#")]
    assert [line.split()[3] for line in checks] == robots and all(CHECK.fullmatch(line) for line in checks)
    rows = [line for line in lines if not line.startswith("#")]
    assert all(LINE.fullmatch(row) for row in rows), rows
    assert all(0 < float(row.split()[3]) <= float(row.split()[4]) for row in rows)
    measured = {(row.split()[1], row.split()[2]) for row in rows}
    assert {("humanoid", a) for a in ("fk", "rnea", "crba", "aba", "minv", "jcom")} <= measured
    assert {a for r, a in measured if r == "tree:10"} == {"rnea", "aba"}

    results = json.loads((tmp_path / "results.json").read_text())
    assert results["agree"] and {(r["robot"], r["algorithm"]) for r in results["results"]} == measured
    assert results["ns_per_joint"]["tree aba"]["lcmlab"]["10"] > 0
    xml.dom.minidom.parse(str(tmp_path / "ratios.svg"))


def test_ratios_of_lines(tmp_path):
    done = judge(tmp_path, AGREE)
    assert done.returncode == 0, done.stderr
    results = json.loads(done.stdout)
    assert results["ratios"] == {"rnea": {"r": {"ratio": 0.5, "best_peer": "pinocchio"}}, "aba": {"r": {"ratio": 2, "best_peer": "pinocchio"}}}
    assert results["geometric_mean"] == {"rnea": 0.5, "aba": 2}
    assert results["ns_per_joint"] == {"chain rnea": {"lcmlab": {"10": 10}}}
    picture = xml.dom.minidom.parse(str(tmp_path / "out/ratios.svg"))
    assert "pinocchio 100 ns" in "".join(t.firstChild.data for t in picture.getElementsByTagName("title"))


def test_other_numbers_are_a_failure(tmp_path):
    for wrong in (AGREE.replace("|g|=10.000000001", "|g|=10.0000001"), AGREE.replace("2e-14", "2e-6"), AGREE.replace("2e-14", "nan")):
        done = judge(tmp_path, wrong)
        assert done.returncode == 1 and "NOT THE SAME NUMBERS" in done.stderr
        assert json.loads(done.stdout)["agree"] is False


def test_only_what_was_asked_for(tmp_path):
    done = bench("--peers", "none", "--quick", "--robots", "chain:2", "--algorithms", "crba,com", "--json", "-o", tmp_path)
    assert {r["algorithm"] for r in json.loads(done.stdout)["results"]} == {"crba", "com"}
    for words, name in ((("--robots", "pandas"), "pandas"), (("--peers", "drake"), "drake"), (("--robots", "chain:0"), "chain:0")):
        done = bench(*words)
        assert done.returncode == 2 and name in done.stderr

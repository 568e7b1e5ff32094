"""What a person types wrong, and the one line that answers: tests/system/mistakes.tsv.

Each line there: a command line, its exit code, and the line on stderr (`..` stands for anything). Nothing of it may run, print on
stdout, or leave a file. `test_mistakes.py --print` prints the table as the programs answer now.
"""
import fnmatch
import re
import subprocess
import sys
from pathlib import Path

import pytest

import labrun as lab

TABLE = Path(__file__).with_name("mistakes.tsv")
FILES = {
    "comma.yaml": "robot: {model: builtin:manipulator}\nsimulator:\n  dt: 0,001\n",
    "tab.yaml": "robot:\n\tmodel: builtin:manipulator\n",
    "empty.yaml": "",
    "typo.yaml": "robot: {model: builtin:manipulator}\ncontroler: {kp: 80}\n",
    "unused.yaml": "robot: {model: builtin:manipulator}\ncontroller:\n  kind: pd\n  kp: 100\n  stiffness: [10, 20]\n",
    "missing.yaml": "robot: {model: builtin:manipulator}\nprocesses:\n  controller: ./mine.py\n",
    "sweep.yaml": "experiment: comma.yaml\ngrid: {controller.kp: [1, 2]}\n",
    "broken.urdf": "<robot name='r'><link name='a'/><joint name='j' type='revolut'/></robot>\n",
    "notes.txt": "mine\n",
    "mine/diary.txt": "mine\n",
}


def mistakes():
    lines = [line.rstrip("\n") for line in TABLE.read_text().splitlines() if line.strip() and not line.startswith("#")]
    return [tuple(line.split("\t")) for line in lines]


def folder_with_files(folder):
    for name, text in FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return folder


def answer_of(command, folder):
    env = dict(lab.environment(), LAB_RUNS=str(folder / "runs"), PATH=f"{lab.BUILD / 'bin'}:{lab.ROOT / 'scripts'}:/usr/bin:/bin:/usr/sbin:/sbin")
    for name in ("LCM_DEFAULT_URL", "LAB_RUN", "LAB_RUN_DIR", "LAB_PREFIX"):
        env.pop(name, None)
    done = subprocess.run(["bash", "-c", command], cwd=folder, env=env, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)
    plain = re.sub(r"\x1b\[[0-9;]*m", "", done.stderr)
    for path, name in ((str(folder), "HERE"), (str(lab.ROOT), "ROOT"), (str(lab.BUILD), "BUILD")):
        plain = plain.replace(path, name)
    return done, plain


def contents(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_the_table_is_whole():
    rows = mistakes()
    assert len(rows) >= 120 and all(len(row) == 3 for row in rows), [row for row in rows if len(row) != 3]
    assert len({row[0] for row in rows}) == len(rows)


@pytest.mark.parametrize("command, code, line", mistakes(), ids=lambda value: None)
def test_a_mistake_is_answered_in_one_line(tmp_path, command, code, line):
    folder = folder_with_files(tmp_path)
    before = contents(folder)
    done, said = answer_of(command, folder)
    assert done.returncode == int(code), (command, done)
    assert said.endswith("\n") and said.count("\n") == 1, (command, said)
    pattern = re.sub(r"([\[\]*?])", r"[\1]", line).replace("..", "*")
    assert fnmatch.fnmatchcase(said[:-1], pattern), f"{command}\n  said {said}  not  {line}"
    assert said.startswith(("lab: ", "lab ", "lab-", "HERE/", "broken.urdf:")), said
    assert done.stdout == "" or "--json" in command, (command, done.stdout)
    assert contents(folder) == before, command


if __name__ == "__main__" and "--print" in sys.argv:
    import tempfile
    for row in mistakes():
        with tempfile.TemporaryDirectory() as name:
            done, said = answer_of(row[0], folder_with_files(Path(name)))
        print(row[0], done.returncode, said.rstrip("\n").replace("\n", " // "), sep="\t", flush=True)

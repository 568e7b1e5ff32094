"""Every command line in a fenced block of README.md and docs/ works as it stands, in the order of the pages."""
import os
import re
import shutil
import subprocess

import pytest

import labrun as lab

COMMAND = re.compile(r"(scripts/lab|build/release/bin/|lcm-gen) ?")
ONLY_HELP = {"test", "demo", "robots", "bench", "setup", "clean", "build"}  # long, or not to be done by a test
USER = 65534  # nobody


def lines():
    """(page, line number, command) of each."""
    pages = [lab.ROOT / "README.md", *sorted((lab.ROOT / "docs").glob("*.md"))]
    for page in pages:
        fenced = False
        for number, line in enumerate(page.read_text().splitlines(), 1):
            if line.startswith("```"):
                fenced = not fenced
            elif fenced and COMMAND.match(line):
                yield page.name, number, line


def copy_of_the_checkout(folder):
    """The files that git knows, or would; the programs are those that are tested."""
    names = subprocess.run(["git", "-C", lab.ROOT, "ls-files", "-zco", "--exclude-standard"], check=True, capture_output=True)
    for name in names.stdout.decode().split("\0"):
        if name and (lab.ROOT / name).exists():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(lab.ROOT / name, folder / name)
    (folder / "build").mkdir()
    (folder / "build" / "release").symlink_to(lab.BUILD)
    return folder


def test_every_line_of_a_block_can_be_pasted():
    """No prose behind a command: it would be taken for arguments."""
    found = list(lines())
    assert len(found) > 50
    for page, number, line in found:
        command = re.split(r"\s#\s", line)[0].rstrip()
        assert not re.search(r"\S {2,}\S", command), f"{page}:{number}: {line}"


@pytest.mark.parametrize("who", ["root", "user"])
def test_the_lines_of_the_pages_work_in_their_order(tmp_path, who):
    if who == "user" and (os.getuid() != 0 or not os.environ.get("LAB_TEST_DOCS")):
        pytest.skip("as another user: with root's rights, in lab test --full")
    clone = copy_of_the_checkout(tmp_path / "clone")
    python = lab.BUILD / "pyenv" / "bin"
    environment = lab.environment(LAB_BUILD=str(clone / "build" / "release"), LAB_RUNS=str(clone / "runs"), HOME=str(tmp_path),
                                  PATH=f"{python}:{os.environ['PATH']}")
    before = []
    if who == "user":
        before = ["setpriv", f"--reuid={USER}", f"--regid={USER}", "--clear-groups"]
        for path in [tmp_path, *tmp_path.rglob("*")]:
            os.chown(path, USER, USER, follow_symlinks=False)
        for path in tmp_path.parents:
            os.chmod(path, os.stat(path).st_mode | 0o111)
    try:
        for page, number, line in lines():
            verb = (line.split() + [""])[1]
            command = f"scripts/lab {verb} --help" if line.startswith("scripts/lab ") and verb in ONLY_HELP else line
            if "--video" in command and not shutil.which("ffmpeg"):
                continue  # the page says that it needs it
            if "python3 " in command and not python.exists():
                continue  # tests/conformance/pyenv.sh has found no pip: the tests of Python's LCM say so
            done = subprocess.run([*before, "bash", "-c", command], cwd=clone, env=environment, capture_output=True, text=True,
                                  stdin=subprocess.DEVNULL, timeout=lab.DEADLINE)
            assert done.returncode == 0, f"{page}:{number}: {line}\n{done.stdout}\n{done.stderr}"
    finally:
        subprocess.run([*before, clone / "scripts" / "lab", "down", "--all"], env=environment, capture_output=True)

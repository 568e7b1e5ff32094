"""Every command line in a fenced block of README.md and docs/ works as it stands, in the order of the pages."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile

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
def test_the_lines_of_the_pages_work_in_their_order(who):
    if who == "user" and (os.getuid() != 0 or not os.environ.get("LAB_TEST_DOCS")):
        pytest.skip("as another user: with root's rights, in lab test --full")
    with tempfile.TemporaryDirectory() as folder:  # pytest closes its own folders to other users
        run_all(pathlib.Path(folder), who)


def run_all(folder, who):
    clone = copy_of_the_checkout(folder / "clone")
    python = lab.BUILD / "pyenv" / "bin"
    environment = lab.environment(LAB_BUILD=str(clone / "build" / "release"), LAB_RUNS=str(clone / "runs"), HOME=str(folder),
                                  PATH=os.environ["PATH"] if who == "user" else f"{python}:{os.environ['PATH']}")
    before = []
    if who == "user":
        before = ["setpriv", f"--reuid={USER}", f"--regid={USER}", "--clear-groups"]
        for path in [folder, *folder.rglob("*")]:
            os.chown(path, USER, USER, follow_symlinks=False)
    try:
        for page, number, line in lines():
            verb = (line.split() + [""])[1]
            command = f"scripts/lab {verb} --help" if line.startswith("scripts/lab ") and verb in ONLY_HELP else line
            if "--video" in command and not shutil.which("ffmpeg"):
                continue  # the page says that it needs it
            if "python3 " in command and (who == "user" or not python.exists()):
                continue  # Python's LCM is in a folder of tests/conformance/pyenv.sh, which only its owner enters
            done = subprocess.run([*before, "bash", "-c", command], cwd=clone, env=environment, capture_output=True, text=True,
                                  stdin=subprocess.DEVNULL, timeout=lab.DEADLINE)
            assert done.returncode == 0, f"{page}:{number}: {line}\n{done.stdout}\n{done.stderr}"
    finally:
        subprocess.run([*before, clone / "scripts" / "lab", "down", "--all"], env=environment, capture_output=True)

#!/usr/bin/env python3
"""clang-tidy over all sources, with the checks of .clang-tidy; what is known to be clean is not checked again.

usage: tidy.py [--build DIR] [--full] [--seconds S] [-j N] [FILE..]

Checks the sources (not the tests) that compile_commands.json of the build lists. A file is clean until its text, a header
of the project that it includes, .clang-tidy, its compile command or clang-tidy itself changes; what is clean is
remembered in ~/.cache/lcmlab/tidy, for every checkout. Stops after S seconds (120) and says how many files are left for
the next run; --full goes on to the end. FILE.. checks these alone. Exit 0 without findings, 1 with, 2 when it cannot run.

Most of clang-tidy's time goes into headers. So files with much in common are checked as one text; what does not compile
as such a text (two files with the same name in an anonymous namespace), or has a finding in it, is checked alone, and the
others once more without it: in a text that does not compile clang-tidy skips the checks that follow the flow of a program.
"""
import argparse
import collections
import concurrent.futures
import hashlib
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time

import rooms

WAY = "2"  # of checking: what another way called clean is checked again
BATCH_LINES = {True: 2500, False: 800}  # with and without --full: what is not ready when the time is over was in vain
MESSAGE = re.compile(r"^(\S+?):(\d+):(\d+): (warning|error|note): (.*)$")


class Sources:
    """What there is to check, and what decides on the outcome."""

    def __init__(self, root, build, tool):
        self.root = root
        with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as f:
            self.flags = {}
            for entry in json.load(f):
                for file in compiled_by(entry["file"]):
                    file = os.path.relpath(file, root)
                    if file.split("/")[0] in rooms.FOLDERS:
                        self.flags[file] = flags_of(entry)
        with open(os.path.join(root, ".clang-tidy"), encoding="utf-8") as f:
            self.rules = WAY + tool_version(tool) + f.read()
        self.texts, self.closures = {}, {}

    def text(self, file):
        if file not in self.texts:
            try:
                with open(os.path.join(self.root, file), encoding="utf-8") as f:
                    self.texts[file] = f.read()
            except OSError:
                self.texts[file] = ""  # generated: its .lcm text is in the build's flags or in git
        return self.texts[file]

    def headers(self, file):
        """The file and all headers of the project that it includes, directly or not."""
        seen, todo = {file}, [file]
        while todo:
            one = todo.pop()
            for include in rooms.INCLUDE.findall(self.text(one)):
                to = rooms.target(self.root, one, include)
                if to and to.endswith("_t.hpp"):
                    to = "lcmtypes/" + os.path.basename(to)[:-4] + ".lcm"
                if to and to not in seen:
                    seen.add(to)
                    todo.append(to)
        return sorted(seen)

    def key(self, file):
        text = [self.rules, " ".join(self.flags[file]).replace(self.root, "")]
        text += [name + "\0" + self.text(name) for name in self.headers(file)]
        return hashlib.sha256("\0".join(text).encode()).hexdigest()


def compiled_by(file):
    """The sources in a compile command's file: itself, or what CMake has put together in a unity file."""
    if "/Unity/unity_" not in file:
        return [file]
    with open(file, encoding="utf-8") as f:
        return re.findall(r'^#include "(.*)"$', f.read(), re.MULTILINE)


def flags_of(entry):
    """What a compile command says to the compiler, without compiler, input and output."""
    words = shlex.split(entry["command"]) if "command" in entry else entry["arguments"]
    flags, words = [], iter(words)
    for word in words:
        if word in ("-o", "-c", "-MF", "-MT", "-MQ"):
            if word != "-c":
                next(words)
        elif word == "-include":  # g++'s precompiled header: a source must include what it uses
            next(words)
        elif word in ("-I", "-isystem", "-iquote"):
            flags += [word, next(words)]
        elif word.startswith("-") and word not in ("-MD", "-MMD", "-Werror", "-Winvalid-pch", "-fpch-preprocess"):
            flags.append(word)
    return flags


def tool_version(tool):
    return subprocess.run([tool, "--version"], capture_output=True, text=True, check=True).stdout


def batches(sources, files, most):
    """Files of one top-level folder, up to `most` lines each; in the given order."""
    by_folder = collections.OrderedDict()
    for file in files:
        by_folder.setdefault(file.split("/")[0], []).append(file)
    for group in by_folder.values():
        batch, lines = [], 0
        for file in group:
            size = sources.text(file).count("\n")
            if batch and lines + size > most:
                yield batch
                batch, lines = [], 0
            batch.append(file)
            lines += size
        yield batch


class Checker:
    def __init__(self, sources, tool, scratch, deadline):
        self.sources, self.tool, self.scratch, self.deadline = sources, tool, scratch, deadline

    def run(self, batch):
        """(findings, batches to check again) of files taken together; None when the time was over."""
        left = self.deadline and self.deadline - time.monotonic()
        if left is not None and left < 1:
            return None
        root = self.sources.root
        name = os.path.join(self.scratch, hashlib.sha256("\n".join(batch).encode()).hexdigest()[:16] + ".cc")
        lines, text, flags = [], [], []
        for file in batch:
            own = self.sources.text(file).splitlines()
            text += own
            lines += [(file, n) for n in range(1, len(own) + 1)]
            flags += ["-iquote", os.path.join(root, os.path.dirname(file))]
            options = self.sources.flags[file]
            flags += [f for f in options if f.startswith("-") and f not in flags and f not in ("-isystem", "-I")]
            for i, option in enumerate(options):
                if option in ("-isystem", "-I"):
                    flags += options[i:i + 2]
        with open(name, "w", encoding="utf-8") as f:
            f.write("\n".join(text) + "\n")
        command = [self.tool, "--quiet", f"--config-file={root}/.clang-tidy", name, "--"] + flags + \
            ["-Wno-everything", "-Wcomma"]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=root)
        try:
            out, err = process.communicate(timeout=left)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            return None
        finally:
            os.unlink(name)
        if process.returncode not in (0, 1):
            return [f"{batch[0]}: clang-tidy failed: {err.strip().splitlines()[-1:]}"], []
        return self.read(out, name, lines, batch)

    def read(self, out, name, lines, batch):
        findings, broken = [], set()
        for line in out.splitlines():
            match = MESSAGE.match(line)
            if not match:
                continue
            path, row, column, kind, words = match.groups()
            if path == name:
                file, row = lines[min(int(row), len(lines)) - 1]
            else:
                file = os.path.relpath(path, self.sources.root)
            if kind == "error" and "clang-diagnostic-error" in words and len(batch) > 1:
                broken.add(file if path == name else None)
            elif kind in ("error", "warning"):
                findings.append(f"{file}:{row}:{column}: {words}")
        if broken:
            alone = [file for file in batch if None in broken or file in broken]
            rest = [file for file in batch if file not in alone]
            return [], [[file] for file in alone] + ([rest] if rest else [])
        # a finding may come from the others of the batch: it counts when the file alone has it
        doubtful = {f.split(":")[0] for f in findings} & set(batch) if len(batch) > 1 else set()
        return [f for f in findings if f.split(":")[0] not in doubtful], [[file] for file in sorted(doubtful)]


def changed_files(root):
    """Files that differ from the last commit."""
    out = subprocess.run(["git", "-C", root, "status", "--porcelain", "--no-renames", "-uall"], capture_output=True, text=True)
    return {line[3:] for line in out.stdout.splitlines()} if out.returncode == 0 else set()


def check(options, root, tool):
    sources = Sources(root, options.build, tool)
    memory = os.path.join(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "lcmlab", "tidy")
    scratch = os.path.join(options.build, "tidy")
    for folder in (memory, scratch):
        os.makedirs(folder, exist_ok=True)

    files = sorted(os.path.relpath(os.path.abspath(f), root) for f in options.files) or sorted(sources.flags)
    for file in files:
        if file not in sources.flags:
            sys.exit(f"tidy: {file} is not in {options.build}/compile_commands.json")
    keys = {file: sources.key(file) for file in files}
    own = {file: hashlib.sha256((file + "\0" + sources.text(file)).encode()).hexdigest() for file in files}
    todo = [file for file in files if not os.path.exists(os.path.join(memory, keys[file]))]
    for file in set(files) - set(todo):
        os.utime(os.path.join(memory, keys[file]))
    for name in os.listdir(memory):  # not used for a month
        if time.time() - os.stat(os.path.join(memory, name)).st_mtime > 30 * 86400:
            os.unlink(os.path.join(memory, name))
    clean = len(files) - len(todo)
    changed = changed_files(root)
    # files that differ from the last commit, by themselves; then texts that were never checked, then those with a changed header
    todo.sort(key=lambda file: (os.path.exists(os.path.join(memory, own[file])), file))
    most = BATCH_LINES[options.full]

    start = time.monotonic()
    checker = Checker(sources, tool, scratch, None if options.full else start + options.seconds)
    findings, left, done = set(), [], 0
    queue = [*batches(sources, [file for file in todo if file in changed], most),
             *batches(sources, [file for file in todo if file not in changed], most)]
    while queue:
        again = []
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            running = {pool.submit(checker.run, batch): batch for batch in queue}
            for future in concurrent.futures.as_completed(running):
                batch, result = running[future], future.result()
                if result is None:
                    left += batch
                    continue
                found, batches_again = result
                again += batches_again
                for finding in found:
                    if finding not in findings:
                        print(finding, flush=True)
                findings |= set(found)
                dirty = {f.split(":")[0] for f in found}
                for file in set(batch).difference(*batches_again):
                    done += 1
                    # a finding in a header is a finding in every file that includes it
                    if not dirty & set(sources.headers(file)):
                        for name in (keys[file], own[file]):
                            open(os.path.join(memory, name), "w", encoding="utf-8").close()
        queue = again
    print(f"tidy: {clean} files were clean already, {done} checked in {time.monotonic() - start:.0f} s, "
          f"{len(findings)} findings" + (f"; {len(left)} files are left for the next run, or for --full" if left else ""))
    return 1 if findings else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    here = os.path.dirname(os.path.abspath(__file__))
    root = os.path.dirname(os.path.dirname(here))
    parser.add_argument("--build", default=os.environ.get("LAB_BUILD", os.path.join(root, "build", "release")))
    parser.add_argument("--full", action="store_true", help="no limit of time")
    parser.add_argument("--seconds", type=float, default=120, help="stop after so long (default 120)")
    parser.add_argument("-j", dest="jobs", type=int, default=os.cpu_count(), help="so many at once")
    parser.add_argument("files", nargs="*")
    options = parser.parse_args()
    tool = shutil.which("clang-tidy-19")
    if not tool:
        print("tidy: clang-tidy-19 is missing: run scripts/lab setup --test", file=sys.stderr)
        return 2
    if not os.path.exists(os.path.join(options.build, "compile_commands.json")):
        print(f"tidy: {options.build} is not configured: run scripts/lab build", file=sys.stderr)
        return 2
    return check(options, root, tool)


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(main())

#!/usr/bin/env python3
"""What README.md, CHANGELOG.md, CONTRIBUTING.md and docs/ say about names and numbers that the sources have.

usage: claims.py [--root DIR]

In code (between backticks, and in fenced blocks) a verb has a script, its options are in its help, a program is built, an
environment variable is read somewhere, a key of an experiment is in lab/experiment/keys.h and an event is in the sources. Numbers
that are written as words or figures (COUNTS) are those of the files.
"""
import argparse
import pathlib
import re
import sys

FOLDERS = ["core", "wire", "lab", "procs", "render", "bench", "examples", "scripts", "tests", "cmake"]
SECTIONS = "robot|simulator|planner|controller|logger|renderer|safety|faults|evaluation"
WORDS = {"nine": 9, "ten": 10, "thirteen": 13, "fifteen": 15, "thirty": 30, "forty": 40}
# pattern in a page -> what it counts, and how far off it may be ("some", "about")
COUNTS = [
    (r"(?i)\b(fifteen|\d+) (?:example programs|short programs|programs, numbered|programs of the core)", "examples/[0-9]*.cc", 0),
    (r"(?i)(?:some|about)\s+(forty|\d+)\s+(?:of\s+them|are\s+included)", "experiments/*.yaml", 5),
]


def code_of(text):
    """(line number, code) of each span between backticks and each line of a fenced block."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            fenced = not fenced
        elif fenced:
            yield number, re.split(r"\s#\s", line)[0]
        else:
            yield from ((number, span) for span in re.findall(r"`([^`]+)`", line))


def findings(root):
    pages = [root / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md")] + sorted((root / "docs").glob("*.md"))
    sources = "\n".join(p.read_text(errors="replace") for folder in FOLDERS for p in sorted((root / folder).rglob("*"))
                        if p.is_file() and p.suffix in {".cc", ".h", ".py", ".sh", ".bash", ".bats", ".txt", ".in", ".cmake", ""}
                        and "__pycache__" not in p.parts)
    sources += (root / "CMakeLists.txt").read_text()
    keys = "".join((root / "lab/experiment" / name).read_text() for name in ("keys.h", "gains.h"))
    gains = {f"controller.{name}" for name in re.findall(r'"([a-z_]+)"', (root / "lab/experiment/gains.h").read_text())}
    scripts = {p.name.removeprefix("lab-"): p.read_text() for p in (root / "scripts").glob("lab-*")}
    for verb, folder in (("render", "procs/renderer"), ("bench", "bench")):  # they pass options on
        scripts[verb] += "".join(p.read_text() for p in (root / folder).rglob("*") if p.suffix in {".cc", ".py"})
    programs = set(re.findall(r"add_executable\((lab-[a-z]+)", "\n".join(p.read_text() for f in FOLDERS for p in (root / f).rglob("CMakeLists.txt"))))
    for page in pages:
        text = page.read_text()
        name = page.relative_to(root)
        for number, code in code_of(text):
            where = f"{name}:{number}"
            for verb, rest in re.findall(r"(?:^|scripts/|; )lab ([a-z]+)((?: [^;&|]*)?)", code):
                if verb not in scripts and verb != "help":
                    yield f"{where}: there is no verb '{verb}': {code}"
                    continue
                for option in re.findall(r"(?<![\w-])--[a-z][a-z-]*", rest.split(" -- ")[0]):
                    if option not in scripts.get(verb, option) and option not in ("--help", "--lab", "--json"):
                        yield f"{where}: {verb} does not know {option}: {code}"
            for program in re.findall(r"(?<![\w/.-])lab-[a-z]+(?![\w.-])", code):
                if program not in programs and program.removeprefix("lab-") not in scripts:
                    yield f"{where}: there is no program {program}: {code}"
            for variable in re.findall(r"\bLAB_[A-Z_]+\b", code):
                if not re.search(rf"\b{variable}\b", sources):
                    yield f"{where}: nothing reads {variable}"
            for key in re.findall(rf"(?<![\w.])(?:{SECTIONS})\.[a-z_]+(?![a-z_(])", code):
                if f'"{key}' not in keys and key not in gains and not key.endswith((".h", ".cc", ".log", ".py")):
                    yield f"{where}: there is no key {key}"
        for event in re.findall(r"EVENTs? `([a-z_]+)`", text):
            if f'"{event}"' not in sources:
                yield f"{name}: there is no EVENT '{event}'"
        for pattern, files, slack in COUNTS:
            for match in re.finditer(pattern, text):
                there = len(list(root.glob(files)))
                said = WORDS.get(match[1].lower()) or int(match[1])
                if abs(said - there) > slack:
                    yield f"{name}: '{match[0]}', but {files} are {there}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", default=pathlib.Path(__file__).resolve().parents[2], type=pathlib.Path)
    found = list(findings(parser.parse_args().root))
    print("\n".join(found) or "claims: every name and number of the pages is there")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()

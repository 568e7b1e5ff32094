"""--help of every program and verb: what it is, how it is called, an example; and the example is one that it takes."""
import re
import subprocess

import pytest

import labrun as lab

PROGRAMS = sorted(p.name for p in (lab.BUILD / "bin").glob("lab-*"))
VERBS = sorted(p.name for p in (lab.ROOT / "scripts").glob("lab-*"))


def run(*words):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=60, env=lab.environment(), stdin=subprocess.DEVNULL)


def help_of(*words):
    done = run(*words, "--help")
    assert done.returncode == 0 and done.stderr == "", done.stderr
    return done.stdout


def check_examples(text, starts_with, options_in=""):
    examples = re.findall(r"^example: (.*)$", text, re.M)
    assert examples, text
    body = text.replace("example:", "", 1) + options_in
    for example in examples:
        assert example.startswith(starts_with), example
        for option in re.findall(r"(?<=\s)--?[a-z][a-z-]*", example):
            assert len(re.findall(rf"(?<![a-z-]){re.escape(option)}(?![a-z-])", body)) > 1, f"{option} of the example is explained nowhere"


@pytest.mark.parametrize("program", PROGRAMS)
def test_programs(program):
    path = lab.BUILD / "bin" / program
    text = help_of(path)
    assert f"Usage: {program} [OPTIONS]" in text
    verbs = re.findall(r"^  ([a-z]+) {2,}", text.partition("Subcommands:")[2], re.M)
    for verb in verbs:
        below = help_of(path, verb)
        assert f"Usage: {program} {verb}" in below
        check_examples(below, f"{program} {verb}", text)
    if verbs:
        assert re.search(rf"^example: {program} ({'|'.join(verbs)})", text, re.M)
    else:
        check_examples(text, program)
    for words in (["--no-such-option"], *([verb, "--no-such-option"] for verb in verbs)):
        done = run(path, *words)
        assert done.returncode == 2 and done.stdout == "" and done.stderr.count("\n") == 1, done
        assert done.stderr.startswith(f"{program}: unknown option '--no-such-option' (see: {program}"), done


@pytest.mark.parametrize("verb", VERBS)
def test_verbs(verb):
    name = verb.removeprefix("lab-")
    text = help_of(lab.LAB, name)
    assert text.startswith(f"lab {name}: ") and f"\nusage: lab {name}" in text
    examples = re.findall(r"^example: (.*)$", text, re.M)
    for below in re.findall(rf"lab {name} ([a-z]+) --help", text):
        text += help_of(lab.LAB, name, below)
    assert examples and all(example.startswith(f"scripts/lab {name}") for example in examples)
    own = [re.split(r"&&|\||;| -- ", example)[0] for example in examples]  # not what is piped on
    for option in re.findall(r"(?<=\s)--?[a-z][a-z-]*", " ".join(own)):
        assert len(re.findall(rf"(?<![a-z-]){re.escape(option)}(?![a-z-])", text)) > 1, f"{option} of the example is explained nowhere"


def test_every_program_is_of_the_contract():
    for name in ("simulator", "planner", "controller", "logger", "renderer", "solo", "spy", "experiment", "send", "model"):
        assert f"lab-{name}" in PROGRAMS

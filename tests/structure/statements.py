#!/usr/bin/env python3
"""Which test holds which sentence of docs/safety.md and of docs/architecture.md, from "Two clocks" on.

usage: statements.py [--root DIR] [--print]

A row of statements.tsv is: the page, the first words of the sentence (without backticks and asterisks), and the tests that fail
when the sentence is false, each as FILE::NAME: Suite.Name of gtest, a function of pytest, the title of a bats test. Or, in place
of tests, `-` and why there can be none. Rows of tables and transitions of the state diagram are sentences too; other blocks of
code are not. A sentence without a row, a row without a sentence, and a test that is not in its file are faults.
--print lists the sentences.
"""
import argparse
import pathlib
import re
import sys

PAGES = {"docs/safety.md": "", "docs/architecture.md": "## Two clocks"}  # and where their statements begin
TABLE = "tests/structure/statements.tsv"
ITEM = re.compile(r"^(?:- |\d+\. )")
END = re.compile(r"(?:(?<=[.!?])|(?<=[.!?]\)))\s+(?=[A-Z`*(])")


def plain(text):
    """Without links, asterisks and backticks."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", " ".join(text.split()))
    return text.replace("`", "").replace("**", "").strip()


def paragraphs(text):
    """Each paragraph, item of a list, row of a table below its head, and transition of a diagram."""
    lines, fenced, head = [], False, None
    for line in [*map(str.strip, text.splitlines()), ""]:
        row = line.startswith("|") and not fenced
        if lines and (not line or row or line.startswith(("#", "```")) or ITEM.match(line)):
            yield " ".join(lines)
            lines = []
        if line.startswith("```"):
            fenced = not fenced
        elif fenced:
            if " --> " in line:
                yield line
        elif row:
            if head is not None and not re.fullmatch(r"[|\- ]+", line):
                yield line.strip("| ")
            head = line
        elif line and not line.startswith("#"):
            lines.append(ITEM.sub("", line, count=1))
        head = head if row else None


def sentences(text):
    return [plain(sentence) for paragraph in paragraphs(text) for sentence in END.split(paragraph)]


def defined(file, name):
    """How a test of that name begins in such a file."""
    if file.endswith(".cc"):
        suite, _, test = name.partition(".")
        return rf"TEST(?:_[FP])?\({re.escape(suite)}, {re.escape(test)}\)"
    return rf"^ *def {re.escape(name)}\(" if file.endswith(".py") else rf'^@test "{re.escape(name)}" '


def said_by(root):
    """The sentences of each page."""
    texts = {page: (root / page).read_text() for page in PAGES}
    return {page: sentences(text[text.index(PAGES[page]):]) for page, text in texts.items()}


def findings(root):
    files = {}
    for path in sorted((root / "tests").rglob("*")):
        if path.suffix in {".cc", ".py", ".bats"}:
            files[path.name] = files.get(path.name, "") + path.read_text(errors="replace")
    said = said_by(root)
    held = {page: set() for page in PAGES}
    for number, line in enumerate((root / TABLE).read_text().splitlines(), 1):
        page, start, *tests = line.split("\t")
        found = [sentence for sentence in said.get(page, []) if sentence.startswith(start)]
        if len(found) != 1:
            yield f"{TABLE}:{number}: {len(found)} sentences of {page} begin with '{start}'"
        held.get(page, set()).update(found)
        if not tests or (tests[0] == "-" and len(tests) != 2):
            yield f"{TABLE}:{number}: name the tests, or - and why there are none"
        for test in tests if tests[0:1] != ["-"] else []:
            file, _, name = test.partition("::")
            if not re.search(defined(file, name), files.get(file, ""), re.M):
                yield f"{TABLE}:{number}: there is no test {test}"
    for page, all_of_it in said.items():
        yield from (f"{page}: no row of {TABLE} for '{sentence}'" for sentence in all_of_it if sentence not in held[page])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", default=pathlib.Path(__file__).resolve().parents[2], type=pathlib.Path)
    parser.add_argument("--print", action="store_true", dest="show")
    options = parser.parse_args()
    if options.show:
        print("\n".join(f"{page}\t{sentence}" for page, all_of_it in said_by(options.root).items() for sentence in all_of_it))
        return
    found = list(findings(options.root))
    print("\n".join(found) or "statements: every sentence has its test, or says why not")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()

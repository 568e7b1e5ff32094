#!/usr/bin/env python3
"""How long files and functions are, how large each folder is, and what each header begins with.

usage: sizes.py [--root DIR] [--print]

Fails on a source file above 400 lines, on a function above 60 lines (in core and render, where kernels are, on more such
functions than LONG_FUNCTIONS allows), on a top-level folder with more than 30 % of the source lines (tests not counted),
and on a header that does not begin with a comment. --print shows the longest functions and the lines of each room.
"""
import argparse
import os
import re
import sys

import rooms

FILE_LINES = 400
FUNCTION_LINES = 60
FOLDER_SHARE = 0.30
LONG_FUNCTIONS = {"core": 0, "render": 3}  # fewer is better; more is not allowed

TEMPLATE = re.compile(r"\btemplate\s*<[^<>]*(?:<[^<>]*(?:<[^<>]*>[^<>]*)*>[^<>]*)*>")


def plain(text):
    """The text with the same line breaks, without comments, preprocessor lines and the inside of literals."""
    def blank(match):
        return '""' + "\n" * match[0].count("\n") if match[0][0] in "\"R'" else "\n" * match[0].count("\n")

    text = re.sub(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\'',
                  blank, text, flags=re.S)
    return re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", lambda m: "\n" * m[0].count("\n"), text, flags=re.M)


def kind_of(head):
    """What a brace opens that stands after `head`, outside of functions."""
    head = TEMPLATE.sub(" ", head).strip()
    if re.search(r"\bnamespace\b|^extern\s*\"\"$", head):
        return "scope"
    if head.endswith("="):
        return "value"
    if ")" not in head:
        return "scope" if re.search(r"\b(class|struct|union|enum)\b", head) else "value"
    if re.search(r"^\s*(class|struct|union)\b[^()]*(alignas\s*\([^()]*\))?[^()]*$", head):
        return "scope"
    # a constructor's `: member_{..}` before its body
    if re.search(r"\)\s*(noexcept\s*)?:(?!:)", head) and re.search(r"[\w>]$", head) and not re.search(r"\bconst$", head):
        return "value"
    return "function"


def functions(text):
    """(first line, last line, name) of each function with a body."""
    text = plain(text)
    found, stack, head, start, line = [], [], "", None, 1
    for c in text:
        if c == "\n":
            line += 1
        inside = stack and stack[-1][0] in ("function", "value")
        if c == "{":
            kind = "function" if stack and stack[-1][0] == "function" else "value" if inside else kind_of(head)
            stack.append((kind, head, start or line, inside))
            if kind != "value":
                head, start = "", None
        elif c == "}" and stack:
            kind, opened, first, nested = stack.pop()
            if kind == "function" and not nested:
                name = re.findall(r"([\w~:]+|operator\S+)\s*\(", TEMPLATE.sub(" ", opened))
                found.append((first, line, name[0] if name else "?"))
            if kind != "value":
                head, start = "", None
        elif inside:
            continue
        elif c == ";":
            head, start = "", None
        else:
            if start is None and not c.isspace():
                start = line
            head += c
            if head.strip() in ("public:", "private:", "protected:"):
                head, start = "", None
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    here = os.path.dirname(os.path.abspath(__file__))
    parser.add_argument("--root", default=os.path.dirname(os.path.dirname(here)))
    parser.add_argument("--print", action="store_true", help="show the longest functions and the lines of each room")
    options = parser.parse_args()

    found, lengths, folders, by_room = [], [], {}, {}
    for file in rooms.sources(options.root):
        with open(os.path.join(options.root, file), encoding="utf-8") as f:
            text = f.read()
        lines, top, room = text.count("\n"), file.split("/")[0], os.path.dirname(file)
        folders[top] = folders.get(top, 0) + lines
        by_room[room] = by_room.get(room, 0) + lines
        if lines > FILE_LINES:
            found.append(f"{file} has {lines} lines, more than {FILE_LINES}")
        if file.endswith(".h") and not re.match(r"//\s*\S.{10,}", text):
            found.append(f"{file} does not begin with a comment that says what it is for")
        for first, last, name in functions(text):
            lengths.append((last - first + 1, f"{file}:{first}", name))

    lengths.sort(reverse=True)
    long = {}
    for length, place, name in lengths:
        if length > FUNCTION_LINES:
            long.setdefault(place.split("/")[0], []).append(f"{place} {name} has {length} lines, more than {FUNCTION_LINES}")
    for top, places in long.items():
        if len(places) > LONG_FUNCTIONS.get(top, 0):
            found += places
            if top in LONG_FUNCTIONS:
                found.append(f"{top} has {len(places)} functions above {FUNCTION_LINES} lines; {LONG_FUNCTIONS[top]} are allowed")
    total = sum(folders.values())
    for top, lines in folders.items():
        if lines > FOLDER_SHARE * total:
            found.append(f"{top} has {lines} of {total} source lines, more than {FOLDER_SHARE:.0%}")

    if options.print:
        for length, place, name in lengths[:20]:
            print(f"{length:5} {place} {name}")
        for room in sorted(by_room):
            print(f"{by_room[room]:6} {room}")
        for top in folders:
            print(f"{folders[top]:6} {top} ({folders[top] / total:.1%})")
        print(f"{len(lengths)} functions, median {lengths[len(lengths) // 2][0]} lines")
    for fault in found:
        print(fault)
    print(f"sizes: {len(found)} faults" if found else
          f"sizes: {len(lengths)} functions, median {lengths[len(lengths) // 2][0]} lines; longest: "
          + ", ".join(f"{name} {length}" for length, _, name in lengths[:3]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

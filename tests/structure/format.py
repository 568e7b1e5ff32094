#!/usr/bin/env python3
"""Every C++ source is as clang-format-19 and .clang-format write it.

usage: format.py [--root DIR]

Prints the files that are not. To mend them: clang-format-19 -i FILE..
"""
import argparse
import concurrent.futures
import os
import shutil
import subprocess
import sys

import rooms


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    here = os.path.dirname(os.path.abspath(__file__))
    parser.add_argument("--root", default=os.path.dirname(os.path.dirname(here)))
    options = parser.parse_args()
    tool = shutil.which("clang-format-19")
    if not tool:
        print("format: clang-format-19 is missing: run scripts/lab setup --test")
        return 1
    files = list(rooms.sources(options.root, rooms.FOLDERS + ["tests"]))
    batches = [files[i:i + 40] for i in range(0, len(files), 40)]

    def run(batch):
        command = [tool, "--dry-run", "--style=file", "--ferror-limit=1"] + batch
        err = subprocess.run(command, cwd=options.root, capture_output=True, text=True, check=True).stderr
        return {line.split(":")[0] for line in err.splitlines() if "[-Wclang-format-violations]" in line}

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        bad = sorted(set().union(*pool.map(run, batches)))
    for file in bad:
        print(f"{file} is not formatted")
    print(f"format: {len(bad)} of {len(files)} files are not formatted: clang-format-19 -i {' '.join(bad)}" if bad
          else f"format: {len(files)} files are formatted")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())

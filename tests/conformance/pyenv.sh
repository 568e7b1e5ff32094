#!/bin/sh
# Makes FOLDER a Python environment with LCM's own bindings and honcho, once: tests/conformance/pyenv.sh FOLDER
# Exit 77 (ctest: skipped) where there is no Python with venv, or no way to the package.
set -eu
folder=$1
"$folder/bin/python3" -c 'import lcm, honcho' 2>/dev/null && exit 0
rm -rf "$folder"
python3 -m venv "$folder" 2>/dev/null || { echo "no python3 with venv: Python conformance is not tested" >&2; exit 77; }
timeout 120 "$folder/bin/python3" -m pip install --quiet --disable-pip-version-check --retries 1 --timeout 15 --only-binary :all: lcm==1.5.3 honcho==2.0.0 || {
  echo "lcm 1.5.3 and honcho 2.0.0 cannot be installed with pip: Python conformance is not tested" >&2
  rm -rf "$folder"
  exit 77
}

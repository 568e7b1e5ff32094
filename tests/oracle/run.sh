#!/usr/bin/env bash
# Compares the lab with Pinocchio (PyPI `pin` 4.1.0). Nothing of the lab depends on it; ctest runs it where pip can install it.
#
# usage: tests/oracle/run.sh [ARGS for pytest]     (LAB_BUILD: the build to test, default build/release)
#        tests/oracle/run.sh --render          (link ids and depth of pictures against PyPI `mujoco` 4.0.0)
#        tests/oracle/run.sh --urdf-corpus         (writes docs/urdf_corpus.md: our URDF reader beside others)
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
environment=$root/build/oracle
if [ ! -x "$environment/bin/pytest" ]; then
  rm -rf "$environment"
  { python3 -m venv "$environment" &&
    timeout 300 "$environment/bin/pip" install -q --disable-pip-version-check --retries 1 --timeout 15 --only-binary :all: pin==4.1.0 pytest; } || {
    echo "pin 4.1.0 cannot be installed with pip: nothing is compared with it" >&2
    rm -rf "$environment"
    exit 77 # ctest: skipped
  }
fi
# shellcheck source=scripts/lib.sh
. "$root/scripts/lib.sh" # LAB_PACKAGE_PATH, where `lab robots` put them
if [ "${1:-}" = --urdf-corpus ]; then
  "$environment/bin/pip" install -q mujoco==4.0.0
  "$root/scripts/lab" build --target urdf_corpus_write --target urdfdom_read
  "$environment/bin/python" "$root/tests/oracle/urdf_corpus.py" "$root/build/release" >"$environment/urdf_corpus.md"
  mv "$environment/urdf_corpus.md" "$root/docs/urdf_corpus.md"
  exit
fi
export LAB_ROBOTS
if [ "${1:-}" = --render ]; then
  "$environment/bin/pip" install -q mujoco==4.0.0
  "$root/scripts/lab" build --target bench-render
  set -- -k test_ids_and_depth "${@:2}"
fi
exec "$environment/bin/pytest" -q -s -p no:cacheprovider "$root/tests/oracle" "$@"

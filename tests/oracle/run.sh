#!/usr/bin/env bash
# Compares the lab with Pinocchio (PyPI `pin` 4.1.0). Optional: nothing of the lab depends on it.
#
# usage: tests/oracle/run.sh [ARGS for pytest]     (LAB_BUILD: the build to test, default build/release)
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
environment=$root/build/oracle
if [ ! -x "$environment/bin/pytest" ]; then
  rm -rf "$environment"
  python3 -m venv "$environment"
  "$environment/bin/pip" install -q pin==4.1.0 pytest
fi
# shellcheck source=scripts/lib.sh
. "$root/scripts/lib.sh" # LAB_PACKAGE_PATH, where `lab robots` put them
exec "$environment/bin/pytest" -q -s -p no:cacheprovider "$root/tests/oracle" "$@"

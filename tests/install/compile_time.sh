#!/usr/bin/env bash
# A file that includes <rbd/rbd.h> and calls rnea, aba and crba compiles in less than 5 s of processor time (the best of
# three: a busy machine makes compilers slower, never faster).
# usage: compile_time.sh BUILD_DIR COMPILER
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
build=$1 compiler=$2 limit=5.0 best=999
read -ra eigen <<<"$(pkg-config --cflags eigen3)"
TIMEFORMAT=%U
for _ in 1 2 3; do
  seconds=$( { time "$compiler" -std=c++20 -O2 "-I$here/../../core" "${eigen[@]}" -c "$here/dynamics.cc" \
    -o "$build/compile_time.o" >&2; } 2>&1 ) || { echo "$seconds" && exit 1; }
  best=$(awk -v a="$best" -v b="$seconds" 'BEGIN { print (b + 0 < a + 0 ? b : a) }')
done
echo "user time $best s, limit $limit s"
awk -v a="$best" -v b="$limit" 'BEGIN { exit !(a + 0 > 0 && a + 0 < b + 0) }'

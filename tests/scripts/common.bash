# shellcheck shell=bash
# What the script tests share. Stand-ins for programs are shell lines that carry $mark, so that survivors can be found.
ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
LAB=$ROOT/scripts/lab

common_setup() {
  unset CI LAB_ISOLATED LAB_ISOLATION LAB_LAUNCH LAB_CONTROL LCM_DEFAULT_URL NO_COLOR
  export LAB_BUILD=$BATS_TEST_TMPDIR/build LAB_RUNS=$BATS_TEST_TMPDIR/runs XDG_CACHE_HOME=$BATS_TEST_TMPDIR/cache
  mark=standin-$$-$BATS_TEST_NUMBER-$RANDOM
  group=$BATS_TEST_TMPDIR/group
  nap="read -rt 30 <> <(:)" # a process that does nothing for a while, without the word that scripts avoid
}

survivors() { pgrep -f "$mark" || true; }

# eventually SECONDS COMMAND..: true within that time
eventually() {
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    [ $SECONDS -lt "$end" ] || return 1
    read -rt 0.02 <> <(:) || true
  done
}
gone() { [ -z "$(survivors)" ]; }

# supervise LINE..: a group from Procfile lines, in the test's folder
supervise() {
  printf '%s\n' "$@" >"$BATS_TEST_TMPDIR/Procfile"
  # shellcheck disable=SC2086  # several options
  "$ROOT/scripts/supervise" --dir "$group" ${flags:-} "$BATS_TEST_TMPDIR/Procfile"
}

# the same behind our back: its pid is $boss, its output in $out
supervise_in_background() {
  printf '%s\n' "$@" >"$BATS_TEST_TMPDIR/Procfile"
  out=$BATS_TEST_TMPDIR/out
  # shellcheck disable=SC2086  # several options
  "$ROOT/scripts/supervise" --dir "$group" ${flags:-} "$BATS_TEST_TMPDIR/Procfile" >"$out" 2>&1 3>&- &
  boss=$! # process substitutions change $!
}

# code_of PID: waits for it, sets status
code_of() {
  status=0
  wait "$1" || status=$?
}

common_teardown() { # a failed test must not leave its stand-ins behind
  local pids
  pids=$(survivors)
  # shellcheck disable=SC2086  # several pids
  [ -z "$pids" ] || kill -KILL $pids
}

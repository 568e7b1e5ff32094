#!/usr/bin/env bats
# lab ls, clean and robots: what is a run, what may be removed, and nothing half done in the cache.
load common

setup() {
  common_setup
  # clean removes builds: give it a project of its own
  mkdir -p "$BATS_TEST_TMPDIR/project/build/release" "$BATS_TEST_TMPDIR/project/build/asan" "$BATS_TEST_TMPDIR/project/build/mine"
  cp -r "$ROOT/scripts" "$BATS_TEST_TMPDIR/project/"
  touch "$BATS_TEST_TMPDIR/project/build/"{release,asan}/CMakeCache.txt
  LAB=$BATS_TEST_TMPDIR/project/scripts/lab
}
teardown() { common_teardown; }

make_run() { # NAME [EXIT_CODE]
  mkdir -p "$LAB_RUNS/$1"
  echo '# As run; made from a file.' >"$LAB_RUNS/$1/experiment.yaml"
  [ $# -lt 2 ] || cp "$ROOT/tests/golden/log_without_checksums.lcm" "$LAB_RUNS/$1/log.lcm"
  [ $# -lt 2 ] || echo "{\"lcmlab\": \"0\", \"state\": \"ended\", \"files\": [\"experiment.yaml\", \"manifest.json\", \"log.lcm\"],
    \"exit_codes\": {\"run\": $2}, \"experiment\": \"$1\", \"last_step\": 7}" >"$LAB_RUNS/$1/manifest.json"
}
make_runs() {
  make_run good 0
  make_run missed 1
  make_run died 5
  make_run stopped 130
  make_run killed
  make_run logless 0
  rm "$LAB_RUNS/logless/log.lcm"
  mkdir "$LAB_RUNS/notes"
  ln -s good "$LAB_RUNS/latest"
}

@test "ls: each run once, with its verdict" {
  make_runs
  run "$LAB" ls
  [ "$status" -eq 0 ]
  [ "${#lines[@]}" -eq 6 ]
  grep -qE '^good +ok ' <<<"$output"
  grep -qE '^missed +failed ' <<<"$output"
  grep -qE '^died +exit 5 ' <<<"$output"
  grep -qE '^stopped +stopped ' <<<"$output"
  grep -qE '^killed +unfinished ' <<<"$output"
  grep -qE '^logless +no log ' <<<"$output"
}

@test "ls: a log that does not end with END is not ok" {
  make_run cut 0
  truncate -s -5 "$LAB_RUNS/cut/log.lcm"
  run "$LAB" ls
  grep -qE '^cut +cut log ' <<<"$output"
}

@test "ls --json is JSON, and a run that holds its lock is alive" {
  make_runs
  exec {lock}<"$LAB_RUNS/killed"
  flock -n "$lock"
  "$LAB" ls --json | python3 -c '
import json, sys
runs = {r["name"]: r for r in json.load(sys.stdin)}
assert len(runs) == 6 and runs["killed"]["verdict"] == "alive" and runs["good"]["steps"] == 7, runs'
  exec {lock}<&-
}

@test "ls of nothing is nothing; of no run is 2" {
  run "$LAB" ls
  [ "$status" -eq 0 ] && [ -z "$output" ]
  run "$LAB" ls ghost
  [ "$status" -eq 2 ]
}

@test "clean: asks, and without a yes removes nothing" {
  make_runs
  run "$LAB" clean good <<<n
  [ "$status" -eq 1 ]
  [ -d "$LAB_RUNS/good" ]
  run "$LAB" clean good <<<y
  [ "$status" -eq 0 ]
  [ ! -e "$LAB_RUNS/good" ]
  [ ! -L "$LAB_RUNS/latest" ]
}

@test "clean without names: unfinished runs and the builds beside release" {
  make_runs
  run "$LAB" clean --yes
  [ "$status" -eq 0 ]
  [ "$(ls "$LAB_RUNS" | xargs)" = "died good latest logless missed notes stopped" ]
  [ "$(ls "$BATS_TEST_TMPDIR/project/build" | xargs)" = "mine release" ]
}

@test "clean --all: every run and build, never what is neither" {
  make_runs
  run "$LAB" clean --all --yes
  [ "$status" -eq 0 ]
  [ "$(ls "$LAB_RUNS")" = notes ]
  [ "$(ls "$BATS_TEST_TMPDIR/project/build")" = mine ]
}

@test "clean leaves what a run did not write, and a folder with it" {
  make_runs
  mkdir -p "$LAB_RUNS/died/frames" "$BATS_TEST_TMPDIR/mine"
  touch "$LAB_RUNS/good/notes.txt" "$LAB_RUNS/killed/log.lcm.part" "$LAB_RUNS/killed/catalogue.lcm" "$BATS_TEST_TMPDIR/mine/0001.png"
  ln -s "$BATS_TEST_TMPDIR/mine" "$LAB_RUNS/killed/frames"
  run "$LAB" clean --all --yes
  [ "$status" -eq 0 ]
  [[ $output == *"good stays"*notes.txt* ]]
  [ "$(ls "$LAB_RUNS/good" "$LAB_RUNS/killed" | xargs)" = "$LAB_RUNS/good: notes.txt $LAB_RUNS/killed: catalogue.lcm frames" ]
  [ -f "$BATS_TEST_TMPDIR/mine/0001.png" ]
}

@test "clean takes no name out of a forged manifest that is not in the folder" {
  make_run forged 0
  touch "$LAB_RUNS/kept.yaml"
  for name in ../kept.yaml "$LAB_RUNS/kept.yaml" frames/../../kept.yaml; do
    echo "{\"lcmlab\": \"0\", \"state\": \"ended\", \"files\": [\"$name\"]}" >"$LAB_RUNS/forged/manifest.json"
    run "$LAB" clean --yes forged
    [ "$status" -eq 1 ]
    [[ $output == *"is not a file of a run"* ]]
    [ -f "$LAB_RUNS/kept.yaml" ]
  done
}

@test "clean refuses what is no run, and a run that is alive" {
  make_runs
  for victim in notes "$BATS_TEST_TMPDIR/project/scripts" /etc; do
    run "$LAB" clean --yes "$victim"
    [ "$status" -eq 2 ]
    [ -d "$LAB_RUNS/notes" ]
  done
  exec {lock}<"$LAB_RUNS/killed"
  flock -n "$lock"
  run "$LAB" clean --yes killed
  [ "$status" -eq 2 ]
  run "$LAB" clean --yes
  [ -d "$LAB_RUNS/killed" ]
  exec {lock}<&-
}

# A state file is a text that anybody can write into a folder of his own, and old ones name pids that the kernel has given away.
forge_state() { # PID BEGAN: a folder that looks like a running lab whose supervisor is that process
  make_run forged
  mkdir -p "$LAB_RUNS/forged/processes"
  mkfifo "$LAB_RUNS/forged/processes/control"
  printf 'supervisor %s %s\nisolation none\nurl udpm://239.255.76.67:7667\nphase running\n' "$1" "$2" >"$LAB_RUNS/forged/processes/state"
  exec {held}<"$LAB_RUNS/forged"
  flock -s "$held"
}

@test "down signals nobody because of a forged folder, and ends at once" {
  bash -c "$nap; : $mark" 3>&- &
  stranger=$!
  read -r up _ </proc/uptime
  forge_state "$stranger" "$((10#${up//./} * 10 + 1000))"
  run timeout 10 "$LAB" down --lab "$LAB_RUNS/forged" --timeout 1
  [ "$status" -eq 2 ]
  [[ $output == *"is not running"* ]]
  kill -0 "$stranger"
  run "$LAB" down --all
  [ "$status" -eq 0 ]
  kill -0 "$stranger"
}

@test "a supervisor counts only when it is one, of this folder, and as old as the state says" {
  export LAB_RUN_DIR=$LAB_RUNS/real
  mkdir -p "$LAB_RUNS/real/processes"
  touch "$LAB_RUNS/real/experiment.yaml"
  group=$LAB_RUNS/real/processes
  supervise_in_background "simulator: $nap; : $mark"
  eventually 10 test -s "$group/state"
  lives() { bash -c '. "$0/lib.sh" && supervisor_lives "$1"' "$ROOT/scripts" "$LAB_RUNS/real"; }
  lives
  cp "$group/state" "$BATS_TEST_TMPDIR/state"
  sed -i 's/^supervisor \([0-9]*\) .*/supervisor \1 5/' "$group/state" # the pid was given away since
  ! lives || false
  cp "$BATS_TEST_TMPDIR/state" "$group/state"
  make_run other
  mkdir -p "$LAB_RUNS/other/processes"
  cp "$group/state" "$LAB_RUNS/other/processes/state" # another lab's supervisor
  run bash -c '. "$0/lib.sh" && supervisor_lives "$1"' "$ROOT/scripts" "$LAB_RUNS/other"
  [ "$status" -ne 0 ]
  echo STOP >"$group/control"
  code_of $boss
  ! lives || false
}

# One lab for each port and prefix, whoever started it.
@test "bus-lock: the first free port, and a refusal that names the owner" {
  lock() { "$ROOT/scripts/bus-lock" "$@" -- bash -c 'echo "$LAB_BUS_PORT" >"$0"; read -rt 20 <> <(:); : '"$mark" "$BATS_TEST_TMPDIR/port$RANDOM"; }
  lock "" 46501 46502 3>&- &
  eventually 10 grep -q "@lcmlab:46501:" /proc/net/unix
  run "$ROOT/scripts/bus-lock" "" 46501 46502 -- bash -c 'echo "$LAB_BUS_PORT"'
  [ "$output" = 46502 ]
  run "$ROOT/scripts/bus-lock" LEFT_ 46501 -- bash -c 'echo "$LAB_BUS_PORT"'
  [ "$output" = 46501 ]
  run "$ROOT/scripts/bus-lock" "" 46501 -- true
  [ "$status" -eq 2 ]
  [[ $output == *"port 46501 has a lab already, of $(id -un), pid "* ]]
}

@test "robots: a package with another hash is refused and leaves nothing" {
  echo "not a robot" >"$BATS_TEST_TMPDIR/fake.whl"
  LAB_ROBOTS_WHEEL=$BATS_TEST_TMPDIR/fake.whl run "$LAB" robots
  [ "$status" -eq 1 ]
  [[ $output == *"fake.whl is not the package that was pinned: sha256 is "* ]]
  [ -z "$(ls -A "$XDG_CACHE_HOME/lcmlab/robots")" ]
  run "$LAB" robots --path
  [ "$status" -eq 1 ]
}

@test "robots: already there is silent, and the package path is set" {
  there=$XDG_CACHE_HOME/lcmlab/robots/example-robot-data-6.0.0
  mkdir -p "$there/example-robot-data"
  run "$LAB" robots
  [ "$status" -eq 0 ] && [ -z "$output" ]
  [ "$("$LAB" robots --path)" = "$there" ]
  run bash -c ". '$ROOT/scripts/lib.sh'; echo \$LAB_PACKAGE_PATH"
  [[ $output == *"$there"* ]]
}

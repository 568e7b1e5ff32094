#!/usr/bin/env bats
# lab run around stand-in programs: run folders, exit codes, signals, and that nothing outlives it. The stand-ins read
# their behaviour from the experiment file: its lines are the Procfile.
load common

setup() {
  common_setup
  mkdir -p "$LAB_BUILD/bin"
  cat >"$LAB_BUILD/bin/lab-experiment" <<'IN'
#!/usr/bin/env bash
case $1 in
  resolve) shift; out=/dev/stdout
    while [ $# -gt 0 ]; do case $1 in -o) out=$2; shift 2 ;; --set) sets+=" $2"; shift 2 ;; *) in=$1; shift ;; esac; done
    grep -q bad "$in" && { echo "$in:1: bad: this is wrong, do that" >&2; exit 3; }
    { echo "# As run" && cat "$in"; } >"$out" && [ -z "${sets:-}" ] || echo "# set$sets" >>"$out" ;;
  processes) grep -v '^# As run' "$2" ;;
  evaluate) echo '{}' >"$2/metrics.json"; echo "tracking: ok"; ! grep -q unexpected "$2/experiment.yaml" ;;
  report) ! grep -q unpaintable "$2/experiment.yaml" && echo page >"$2/report.html" ;;
  manifest) dir=$2; shift 2; sed -i 's/"state": "running"/"state": "ended"/' "$dir/manifest.json"; echo "$*" >>"$dir/manifest.json" ;;
esac
IN
  chmod +x "$LAB_BUILD/bin/lab-experiment"
  experiment=$BATS_TEST_TMPDIR/trial.yaml
}
teardown() { common_teardown; }

given() { printf '%s\n' "$@" >"$experiment"; }
lab_run() { "$LAB" run "$experiment" "$@"; }
lab_run_in_background() {
  out=$BATS_TEST_TMPDIR/out
  "$LAB" run "$experiment" "$@" >"$out" 2>&1 3>&- &
  boss=$!
}
log_has() { grep -q "$2" "$LAB_RUNS/trial/processes/$1.log" 2>/dev/null; }

@test "a good run: folder, verdict, manifest with exit codes, latest" {
  given "simulator: true # $mark" "planner: true # $mark"
  run lab_run --set a.b=c
  [ "$status" -eq 0 ]
  [[ $output == *"tracking: ok"* ]]
  [ "$(readlink "$LAB_RUNS/latest")" = trial ]
  grep -q '# set a.b=c' "$LAB_RUNS/latest/experiment.yaml"
  manifest=$(cat "$LAB_RUNS/latest/manifest.json")
  [[ $manifest == *"--exit simulator=0"* && $manifest == *"--exit planner=0"* && $manifest == *"--exit run=0"* ]]
  run lab_run
  [ "$(readlink "$LAB_RUNS/latest")" = trial-2 ]
  [ -z "$(find "$LAB_RUNS" -name '.*' -not -path "$LAB_RUNS")" ]
}

@test "a report at the end, unless it is not wanted; the verdict does not depend on it" {
  given "simulator: true # $mark"
  run lab_run
  [ "$status" -eq 0 ]
  [[ $output == *"report.html"* ]]
  [ -s "$LAB_RUNS/trial/report.html" ]
  run lab_run --no-report
  [ "$status" -eq 0 ]
  [ ! -e "$LAB_RUNS/trial-2/report.html" ]
  given "simulator: true # unpaintable $mark"
  run lab_run
  [ "$status" -eq 0 ]
  [[ $output == *"there is no report for this run"* ]]
}

@test "a missed expectation is 1" {
  given "simulator: true # unexpected $mark"
  run lab_run
  [ "$status" -eq 1 ]
}

@test "a bad experiment is 3, one line, no folder" {
  given "bad: true"
  run lab_run
  [ "$status" -eq 3 ]
  [ "$output" = "$experiment:1: bad: this is wrong, do that" ]
  [ -z "$(ls -A "$LAB_RUNS")" ]
}

@test "an experiment that does not exist is 3, and near names are told" {
  run "$LAB" run sinusoid_tc
  [ "$status" -eq 3 ]
  [ "$output" = "lab run: there is no experiment 'sinusoid_tc'; near names: sinusoid_ct sinusoid_pd (experiments/ has some to start from)" ]
  run "$LAB" run experiments/cubic_pdd.yaml
  [ "$status" -eq 3 ]
  [[ $output == *"'experiments/cubic_pdd.yaml'; near names: cubic_pd "* ]]
}

@test "a process that dies is 5 and the manifest is written" {
  given "simulator: $nap; : $mark" "controller: exit 1 # $mark"
  run lab_run
  [ "$status" -eq 5 ]
  grep -q 'controller=1' "$LAB_RUNS/trial/manifest.json"
  grep -q 'run=5' "$LAB_RUNS/trial/manifest.json"
}

@test "-o: a strange folder is refused, an old run is replaced, unwritable is one line" {
  given "simulator: true # $mark"
  mkdir "$BATS_TEST_TMPDIR/mine" && touch "$BATS_TEST_TMPDIR/mine/thesis.tex"
  run lab_run -o "$BATS_TEST_TMPDIR/mine"
  [ "$status" -eq 2 ]
  [ "$(ls "$BATS_TEST_TMPDIR/mine")" = thesis.tex ]
  run lab_run -o "$BATS_TEST_TMPDIR/there"
  [ "$status" -eq 0 ]
  mkdir -p "$BATS_TEST_TMPDIR/there/frames"
  touch "$BATS_TEST_TMPDIR/there/"{log.lcm,notes.txt,log-2.earlier.lcm,frames/0001.png,processes/old.log.1}
  run lab_run -o "$BATS_TEST_TMPDIR/there"
  [ "$status" -eq 0 ]
  for old in log.lcm log-2.earlier.lcm frames processes/old.log.1; do [ ! -e "$BATS_TEST_TMPDIR/there/$old" ]; done
  [ -f "$BATS_TEST_TMPDIR/there/notes.txt" ]
  run lab_run -o /proc/nothing
  [ "$status" -eq 2 ]
  [ "${#lines[@]}" -eq 1 ]
  [ ! -e "$LAB_RUNS/latest" ]
}

@test "-o: a person's own experiment.yaml, pictures and log are not a run" {
  given "simulator: true # $mark"
  mkdir -p "$BATS_TEST_TMPDIR/mine/frames"
  echo 'robot: {}' >"$BATS_TEST_TMPDIR/mine/experiment.yaml"
  echo '{"name": "my web page"}' >"$BATS_TEST_TMPDIR/mine/manifest.json"
  touch "$BATS_TEST_TMPDIR/mine/"{frames/0001.png,log.lcm}
  before=$(find "$BATS_TEST_TMPDIR/mine" -type f -exec cksum {} + | sort)
  cd "$BATS_TEST_TMPDIR/mine"
  run lab_run -o .
  [ "$status" -eq 2 ]
  [ "$(find "$BATS_TEST_TMPDIR/mine" -type f -exec cksum {} + | sort)" = "$before" ]
}

@test "a run's manifest is there from the beginning, and says that it runs" {
  given "simulator: cat $LAB_RUNS/trial/manifest.json >seen; true # $mark"
  cd "$BATS_TEST_TMPDIR"
  run lab_run
  [ "$status" -eq 0 ]
  grep -q '"state": "running"' seen
  ! grep -q '"state": "running"' "$LAB_RUNS/trial/manifest.json"
}

@test "two runs in one folder: the second is refused" {
  given "simulator: echo up; $nap; : $mark"
  lab_run_in_background -o "$LAB_RUNS/trial"
  eventually 10 log_has simulator up
  run lab_run -o "$LAB_RUNS/trial"
  [ "$status" -eq 2 ]
  [[ $output == *"another run is active"* ]]
  kill -INT "$boss"
  code_of "$boss"
}

@test "usage errors are 2" {
  given "simulator: true"
  for words in "--nonsense" "--timeout soon" "--set" "second.yaml"; do
    # shellcheck disable=SC2086
    run lab_run $words
    [ "$status" -eq 2 ]
  done
  run "$LAB" run
  [ "$status" -eq 2 ]
}

# the ways of isolation, each with a clean end by INT and a kill -9
each_way() {
  local way
  for way in net user port; do
    if [ "$way" = port ] || LAB_ISOLATION=$way "$ROOT/scripts/isolate" true 2>/dev/null; then echo "$way"; fi
  done
}

@test "INT once is graceful: 130, the manifest has it, no process is left" {
  given "simulator: trap 'echo clean; exit 0' INT; echo up; while :; do read -rt 1 <> <(:); done; : $mark" \
    "logger: trap 'echo flushed; exit 0' INT; echo up; while :; do read -rt 1 <> <(:); done; : $mark"
  for way in $(each_way); do
    rm -rf "$LAB_RUNS"
    LAB_ISOLATION=$way lab_run_in_background
    eventually 10 log_has simulator up
    eventually 10 log_has logger up
    kill -INT "$boss"
    code_of "$boss"
    [ "$status" -eq 130 ]
    log_has logger flushed
    grep -q 'run=130' "$LAB_RUNS/trial/manifest.json"
    eventually 2 gone
  done
}

@test "INT twice kills" {
  given "simulator: trap '' INT TERM; echo up; while :; do read -rt 1 <> <(:); done; : $mark"
  for way in $(each_way); do
    rm -rf "$LAB_RUNS"
    LAB_ISOLATION=$way lab_run_in_background
    eventually 10 log_has simulator up
    kill -INT "$boss"
    eventually 5 grep -q 'send INT' "$LAB_RUNS/trial/processes/supervisor.log"
    kill -INT "$boss"
    code_of "$boss"
    [ "$status" -eq 130 ]
    eventually 2 gone
  done
}

@test "kill -9 of run: every process goes, stubborn grandchildren too, and no namespace stays" {
  given "simulator: trap '' INT TERM HUP; echo up; while :; do read -rt 1 <> <(:); done; : $mark" \
    "planner: (trap '' INT TERM HUP; while :; do read -rt 1 <> <(:); done; : $mark) & $nap; : $mark"
  for way in $(each_way); do
    [ "$way" = port ] && continue # without namespaces, grandchildren can escape
    rm -rf "$LAB_RUNS"
    LAB_ISOLATION=$way lab_run_in_background
    eventually 10 log_has simulator up
    kill -KILL "$boss"
    code_of "$boss"
    eventually 2 gone
  done
  [ -z "$(pgrep -f "$LAB_RUNS")" ] # a namespace lives only in its processes
}

@test "kill -9 of run without namespaces: its processes go too" {
  given "simulator: trap '' INT TERM HUP; echo up; while :; do read -rt 1 <> <(:); done; : $mark" "planner: $nap; : $mark"
  LAB_ISOLATION=port lab_run_in_background
  eventually 10 log_has simulator up
  kill -KILL "$boss"
  code_of "$boss"
  eventually 2 gone
}

@test "the first way of isolation that works is taken" {
  mapfile -t ways < <(each_way) # a network namespace, the same in a user namespace, a port
  run "$ROOT/scripts/isolate" bash -c 'echo "$LAB_ISOLATED"'
  [ "$output" = "${ways[0]}" ]
}

@test "root without CAP_SYS_ADMIN runs in a user namespace" {
  [ "$(id -u)" -eq 0 ] || skip "needs root"
  given "simulator: echo \$LAB_ISOLATED # $mark"
  run setpriv --bounding-set -sys_admin "$LAB" run "$experiment"
  [ "$status" -eq 0 ]
  [[ $(cat "$LAB_RUNS/trial/processes/simulator.log") =~ ^(user|port)$ ]]
}

@test "two runs at once have two buses" {
  given "simulator: echo \$LCM_DEFAULT_URL \$(readlink /proc/self/ns/net); read -rt 1 <> <(:); true # $mark"
  for way in $(each_way); do
    rm -rf "$LAB_RUNS"
    LAB_ISOLATION=$way lab_run_in_background
    LAB_ISOLATION=$way run lab_run
    code_of "$boss"
    [ "$(cat "$LAB_RUNS"/trial{,-2}/processes/simulator.log | sort -u | wc -l)" -eq 2 ]
  done
}

@test "nested in isolate, the run shares its bus" {
  given "simulator: readlink /proc/self/ns/net # $mark"
  run "$ROOT/scripts/isolate" bash -c "readlink /proc/self/ns/net; '$LAB' run '$experiment' >/dev/null 2>&1"
  [ "$status" -eq 0 ]
  [ "$output" = "$(cat "$LAB_RUNS/trial/processes/simulator.log")" ]
}

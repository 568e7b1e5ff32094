#!/usr/bin/env bats
# The supervisor, with stand-in processes: which ones end, in what order, with which code, and that none is left.
load common
setup() { common_setup; }
teardown() { common_teardown; }

started() { [ "$(grep -c ' start ' "$group/supervisor.log" 2>/dev/null)" = "$1" ]; }
# the first time at which the supervisor noted that, in hundredths of a second
at() { sed -n "s/^ *\([0-9]*\)[.]\([0-9]*\) $1.*/\1\2/p" "$group/supervisor.log" | sed '1s/^0*\(.\)/\1/;q'; }
order_of() { sed -n "s/.* $1 \([a-z]*\).*/\1/p" "$group/supervisor.log" | xargs; }

@test "all end by themselves: exit 0, codes on stdout, output in files" {
  run supervise "simulator: echo tick; echo tock >&2 # $mark" "planner: true # $mark"
  [ "$status" -eq 0 ]
  [ "$(sort <<<"$output")" = $'planner 0\nsimulator 0' ]
  [ "$(cat "$group/simulator.log")" = $'tick\ntock' ]
}

@test "a group without a simulator ends when all have ended" {
  run supervise "one: read -rt 0.2 <> <(:); true # $mark" "two: true # $mark"
  [ "$status" -eq 0 ]
  [ "$(sort <<<"$output")" = $'one 0\ntwo 0' ]
}

@test "a required process that dies ends the group with 5, named, and takes the others along" {
  run supervise "simulator: $nap; : $mark" "logger: $nap; : $mark" "renderer: $nap; : $mark" "planner: $nap; : $mark" \
    "controller: echo last words; exit 42 # $mark"
  [ "$status" -eq 5 ]
  [[ $output == *"controller| last words"* ]]
  [[ ${lines[-1]} == *"controller ended with exit code 42"* ]]
  [ "$(order_of 'send INT to')" = "simulator planner renderer logger" ]
}

@test "a process killed from outside is named with its signal" {
  supervise_in_background "simulator: $nap; : $mark" "controller: echo \$\$ >$BATS_TEST_TMPDIR/pid; $nap; : $mark"
  eventually 10 test -s "$BATS_TEST_TMPDIR/pid"
  kill -KILL "$(cat "$BATS_TEST_TMPDIR/pid")"
  code_of $boss
  [ "$status" -eq 5 ]
  grep -q "controller was killed by signal 9 (KILL)" "$out"
}

@test "exit codes 3, 4, 6 and 7 of a process are the group's" {
  for c in 3 4 6 7; do
    run supervise "simulator: $nap; : $mark" "planner: exit $c # $mark"
    [ "$status" -eq "$c" ]
  done
}

@test "a process that is not required may fail" {
  run supervise "#lab: renderer required=no" "simulator: read -rt 0.3 <> <(:); true # $mark" "renderer: exit 9 # $mark"
  [ "$status" -eq 0 ]
  [[ $output == *"renderer ended with exit code 9"* ]]
}

@test "after the simulator the others finish in their own time, the logger last" {
  run supervise "simulator: true # $mark" "planner: read -rt 0.2 <> <(:); true # $mark" \
    "renderer: read -rt 0.4 <> <(:); true # $mark" "logger: trap 'echo told; exit 0' INT; $nap; : $mark"
  [ "$status" -eq 0 ]
  [ "$(order_of 'send INT to')" = logger ]
  [ "$(order_of exit)" = "simulator planner renderer logger" ]
  [ "$(cat "$group/logger.log")" = told ]
}

@test "processes that do not finish in time are stopped in order" {
  run supervise "#lab: renderer finish=0" "#lab: planner finish=0" \
    "logger: $nap; : $mark" "renderer: $nap; : $mark" "planner: $nap; : $mark" "simulator: true # $mark"
  [ "$status" -eq 0 ]
  [ "$(order_of 'send INT to')" = "planner renderer logger" ]
}

@test "a planner that missed END is told by us, long before it gives up by itself, and that is no failure" {
  run supervise "simulator: true # $mark" "planner: trap 'exit 0' INT; read -rt 5 <> <(:); exit 7 # $mark"
  [ "$status" -eq 0 ]
  [ "$(order_of 'send INT to')" = planner ]
  waited=$(($(at "send INT to planner") - $(at "exit simulator")))
  [ "$waited" -ge 100 ]
  [ "$waited" -lt 400 ]
}

@test "INT once: the simulator ends the run, the others see that, the logger is told last, 130" {
  supervise_in_background "simulator: trap 'echo ended cleanly; touch $group/end; exit 0' INT; echo up; while :; do read -rt 1 <> <(:); done; : $mark" \
    "planner: until [ -e $group/end ]; do read -rt 0.05 <> <(:); done; : $mark" \
    "logger: trap 'echo flushed; exit 0' INT; echo up; while :; do read -rt 1 <> <(:); done; : $mark"
  eventually 10 test -s "$group/logger.log"
  eventually 10 test -s "$group/simulator.log"
  kill -INT $boss
  code_of $boss
  [ "$status" -eq 130 ]
  grep -q 'ended cleanly' "$group/simulator.log"
  grep -q flushed "$group/logger.log"
  [ "$(order_of 'send [A-Z]* to')" = "simulator logger" ]
  grep -q 'exit planner 0' "$group/supervisor.log"
}

@test "INT twice kills at once" {
  supervise_in_background "simulator: trap '' INT TERM; while :; do read -rt 1 <> <(:); done; : $mark" \
    "logger: trap '' INT TERM; while :; do read -rt 1 <> <(:); done; : $mark"
  eventually 10 started 2
  kill -INT $boss
  eventually 5 grep -q 'send INT to simulator' "$group/supervisor.log"
  before=$SECONDS
  kill -INT $boss
  code_of $boss
  [ "$status" -eq 130 ]
  [ $((SECONDS - before)) -le 2 ]
  eventually 2 gone
}

@test "grandchildren that ignore TERM are gone" {
  run supervise "simulator: $nap; : $mark" "planner: (trap '' INT TERM HUP; while :; do read -rt 1 <> <(:); done; : $mark) & wait" \
    "controller: read -rt 0.3 <> <(:); exit 1 # $mark"
  [ "$status" -eq 5 ]
  eventually 2 gone
}

@test "a process that ignores INT and TERM is killed, after the time that each had" {
  run supervise "#lab: planner finish=0" \
    "planner: trap '' INT TERM; echo up; while :; do read -rt 1 <> <(:); done; : $mark" \
    "simulator: until [ -s $group/planner.log ]; do read -rt 0.05 <> <(:); done; : $mark"
  [ "$status" -eq 0 ]
  [ "$(sed -n 's/.* send \([A-Z]*\) to planner/\1/p' "$group/supervisor.log" | xargs)" = "INT TERM KILL" ]
  grep -q 'exit planner 137' "$group/supervisor.log"
  eventually 2 gone
}

@test "a process that was frozen hears the stop" {
  run supervise "simulator: $nap; : $mark" "planner: trap 'echo heard; exit 0' INT; kill -STOP \$\$; $nap; : $mark" \
    "controller: read -rt 0.3 <> <(:); exit 1 # $mark"
  [ "$status" -eq 5 ]
  [ "$(cat "$group/planner.log")" = heard ]
}

@test "a process that stays stopped is killed, and started again where it may be" {
  run supervise "#lab: planner restart=on-failure" \
    "planner: echo life; mkdir $BATS_TEST_TMPDIR/once 2>/dev/null && kill -STOP \$\$; exit 0 # $mark"
  [ "$status" -eq 0 ]
  [[ $output == *"planner has been stopped"*"for 3 s: killing it"* ]]
  [ $(($(at "send KILL to planner") - $(at "start planner"))) -ge 300 ]
  [ "$(grep -c life "$group/planner.log")" -eq 2 ]
}

@test "a supervisor that is stopped is told to go on, and keeps its --timeout" {
  flags="--timeout 1" supervise_in_background "simulator: echo up; $nap; : $mark"
  eventually 10 test -s "$group/simulator.log"
  kill -STOP $boss
  before=$SECONDS
  code_of $boss
  [ $((SECONDS - before)) -ge 1 ]
  [ $((SECONDS - before)) -lt 10 ]
  [ "$status" -eq 124 ]
  eventually 5 gone
}

@test "a keeper that is stopped reports its process' end all the same" {
  supervise_in_background "simulator: echo up; echo \$PPID >$BATS_TEST_TMPDIR/keeper; read -rt 1 <> <(:); exit 0 # $mark"
  eventually 10 test -s "$BATS_TEST_TMPDIR/keeper"
  kill -STOP "$(cat "$BATS_TEST_TMPDIR/keeper")"
  code_of $boss
  [ "$status" -eq 0 ]
}

@test "kill -9 of the supervisor: its processes go too" {
  supervise_in_background "simulator: echo up; $nap; : $mark" "planner: echo up; $nap; : $mark"
  eventually 10 test -s "$group/simulator.log" # a process that has written is tied to its keeper
  eventually 10 test -s "$group/planner.log"
  kill -KILL $boss
  code_of $boss
  eventually 5 gone
}

@test "--timeout ends with 124" {
  flags="--timeout 0.3" run supervise "simulator: $nap; : $mark"
  [ "$status" -eq 124 ]
  [[ $output == *"not done after 0.3 s"* ]]
}

@test "start order: the Procfile's, reversed, given" {
  group_lines=("simulator: true # $mark" "planner: true # $mark" "logger: true # $mark")
  run supervise "${group_lines[@]}"
  [ "$(order_of start)" = "simulator planner logger" ]
  flags="--order reversed" run supervise "${group_lines[@]}"
  [ "$(order_of start)" = "logger planner simulator" ]
  flags="--order planner" run supervise "${group_lines[@]}"
  [ "$(order_of start)" = "planner simulator logger" ]
}

@test "all get one launch nonce, another one each time" {
  supervise "simulator: echo \$LAB_LAUNCH # $mark" "planner: echo \$LAB_LAUNCH # $mark"
  first=$(cat "$group/simulator.log")
  [[ $first =~ ^[0-9]+$ ]]
  [ "$first" = "$(cat "$group/planner.log")" ]
  supervise "simulator: echo \$LAB_LAUNCH # $mark"
  [ "$first" != "$(cat "$group/simulator.log")" ]
}

@test "processes react to INT although they are background jobs" {
  run supervise "simulator: kill -INT \$\$; echo deaf; exit 0 # $mark"
  [ "$status" -eq 5 ]
  [ ! -s "$group/simulator.log" ]
}

@test "a Procfile that cannot be read is refused with 2" {
  for line in "what is this" "#lab: ghost required=no" $'#lab: a restart=sometimes\na: true' $'a: true\na: true' "# only words"; do
    run supervise "$line"
    [ "$status" -eq 2 ]
    [ "${#lines[@]}" -eq 1 ]
  done
}

@test "restart=always starts it again, until the cap; then the group fails with its name" {
  run supervise "#lab: a restart=always max=2" "a: echo life; exit 1 # $mark"
  [ "$status" -eq 5 ]
  [ "$(grep -c life "$group/a.log")" -eq 3 ]
  grep -q '^reason a ended with exit code 1' "$group/state"
  grep -q '^process a ended .* 2 1 yes always' "$group/state"
}

@test "restart=on-failure leaves a clean end alone" {
  run supervise "#lab: a restart=on-failure" "a: echo life; exit 0 # $mark"
  [ "$status" -eq 0 ]
  [ "$(grep -c life "$group/a.log")" -eq 1 ]
}

@test "back-off doubles: three quick failures take 0.1 + 0.2 s and more" {
  run supervise "#lab: a restart=always max=2" "a: exit 1 # $mark"
  mapfile -t at < <(sed -n 's/^ *\([0-9.]*\) start a.*/\1/p' "$group/supervisor.log")
  at=("${at[@]//./}") # hundredths of a second
  [ $((10#${at[1]} - 10#${at[0]})) -ge 10 ]
  [ $((10#${at[2]} - 10#${at[1]})) -ge 20 ]
}

@test "back-off is at most 5 s however often a process fails, and begins anew after 10 s of life" {
  local -A policy=([a]=always) cap=([a]=100) asked=() due=() short=() began_at=()
  local stage=0 interrupted='' t=1000000 waits=() wait
  now() { :; } # the time is ours
  # shellcheck source=scripts/lib-process.sh
  . "$ROOT/scripts/lib-process.sh"
  ends_after() { # MS: when it is due again, in ms from then
    began_at[a]=$((t - $1))
    to_be_restarted a 1
    wait=$((due[a] - t))
  }
  for _ in {1..90}; do ends_after 10 && waits+=("$wait"); done
  [ "${waits[*]:0:8}" = "100 200 400 800 1600 3200 5000 5000" ]
  [ "$(printf '%s\n' "${waits[@]:8}" | sort -u)" = 5000 ]
  ends_after 1000 # long enough not to wait, but not to be forgiven
  [ "$wait" -eq 0 ]
  ends_after 9990
  ends_after 999
  [ "$wait" -eq 5000 ]
  ends_after 10000
  [ "$wait" -eq 0 ]
  ends_after 999
  [ "$wait" -eq 100 ]
}

@test "the cap counts only failures in a row of less than 10 s of life" {
  local -A policy=([a]=always) cap=([a]=2) asked=() due=() short=() began_at=([a]=0)
  local stage=0 interrupted='' t=500
  now() { :; }
  # shellcheck source=scripts/lib-process.sh
  . "$ROOT/scripts/lib-process.sh"
  to_be_restarted a 1
  to_be_restarted a 1
  t=10000 # it has lived
  to_be_restarted a 1
  t=500
  to_be_restarted a 1
  to_be_restarted a 1
  if to_be_restarted a 1; then false; fi
}

@test "RESTART and STOP by the FIFO; 0 after STOP, and the FIFO is gone" {
  supervise_in_background "simulator: echo up; $nap; : $mark" "planner: echo up; $nap; : $mark"
  eventually 10 test -s "$group/planner.log"
  echo "RESTART planner" >"$group/control"
  eventually 5 grep -q '^process planner running .* 1 - yes never' "$group/state"
  grep -q "^process simulator running .* 0 - yes never" "$group/state"
  echo STOP >"$group/control"
  code_of $boss
  [ "$status" -eq 0 ]
  [ ! -e "$group/control" ]
  grep -q '^phase ended' "$group/state"
}

@test "a line that is read in two parts, because the time was over in between, counts" {
  supervise_in_background "simulator: $nap; : $mark"
  eventually 10 grep -q '^process simulator running [1-9]' "$group/state" # no other line is on its way
  exec {control}>"$group/control"
  printf ST >&"$control"
  read -rt 1.5 <> <(:) || true # longer than the supervisor waits for a line
  printf 'OP\n' >&"$control"
  code_of $boss
  [ "$status" -eq 0 ]
  grep -q "send INT to simulator" "$group/supervisor.log"
}

@test "the state names pids as the host sees them" {
  supervise_in_background "simulator: echo up; $nap; : $mark"
  eventually 10 test -s "$group/simulator.log"
  eventually 5 grep -qE '^process simulator running [1-9]' "$group/state"
  pid=$(sed -n 's/^process simulator running \([0-9]*\).*/\1/p' "$group/state")
  grep -q "$mark" "/proc/$pid/cmdline"
  kill -INT $boss
  code_of $boss
}

@test "output beyond the limit moves on to NAME.log.1" {
  LAB_LOG_MAX=1000 supervise_in_background "simulator: for i in {1..100}; do echo line number \$i of many; done; $nap; : $mark"
  eventually 15 test -e "$group/simulator.log.1"
  grep -q 'line number 100' "$group/simulator.log.1"
  kill -INT $boss
  code_of $boss
}

@test "output beyond 10 MB moves on to NAME.log.1" {
  supervise_in_background "simulator: head -c 10000001 /dev/zero; $nap; : $mark" "planner: head -c 10000000 /dev/zero; $nap; : $mark"
  ten_mb() { [ "$(stat -c %s "$group/planner.log")" -eq 10000000 ]; }
  eventually 20 test -e "$group/simulator.log.1"
  eventually 20 ten_mb
  kill -INT $boss
  code_of $boss
  [ ! -e "$group/planner.log.1" ]
}

@test "when the simulator restarts, all processes do, with another nonce" {
  supervise_in_background "#lab: simulator restart=always" "simulator: echo \$LAB_LAUNCH; $nap; : $mark" "planner: echo \$LAB_LAUNCH; $nap; : $mark"
  eventually 10 test -s "$group/planner.log"
  eventually 5 grep -qE '^process simulator running [1-9]' "$group/state"
  kill -KILL "$(sed -n 's/^process simulator running \([0-9]*\).*/\1/p' "$group/state")"
  two_launches() { [ "$(sort -u "$group/planner.log" | wc -l)" -eq 2 ]; }
  eventually 10 two_launches
  [ "$(sort -u "$group/simulator.log")" = "$(sort -u "$group/planner.log")" ]
  kill -INT $boss
  code_of $boss
}

@test "logs are put aside under the first number that none of them has" {
  local dir=$BATS_TEST_TMPDIR/run/processes
  mkdir -p "$dir"
  touch "$dir/.."/{log.lcm,telemetry.lcm.part,log-1.lcm,telemetry-2.lcm,log-3.lcm.part}
  # shellcheck source=scripts/lib-process.sh
  . "$ROOT/scripts/lib-process.sh"
  set_logs_aside
  [ "$(find "$dir/.." -name '*lcm*' -printf '%f\n' | sort | xargs)" = \
    "log-1.lcm log-3.lcm.part log-4.lcm telemetry-2.lcm telemetry-4.lcm.part" ]
}

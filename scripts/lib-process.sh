# shellcheck shell=bash disable=SC2004,SC2034,SC2154
# One process of a group: start, signal, restart, output. A part of scripts/supervise, which owns the variables.

# --- start, reap, signal ---------------------------------------------------------------------------------------------
# Each process has a small parent shell that leads its session, reports its end on the control pipe and ends with the
# supervisor. A signal to -PID reaches the process and its children; the terminal's Ctrl-C reaches only the caller of
# the supervisor. Background jobs of a script ignore INT: the process gets the default action back.
# (A CHLD trap would need no such shell, but bash 5.2 blocks CHLD while `read -t` waits.)
# shellcheck disable=SC2016  # expands in that shell
keeper='trap "" HUP INT QUIT TERM
control=$2
setpriv --pdeathsig KILL env --default-signal=HUP,INT,QUIT,TERM bash -c "$3" "$0" "$1" "$control" 2>&1 &
wait $!
echo "END $0 $?" >&"$control"'
# shellcheck disable=SC2016
pid_reporter='read -r pid _ </proc/self/stat
echo "PID $0 $pid" >&"$2"
eval "exec $2>&-"
exec bash -c "$1"' # reports the pid that the host sees, and becomes the command
start() {
  unset "code[$1]" "signalled[$1]" "due[$1]" "suspect[$1]" "host[$1]"
  setpriv --pdeathsig KILL setsid bash -c "$keeper" "$1" "${command[$1]}" "$control" "$pid_reporter" \
    </dev/null >>"$dir/$1.log" 2>/dev/null {journal}>&- &
  pid[$1]=$!
  disown "$!" # or bash reports it on our stderr when it is killed
  now
  began_at[$1]=$t
  note "start $1 pid ${pid[$1]}"
}

# A process may have been killed together with its keeper (its parent shell: lib-process.sh), which then reports
# nothing. A keeper that has just reported is missing too, so a process counts as dead only when it is missing in two
# checks with an empty pipe in between.
declare -A suspect=()
look_for_dead() {
  local name
  for name in "${names[@]}"; do
    if ! alive "$name" || kill -0 "${pid[$name]}" 2>/dev/null; then continue; fi
    if [ -n "${suspect[$name]:-}" ]; then reap "$name" 137; else suspect[$name]=1; fi
  done
}

# A process that is stopped (SIGSTOP; not by a debugger) for 3 s counts as dead in a group that keeps running, whose policies
# say what follows; in a run that is never restarted, the run's own deadline ends it. Its keeper and this script are only told to go on: `watch_self` does that for the supervisor.
declare -A stopped_at=()
stopped_limit=3000 # ms
look_for_stopped() {
  local name stat keeps_running=''
  for name in "${names[@]}"; do [ "${policy[$name]:-never}" = never ] || keeps_running=1; done
  for name in "${names[@]}"; do
    alive "$name" || continue
    kill -CONT "${pid[$name]}" 2>/dev/null
    { read -r stat <"/proc/${host[$name]:-0}/stat"; } 2>/dev/null || stat=
    stat=${stat##*) }
    if [ "${stat%% *}" != T ] || [ -z "$keeps_running" ] || [ "$stage" -ne 0 ]; then
      unset "stopped_at[$name]"
    elif [ $((t - ${stopped_at[$name]:=$t})) -ge "$stopped_limit" ]; then
      unset "stopped_at[$name]"
      clear_progress
      say "$verb: $name has been stopped (SIGSTOP) for $((stopped_limit / 1000)) s: killing it"
      note "send KILL to $name, which is stopped"
      kill -KILL -- "-${pid[$name]}" 2>/dev/null
    fi
  done
}

# A supervisor that is stopped (SIGSTOP) would miss ends and its --timeout: a shell beside it tells it to go on after 2 s. The
# shell ends with the supervisor.
# shellcheck disable=SC2016
watcher='exec {clock}<> <(:)
times=0
while :; do
  read -rt 1 -u "$clock"
  read -r stat <"/proc/$1/stat" || exit
  stat=${stat##*) }
  if [ "${stat%% *}" = T ]; then times=$((times + 1)); else times=0; fi
  [ "$times" -lt 2 ] || kill -CONT "$0"
done'
watch_self() {
  setpriv --pdeathsig KILL setsid bash -c "$watcher" "$$" "$own_pid" </dev/null >/dev/null 2>&1 {journal}>&- {control}>&- &
  disown "$!"
}

# The state file that ps and wait read: rewritten at every change.
phase=running ended_code='' reason=''
write_state() {
  local name status text
  text="supervisor $own_pid $began
isolation ${LAB_ISOLATED:-none}
url ${LCM_DEFAULT_URL:-}
prefix ${LAB_PREFIX:-}
phase $phase
code $ended_code
reason $reason
"
  [ "$phase" != ended ] || { now && text+="ended $t"$'\n'; }
  for name in "${names[@]}"; do
    status=ended
    if alive "$name"; then status=running; elif [ -n "${due[$name]:-}" ]; then status=waiting; fi
    text+="process $name $status ${host[$name]:-0} ${began_at[$name]:-0} ${restarts[$name]:-0} ${code[$name]:--} ${required[$name]:-yes} ${policy[$name]:-never}"$'\n'
  done
  { printf %s "$text" >"$dir/.state"; } 2>/dev/null && mv -f "$dir/.state" "$dir/state"
}

# Whether a process that has ended is to be restarted; sets when (due, ms).
to_be_restarted() { # NAME CODE
  local name=$1 lived wait=0
  [ "$stage" -eq 0 ] && [ -z "$interrupted" ] || return 1
  now
  if [ -n "${asked[$name]:-}" ]; then
    unset "asked[$name]"
    due[$name]=$t
    return 0
  fi
  case ${policy[$name]:-never} in
    never) return 1 ;;
    on-failure) [ "$2" -ne 0 ] || return 1 ;;
  esac
  lived=$((t - began_at[$name]))
  if [ "$lived" -ge 10000 ]; then short[$name]=0; else short[$name]=$((${short[$name]:-0} + 1)); fi
  [ "${short[$name]}" -le "${cap[$name]:-10}" ] || return 1
  if [ "$lived" -lt 1000 ]; then
    if [ "${short[$name]}" -le 6 ]; then wait=$((100 << (short[$name] - 1))); else wait=5000; fi
  fi
  due[$name]=$((t + wait))
}

restart_due() {
  local name
  for name in "${!due[@]}"; do
    [ "$t" -ge "${due[$name]}" ] || continue
    restarts[$name]=$((${restarts[$name]:-0} + 1))
    start "$name"
    write_state
  done
}

# A logger that is told to end gives its log the final name. One that is killed leaves all but the last tenth of a second in
# its .part, and the next one goes on there.
restart_asked() { # NAME
  if [ -z "${command[$1]:-}" ] || [ "$stage" -ne 0 ]; then return; fi
  if alive "$1"; then
    asked[$1]=1
    if [ "$1" = logger ]; then signal "$1" KILL; else signal "$1" INT; fi
  else
    due[$1]=$t
  fi
}

# When the simulator restarts, all processes do, as a new launch.
set_logs_aside() {
  local n=1 file run_dir=$dir/..
  while [ -e "$run_dir/log-$n.lcm" ] || [ -e "$run_dir/log-$n.lcm.part" ] || [ -e "$run_dir/telemetry-$n.lcm" ]; do n=$((n + 1)); done
  for file in {log,telemetry}{,.earlier}.lcm{,.part}; do
    [ ! -e "$run_dir/$file" ] || mv "$run_dir/$file" "$run_dir/${file/./-$n.}"
  done
}
start_again() {
  local name
  set_logs_aside
  again='' stage=0 force='' hurry='' failure='' blame=''
  LAB_LAUNCH=$(((SRANDOM << 31) ^ SRANDOM))
  now
  note "all processes restart"
  for name in "${names[@]}"; do
    restarts[$name]=$((${restarts[$name]:-0} + 1))
    start "$name"
  done
  write_state
}

# A log that is too long is copied once and emptied; the processes append, so they continue in the emptied file.
rotate_logs() {
  local size file
  while read -r size file; do
    [ "$size" -le "${LAB_LOG_MAX:-10000000}" ] || { cp -f "$file" "$file.1" && : >"$file"; }
  done < <(stat -c '%s %n' "$dir"/*.log 2>/dev/null)
}

alive() { [ -n "${pid[$1]:-}" ] && [ -z "${code[$1]:-}" ]; }

signal() { # NAME SIGNAL
  signalled[$1]=$2
  note "send $2 to $1"
  kill -"$2" -- "-${pid[$1]}" 2>/dev/null
  kill -CONT -- "-${pid[$1]}" 2>/dev/null # a stopped process must receive it too
}

# shellcheck shell=bash
# Sourced first by every verb: paths, messages, exit codes, run folders, running labs.
set -u
# One locale for all that the lab starts: its numbers have points, whatever the user's have, and lists the same order everywhere.
export LC_ALL=C.UTF-8

LAB_SCRIPTS=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
LAB_ROOT=$(dirname "$LAB_SCRIPTS")
LAB_BUILD=${LAB_BUILD:-$LAB_ROOT/build/release} # another build's programs: LAB_BUILD=build/asan lab run ..
LAB_RUNS=${LAB_RUNS:-$LAB_ROOT/runs}
cache_folder=${XDG_CACHE_HOME:-${HOME:-/nonexistent}/.cache}
LAB_ROBOTS=$cache_folder/lcmlab/robots/example-robot-data-6.0.0
export LAB_ROOT LAB_BUILD LAB_RUNS
# As root of a user namespace, which a private run may be, Mesa would look for its cache in /root. It complains of a folder that
# it cannot make.
if [ -w "$cache_folder" ] || [ -w "${cache_folder%/*}" ]; then
  export MESA_SHADER_CACHE_DIR=${MESA_SHADER_CACHE_DIR:-$cache_folder}
else
  export MESA_SHADER_CACHE_DISABLE=${MESA_SHADER_CACHE_DISABLE:-true}
fi
case ":$PATH:" in *":$LAB_BUILD/bin:"*) ;; *) export PATH="$LAB_BUILD/bin:$PATH" ;; esac

# package://example-robot-data/... resolves after `lab robots`.
if [ -d "$LAB_ROBOTS/example-robot-data" ]; then
  case ":${LAB_PACKAGE_PATH:-}:" in
    *":$LAB_ROBOTS:"*) ;;
    *) export LAB_PACKAGE_PATH="${LAB_PACKAGE_PATH:+$LAB_PACKAGE_PATH:}$LAB_ROBOTS" ;;
  esac
fi

verb=$(basename "$0")
case $verb in
  lab-*)
    verb=${verb/#lab-/lab }
    export LAB_VERB=$verb # the programs that a verb calls begin their messages with it, too
    ;;
esac

# Words as verbs take them: --option=value is --option value, up to a -- or the command of exec. (This file shares the
# arguments of what sources it.)
as_json=''
if [[ $verb == 'lab '* ]]; then
  words=()
  while [ $# -gt 0 ]; do
    case $1 in
      --) break ;;
      --json) words+=("$1")
        [ -n "$as_json" ] || { as_json=1 && exec {json_out}>&1; } ;; # die writes there, from within $(..) too
      --[a-z]*=*) words+=("${1%%=*}" "${1#*=}") ;;
      -*) words+=("$1") ;;
      *) [ "$verb" != 'lab exec' ] || [ "${words[*]: -1}" = --lab ] || break
        words+=("$1") ;;
    esac
    shift
  done
  set -- "${words[@]}" "$@"
  unset words
fi

bold='' red='' green='' dim='' plain=''
if [ -t 2 ] && [ -z "${NO_COLOR:-}" ] && [ "${TERM:-dumb}" != dumb ]; then
  # shellcheck disable=SC2034  # not every verb uses every colour
  bold=$'\e[1m' red=$'\e[31m' green=$'\e[32m' dim=$'\e[2m' plain=$'\e[0m'
fi

# Output that cannot be written (disk full, closed, /dev/full): where echo or printf cannot write the data of a verb to stdout, it
# ends with 1 (bash has said why); a message that stderr does not take ends nothing, but 0 becomes 1. A verb that has
# something to clean up defines `cleanup`: this is the only EXIT trap. (An echo within a redirected group counts as one to stdout:
# each has its own redirection.)
message_lost=''
cleanup() { :; }
set -E
trap 'case $BASH_COMMAND in echo* | printf*) [[ $BASH_COMMAND == *">"* ]] || exit 1 ;; esac' ERR
end_of_verb() {
  local code=$?
  cleanup
  [ "$code" -ne 0 ] || [ -z "$message_lost" ] || code=1
  exit "$code"
}
trap end_of_verb EXIT

# Messages go to stderr: stdout is for data.
say() {
  visible "$*"
  printf '%s\n' "$shown" >&2 || message_lost=1
}

# visible TEXT: sets shown to the text as a terminal may get it. Names come from others: without our colours, what is not UTF-8 and
# control characters other than line feeds are shown as \xNN (in C++ printable() of core/util does that).
visible() {
  local bare=$1 colour
  for colour in "$bold" "$red" "$green" "$dim" "$plain"; do [ -z "$colour" ] || bare=${bare//"$colour"/}; done
  shown=$1
  # shellcheck disable=SC2101  # a class beside a line feed
  [[ $bare != *[![:print:]$'\n']* ]] || escape_bytes "$bare"
}
escape_bytes() { # TEXT: sets shown
  local LC_ALL=C i byte
  shown=''
  for ((i = 0; i < ${#1}; i++)); do
    byte=${1:i:1}
    # shellcheck disable=SC2101
    [[ $byte == [[:print:]$'\n'] ]] || { printf -v byte %d "'$byte" && printf -v byte '\\x%02x' $((byte & 255)); }
    shown+=$byte
  done
}

# die CODE WORDS..: prints one line on stderr, under --json also {"error": .., "exit_code": ..} on stdout, and exits with CODE.
die() {
  local text=${*:2}
  say "$verb: $red$text$plain"
  if [ -n "$as_json" ]; then
    visible "$text"
    text=${shown//\\/\\\\}
    text=${text//\"/\\\"}
    printf '{"error":"%s","exit_code":%d}\n' "${text//[[:cntrl:]]/ }" "$1" >&"$json_out"
  fi
  exit "$1"
}

# The header comment of a verb is its help.
help() { sed -n '2,${/^#/!q; s/^# \{0,1\}//p}' "$0" || exit 1; }

# usage_error WORDS..: exits with 2 and points to --help.
usage_error() { die 2 "$* (see: scripts/$verb --help)"; }

# unknown_option WORD: exits with 2 and the near names among the options in the verb's help.
unknown_option() {
  local known near
  known=$(help | grep -oE -- '(^|[ [|])--?[a-z][a-z-]*' | tr -d ' [|' | sort -u)
  # shellcheck disable=SC2086  # one word an option
  near=$(near_names "$1" $known)
  usage_error "unknown option '$1'${near:+, did you mean: $near?}"
}

# need_value OPTION COUNT: exits with 2 when no argument follows the option.
need_value() { [ "$2" -ge 2 ] || usage_error "$1 needs a value"; }

# need_seconds OPTION VALUE: exits with 2 unless the value is a number of seconds.
need_seconds() {
  [[ $2 =~ ^[0-9]+,[0-9]+$ ]] && usage_error "$1 is '$2', a decimal comma: write ${2/,/.}"
  [[ $2 =~ ^([0-9]+(\.[0-9]*)?|\.[0-9]+)$ ]] || usage_error "$1 is '$2', not a number of seconds"
}

# need_programs NAME..: exits with 2, and says how to build them, when one of them is not built.
need_programs() {
  local p
  for p; do
    [ -x "$LAB_BUILD/bin/$p" ] || die 2 "$p is not built in $LAB_BUILD: run scripts/lab setup and scripts/lab build first"
  done
}

# now: sets t to the milliseconds since boot. The wall clock can be set while we wait; so can $SECONDS, which follows it.
now() {
  local up
  read -r up _ </proc/uptime
  t=$((10#${up//./} * 10))
}

# milliseconds S: sets ms to a decimal number of seconds in milliseconds
milliseconds() { printf -v ms %.0f "${1}e3"; }

# expires_in S: sets end; `expired` is true from then on
expires_in() { milliseconds "$1" && now && end=$((t + ms)); }
expired() { now && [ "$t" -ge "$end" ]; }

# The scripts read the clock, their own pid and the bus of a lab from /proc.
[ -r /proc/self/stat ] || die 2 "/proc is not mounted: the lab's scripts need it (mount -t proc proc /proc)"

# pause S: waits for S seconds between two polls, without a process
pause() {
  [ -n "${pause_pipe:-}" ] || exec {pause_pipe}<> <(:)
  read -rt "$1" -u "$pause_pipe" || true
}

# near_names WORD CANDIDATE..: prints the candidates that are similar to WORD, on one line.
near_names() {
  local word=$1 candidate near=()
  shift
  for candidate; do
    [[ $candidate == "$word"* || $(distance "$word" "$candidate") -le 2 ]] && near+=("$candidate")
  done
  echo "${near[*]}"
}

# Edit distance of two words (Wagner and Fischer 1974).
distance() {
  local a=$1 b=$2 i j cost best row=() old
  for ((j = 0; j <= ${#b}; j++)); do row[j]=$j; done
  for ((i = 1; i <= ${#a}; i++)); do
    old=$((i - 1)) row[0]=$i
    for ((j = 1; j <= ${#b}; j++)); do
      cost=1
      [ "${a:i-1:1}" = "${b:j-1:1}" ] && cost=0
      best=$((old + cost)) old=${row[j]}
      ((row[j] + 1 < best)) && best=$((row[j] + 1))
      ((row[j - 1] + 1 < best)) && best=$((row[j - 1] + 1))
      row[j]=$best
    done
  done
  echo "${row[${#b}]}"
}

# --- runs ------------------------------------------------------------------------------------------------------------
# What a run may write into its folder, as shell patterns. Nothing else in the folder is ever removed or replaced.
run_files=(experiment.yaml manifest.json .manifest.json.new metrics.json report.html gl.txt contact.png ghost.png
  {log,telemetry}{,-[0-9]*}{,.earlier}.lcm{,.part} 'frames/[0-9]*.png' 'frames/[0-9]*.f32'
  processes/{Procfile,state,control,up.out} 'processes/*.log' 'processes/*.log.1')

# A run is a folder with the manifest of one, or one of an earlier version, which wrote its experiment with this first line.
is_run() {
  local line=''
  has_manifest "$1" && return
  { IFS= read -r line <"$1/experiment.yaml"; } 2>/dev/null
  [[ $line == '# As run'* ]]
}
has_manifest() { [ -f "$1/manifest.json" ] && grep -q '"lcmlab": ' "$1/manifest.json" && grep -q '"files": ' "$1/manifest.json"; }

# has_ended DIR: whether the run was seen to its end
has_ended() { [ -f "$1/manifest.json" ] && ! grep -q '"state": "running"' "$1/manifest.json"; }

# begin_manifest DIR: makes the folder a run, before anything else is written there. `lab-experiment manifest` completes it.
begin_manifest() {
  local files
  printf -v files '"%s", ' "${run_files[@]}"
  {
    printf '{\n  "lcmlab": "running",\n  "state": "running",\n  "files": [%s]\n}\n' "${files%, }" >"$1/.manifest.json.new"
  } 2>/dev/null || cannot_make "$1"
  mv -fT "$1/.manifest.json.new" "$1/manifest.json" || cannot_make "$1"
}

# files_of_run DIR: sets patterns to what this run may have written: as its manifest says, which may be of another version
files_of_run() {
  local list='' name
  patterns=()
  if has_manifest "$1"; then
    list=$(tr -d '\n' <"$1/manifest.json")
    list=$(sed -E 's/^ *\].*//; s/" *\].*/"/' <<<"${list#*'"files": ['}") # a pattern may have a ] of its own
    mapfile -t patterns < <(grep -o '"[^"]*"' <<<"$list" | tr -d '"')
  else
    patterns=("${run_files[@]}")
  fi
  for name in "${patterns[@]}"; do # a manifest is a file that anybody may have written
    [[ $name != /* && /$name/ != */../* && $name != *[[:cntrl:]]* ]] || die 1 "$1/manifest.json: '$name' is not a file of a run"
  done
}

# remove_run_files DIR: removes what a run wrote there, and the folders in it that are empty then. Links are not followed.
remove_run_files() (
  files_of_run "$1"
  cd -- "$1" || exit 1
  shopt -s nullglob
  IFS= # patterns expand to names, never to words
  for pattern in "${patterns[@]}"; do
    case $pattern in */*) [ ! -L "${pattern%%/*}" ] || continue ;; esac
    for path in $pattern; do
      [ -d "$path" ] && [ ! -L "$path" ] || rm -f -- "$path" || exit 1
    done
  done
  rmdir -- frames processes 2>/dev/null
  exit 0
)

# find_run RUN: prints the folder of a run, given as a folder or as a name under runs/; fails when there is none.
find_run() {
  local dir
  for dir in "$1" "$LAB_RUNS/$1" "$LAB_RUNS/.elsewhere/$1"; do
    if is_run "$dir"; then
      readlink -f "$dir"
      return
    fi
  done
  return 1
}

# find_runs RUN..: sets dirs to their folders; exits with 2 when one does not exist.
find_runs() {
  local run dir
  dirs=()
  for run; do
    dir=$(find_run "$run") || die 2 "there is no run '$run' (scripts/lab ls lists them)"
    dirs+=("$dir")
  done
}

# find_experiment NAME: prints the file of an experiment, given as a file or as a name in experiments/; when there is
# none, exits with 3 and near names.
find_experiment() {
  local file names near
  for file in "$1" "$LAB_ROOT/experiments/$1" "$LAB_ROOT/experiments/$1.yaml"; do
    [ ! -f "$file" ] || { echo "$file" && return; }
  done
  [ ! -e "$1" ] || die 3 "$1 is not an experiment file"
  if [ -f "$LAB_ROOT/experiments/sweeps/${1%.yaml}.yaml" ]; then
    die 3 "$1 is a sweep, not an experiment: run it with scripts/lab sweep $1"
  fi
  names=("$LAB_ROOT"/experiments/*.yaml)
  names=("${names[@]##*/}")
  file=${1##*/}
  near=$(near_names "${file%.yaml}" "${names[@]%.yaml}")
  die 3 "there is no experiment '$1'${near:+; near names: $near} (experiments/ has some to start from)"
}

cannot_make() { die 2 "cannot write the run folder $1 (permissions? disk full? LAB_RUNS=DIR puts runs elsewhere)"; }

# make_run_folder NAME [DIR]: makes and locks the folder of a run: sets dir, and made if it is new.
make_run_folder() {
  local name=$1 out=$2 n
  # shellcheck disable=SC2034  # for the caller
  made=''
  if [ -n "$out" ]; then
    [ -e "$out" ] && [ ! -d "$out" ] && die 2 "$out is a file, not a folder"
    [ -d "$out" ] || made=1
    mkdir -p "$out" 2>/dev/null || cannot_make "$out"
    if [ -n "$(ls -A "$out" 2>/dev/null)" ] && ! is_run "$out"; then
      die 2 "$out is not empty and not a run folder: choose a new or empty folder"
    fi
    dir=$out
  else
    mkdir -p "$LAB_RUNS" 2>/dev/null || cannot_make "$LAB_RUNS"
    dir=$LAB_RUNS/$name
    # shellcheck disable=SC2034
    made=1
    for ((n = 2; ; n++)); do # mkdir is atomic: two runs that start together get two folders
      mkdir "$dir" 2>/dev/null && break
      [ -e "$dir" ] || cannot_make "$dir"
      dir=$LAB_RUNS/$name-$n
    done
  fi
  [ -w "$dir" ] || cannot_make "$dir"
  # the run counts as running for as long as this lock on its folder is held
  exec {run_lock}<"$dir" || cannot_make "$dir"
  flock -n "$run_lock" || die 2 "another run is active in $dir"
}

# Removes an old run from the folder, and begins a new one there.
empty_run_folder() {
  remove_run_files "$dir" || exit 1
  begin_manifest "$dir"
  mkdir -p "$dir/processes" || cannot_make "$dir"
}

point_latest() { ln -sfn "$(basename "$dir")" "$LAB_RUNS/.latest.$$" && mv -T "$LAB_RUNS/.latest.$$" "$LAB_RUNS/latest"; }

# A run holds a lock on its own folder while it runs: there is no lock file, and the kernel always releases the lock.
# (The check takes a shared lock for a moment, so that two checks at once do not fail each other.)
# Anybody who may read the folder can hold such a lock too: where there is a supervisor, it must live as well, or have ended so
# lately that the shell around it may still write the manifest.
run_is_alive() {
  ! flock -sn "$1" true || return 1
  [ -f "$1/processes/state" ] || return 0
  supervisor_lives "$1" || has_just_ended "$1"
}
has_just_ended() {
  local t ended
  local -A lab_state
  local lab_processes
  read_state "$1"
  ended=${lab_state[ended]:-}
  [[ $ended =~ ^[0-9]+$ ]] && now && [ "$t" -ge "$ended" ] && [ $((t - ended)) -lt 10000 ]
}

# supervisor_lives DIR: sets supervisor to the pid in the run's state; fails unless that process is the run's supervisor. A
# state file can be old, or anybody's: its process must be of the folder's owner, run supervise on this folder, and be as
# old as the state says (the kernel may have given the pid to another process since).
supervisor_lives() {
  local began stat started lab_processes
  local -A lab_state # read_state fills these instead of the caller's
  read_state "$1"
  read -r supervisor began <<<"${lab_state[supervisor]:-}"
  [[ ${supervisor:-} =~ ^[1-9][0-9]*$ && ${began:-} =~ ^[0-9]+$ ]] || return 1
  { read -r stat <"/proc/$supervisor/stat"; } 2>/dev/null || return 1
  read -ra stat <<<"${stat##*) }"
  [ "${stat[0]}" != Z ] || return 1
  started=$((stat[19] * 10)) # ms since boot: the kernel counts hundredths of a second
  [ "$started" -le $((began + 20)) ] || return 1
  [ "$(stat -c %u "/proc/$supervisor" 2>/dev/null)" = "$(stat -c %u "$1")" ] || return 1
  [[ $({ tr '\0' ' ' <"/proc/$supervisor/cmdline"; } 2>/dev/null) == *"/supervise --dir $(readlink -f "$1")/processes "* ]]
}

# --- running labs ----------------------------------------------------------------------------------------------------
# running_labs: sets running to the folders of all labs that run and accept commands: those under runs/, and those that
# `lab up -o` put elsewhere and remembered in runs/.elsewhere.
running_labs() {
  local dir
  running=()
  for dir in "$LAB_RUNS"/*/processes/control "$LAB_RUNS"/.elsewhere/*/processes/control; do
    dir=${dir%/processes/control}
    [[ $dir != */.elsewhere/* ]] && [ -L "$dir" ] && continue
    if [ -p "$dir/processes/control" ] && run_is_alive "$dir"; then running+=("$(readlink -f "$dir")"); fi
  done
}

# remember_elsewhere DIR: makes a lab outside runs/ known to all verbs; forgets those that are gone.
remember_elsewhere() {
  local known=$LAB_RUNS/.elsewhere link name=${1##*/} n
  [ ! "$(dirname "$1")" -ef "$LAB_RUNS" ] || return 0
  mkdir -p "$known" || return
  for link in "$known"/*; do
    [ ! -L "$link" ] || { [ -p "$link/processes/control" ] && [ "$(readlink "$link")" != "$1" ]; } || rm -f -- "$link"
  done
  link=$known/$name
  for ((n = 2; n <= 100; n++)); do
    if ln -sT "$1" "$link" 2>/dev/null; then break; fi
    link=$known/$name-$n
  done
}

# pick_lab ARGS..: removes `--lab RUN` from the arguments: sets rest to the others and lab_dir to the folder of that
# lab. RUN is a folder or a name under runs/; without it, LAB_RUN or the only lab that runs.
pick_lab() {
  local wanted=${LAB_RUN:-}
  rest=()
  while [ $# -gt 0 ]; do
    case $1 in
      --lab) need_value "$1" $# && wanted=$2 && shift 2 ;;
      --) rest+=("$@") && break ;;
      *) rest+=("$1") && shift ;;
    esac
  done
  if [ -n "$wanted" ]; then
    lab_dir=$(find_run "$wanted") || die 2 "there is no run '$wanted' (scripts/lab ls lists them)"
    if [ ! -p "$lab_dir/processes/control" ] || ! run_is_alive "$lab_dir"; then die 2 "$wanted is not running"; fi
    return
  fi
  running_labs
  case ${#running[@]} in
    0) die 2 "no lab is running (start one: scripts/lab up -d)" ;;
    1) lab_dir=${running[0]} ;;
    *) die 2 "several labs are running: say which with --lab RUN: ${running[*]##*/}" ;;
  esac
}

# read_state DIR: reads what the supervisor of a run wrote last: into lab_state the supervisor, isolation, url, phase,
# code, reason; into lab_processes one line for each process: NAME STATUS PID START RESTARTS CODE REQUIRED POLICY.
declare -A lab_state=()
read_state() {
  local key value
  lab_state=() lab_processes=()
  { while read -r key value; do
    if [ "$key" = process ]; then lab_processes+=("$value"); else lab_state[$key]=$value; fi
  done <"$1/processes/state"; } 2>/dev/null
}

# enter_lab DIR COMMAND..: replaces this shell by the command, on the lab's bus.
enter_lab() {
  local dir=$1 pid into=()
  shift
  read_state "$dir" || die 2 "cannot read $dir/processes/state: the lab has not started yet, or belongs to another user"
  pid=${lab_state[supervisor]%% *}
  if [ ! "/proc/$pid/ns/net" -ef /proc/self/ns/net ]; then # private: its own network
    [ -d "/proc/$pid" ] || die 2 "the lab in $dir has ended"
    [ -e "/proc/$pid/ns/net" ] || die 2 "the lab in $dir belongs to $(stat -c %U "/proc/$pid"): its private bus cannot be entered"
    into=(nsenter --target "$pid" --net)
    [ "/proc/$pid/ns/user" -ef /proc/self/ns/user ] || into+=(--user --preserve-credentials)
    into+=(--)
  fi
  export LCM_DEFAULT_URL=${lab_state[url]} LAB_PREFIX=${lab_state[prefix]:-}
  exec "${into[@]}" "$@"
}

# send_to_lab VERB ARGS..: runs lab-send VERB on the bus of the lab that ARGS name.
send_to_lab() {
  local name=$1
  shift
  for word; do
    case $word in -h | --help) help && exit 0 ;; esac
  done
  need_programs lab-send
  pick_lab "$@"
  export LAB_RUN_DIR=$lab_dir
  enter_lab "$lab_dir" lab-send "$name" "${rest[@]}"
}

# restore_interrupts ARGS..: when this script ignores INT (it is a background job of a script), restarts it with the
# default action: bash cannot trap a signal that was ignored when bash started.
restore_interrupts() {
  local ignored
  ignored=$(sed -n 's/^SigIgn:[[:space:]]*//p' /proc/self/status)
  [ $((0x$ignored & 2)) -eq 0 ] || exec env --default-signal=INT "$0" "$@"
}

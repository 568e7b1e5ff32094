# shellcheck shell=bash
# What every verb starts with: where things are, how to speak, how to stop. Source it first.
set -u

LAB_SCRIPTS=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
LAB_ROOT=$(dirname "$LAB_SCRIPTS")
LAB_BUILD=${LAB_BUILD:-$LAB_ROOT/build/release} # another build's programs: LAB_BUILD=build/asan lab run ..
LAB_RUNS=${LAB_RUNS:-$LAB_ROOT/runs}
LAB_ROBOTS=${XDG_CACHE_HOME:-${HOME:-/nonexistent}/.cache}/lcmlab/robots/example-robot-data-6.0.0
export LAB_ROOT LAB_BUILD LAB_RUNS
# As root of a user namespace, which a private run may be, Mesa would look for its cache in /root.
export MESA_SHADER_CACHE_DIR=${MESA_SHADER_CACHE_DIR:-${XDG_CACHE_HOME:-${HOME:-/nonexistent}/.cache}}
case ":$PATH:" in *":$LAB_BUILD/bin:"*) ;; *) export PATH="$LAB_BUILD/bin:$PATH" ;; esac

# package://example-robot-data/... resolves once `lab robots` has been here.
if [ -d "$LAB_ROBOTS/example-robot-data" ]; then
  case ":${LAB_PACKAGE_PATH:-}:" in
    *":$LAB_ROBOTS:"*) ;;
    *) export LAB_PACKAGE_PATH="${LAB_PACKAGE_PATH:+$LAB_PACKAGE_PATH:}$LAB_ROBOTS" ;;
  esac
fi

verb=$(basename "$0")
verb=${verb/#lab-/lab }

bold='' red='' green='' dim='' plain=''
if [ -t 2 ] && [ -z "${NO_COLOR:-}" ] && [ "${TERM:-dumb}" != dumb ]; then
  # shellcheck disable=SC2034  # not every verb uses every colour
  bold=$'\e[1m' red=$'\e[31m' green=$'\e[32m' dim=$'\e[2m' plain=$'\e[0m'
fi

# Chatter goes to stderr: stdout is for data.
say() { printf '%s\n' "$*" >&2; }

# die CODE WORDS..: one clear line and the exit code of the contract.
die() {
  printf '%s: %s%s%s\n' "$verb" "$red" "${*:2}" "$plain" >&2
  exit "$1"
}

# The header comment of a verb is its help.
help() { sed -n '2,${/^#/!q; s/^# \{0,1\}//p}' "$0"; }

# usage_error WORDS..: exit 2 with the way to help.
usage_error() { die 2 "$* (see: scripts/$verb --help)"; }

# value OPTION [VALUE]: the value of an option, or exit 2 when there is none.
need_value() { [ "$2" -ge 2 ] || usage_error "$1 needs a value"; }

# need_programs NAME..: they exist in the build, or say how to get them.
need_programs() {
  local p
  for p; do
    [ -x "$LAB_BUILD/bin/$p" ] || die 2 "$p is not built in $LAB_BUILD: run scripts/lab setup and scripts/lab build first"
  done
}

# pause S: so long between two looks at something that changes
pause() {
  [ -n "${pause_pipe:-}" ] || exec {pause_pipe}<> <(:)
  read -rt "$1" -u "$pause_pipe" || true
}

# near_names WORD CANDIDATE..: those that somebody may have meant, on one line.
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
# A run is a folder with an experiment, or with a group of processes.
is_run() { [ -f "$1/experiment.yaml" ] || [ -f "$1/processes/Procfile" ]; }

# Where a run is: a folder, or a name under runs/. Prints the folder; fails when there is none.
find_run() {
  local dir
  for dir in "$1" "$LAB_RUNS/$1"; do
    if is_run "$dir"; then
      readlink -f "$dir"
      return
    fi
  done
  return 1
}

# find_runs RUN..: sets dirs to their folders, or says which is none.
find_runs() {
  local run dir
  dirs=()
  for run; do
    dir=$(find_run "$run") || die 2 "there is no run '$run' (scripts/lab ls lists them)"
    dirs+=("$dir")
  done
}

# An experiment by file, or by its name in experiments/. Prints the file; or says which names are near, and fails.
find_experiment() {
  local file names near
  for file in "$1" "$LAB_ROOT/experiments/$1" "$LAB_ROOT/experiments/$1.yaml"; do
    [ ! -f "$file" ] || { echo "$file" && return; }
  done
  [ ! -e "$1" ] || die 3 "$1 is no experiment file"
  names=("$LAB_ROOT"/experiments/*.yaml)
  names=("${names[@]##*/}")
  file=${1##*/}
  near=$(near_names "${file%.yaml}" "${names[@]%.yaml}")
  die 3 "there is no experiment '$1'${near:+; near names: $near} (experiments/ has some to start from)"
}

cannot_make() { die 2 "cannot write the run folder $1 (permissions? disk full?)"; }

# make_run_folder NAME [DIR]: a folder for a run, ours for as long as we hold its lock: sets dir, and made if it is new.
make_run_folder() {
  local name=$1 out=$2 n
  # shellcheck disable=SC2034  # for the caller
  made=''
  if [ -n "$out" ]; then
    [ -e "$out" ] && [ ! -d "$out" ] && die 2 "$out is a file, not a folder"
    [ -d "$out" ] || made=1
    mkdir -p "$out" 2>/dev/null || cannot_make "$out"
    if [ -n "$(ls -A "$out" 2>/dev/null)" ] && ! is_run "$out"; then
      die 2 "$out is not empty and no run folder: give a new or empty one"
    fi
    dir=$out
  else
    mkdir -p "$LAB_RUNS" 2>/dev/null || cannot_make "$LAB_RUNS"
    dir=$LAB_RUNS/$name
    # shellcheck disable=SC2034
    made=1
    for ((n = 2; ; n++)); do # mkdir decides between two runs that start together
      mkdir "$dir" 2>/dev/null && break
      [ -e "$dir" ] || cannot_make "$dir"
      dir=$LAB_RUNS/$name-$n
    done
  fi
  [ -w "$dir" ] || cannot_make "$dir"
  # the run is alive for as long as somebody holds this lock on its folder
  exec {run_lock}<"$dir" || cannot_make "$dir"
  flock -n "$run_lock" || die 2 "another run is alive in $dir"
}

# An old run in the folder makes place.
empty_run_folder() {
  rm -rf "$dir"/{log*.lcm,telemetry*.lcm,*.lcm.part,frames,contact.png,metrics.json,report.html,manifest.json,processes}
  mkdir -p "$dir/processes" || cannot_make "$dir"
}

point_latest() { ln -sfn "$(basename "$dir")" "$LAB_RUNS/.latest.$$" && mv -T "$LAB_RUNS/.latest.$$" "$LAB_RUNS/latest"; }

# A run holds a lock on its own folder for as long as it lives: no lock file, and the kernel never forgets to unlock.
# (Looking takes a shared lock for a moment, so that two who look do not see each other.)
run_is_alive() { ! flock -sn "$1" true; }

# --- living labs -----------------------------------------------------------------------------------------------------
# living_labs: sets living to the folders of all labs under runs/ that are alive and listen.
living_labs() {
  local dir
  living=()
  for dir in "$LAB_RUNS"/*/processes/control; do
    dir=${dir%/processes/control}
    if [ -p "$dir/processes/control" ] && [ ! -L "$dir" ] && run_is_alive "$dir"; then living+=("$dir"); fi
  done
}

# pick_lab ARGS..: takes `--lab RUN` out of the arguments: the others are in rest, the folder of the living lab that is
# meant in lab_dir. RUN is a folder or a name under runs/; without it, LAB_RUN or the only one that lives.
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
  living_labs
  case ${#living[@]} in
    0) die 2 "no lab is running (start one: scripts/lab up -d)" ;;
    1) lab_dir=${living[0]} ;;
    *) die 2 "several labs are running: say which with --lab RUN: ${living[*]##*/}" ;;
  esac
}

# read_state DIR: what the supervisor of a run said last, in lab_state: supervisor, launch, isolation, url, phase, code,
# reason ..; of its processes, one line each in lab_processes: NAME STATUS PID START RESTARTS CODE REQUIRED POLICY.
declare -A lab_state=()
read_state() {
  local key value
  lab_state=() lab_processes=()
  { while read -r key value; do
    if [ "$key" = process ]; then lab_processes+=("$value"); else lab_state[$key]=$value; fi
  done <"$1/processes/state"; } 2>/dev/null
}

# enter_lab DIR COMMAND..: becomes the command, on the lab's bus.
enter_lab() {
  local dir=$1 pid into=()
  shift
  read_state "$dir" || die 2 "cannot read $dir/processes/state: the lab has not started yet, or is somebody else's"
  pid=${lab_state[supervisor]%% *}
  if [ ! "/proc/$pid/ns/net" -ef /proc/self/ns/net ]; then # private: its own network
    [ -d "/proc/$pid" ] || die 2 "the lab in $dir has ended"
    [ -e "/proc/$pid/ns/net" ] || die 2 "the lab in $dir is $(stat -c %U "/proc/$pid")'s: its private bus cannot be entered"
    into=(nsenter --target "$pid" --net)
    [ "/proc/$pid/ns/user" -ef /proc/self/ns/user ] || into+=(--user --preserve-credentials)
    into+=(--)
  fi
  export LCM_DEFAULT_URL=${lab_state[url]}
  exec "${into[@]}" "$@"
}

# hand VERB ARGS..: the verb of lab-send, in the living lab that is meant.
hand() {
  local name=$1
  shift
  for word; do
    case $word in -h | --help) help && exit 0 ;; esac
  done
  need_programs lab-send
  pick_lab "$@"
  enter_lab "$lab_dir" lab-send "$name" "${rest[@]}"
}

# A script's background job ignores INT, and bash cannot trap what was ignored when it started: start again, heeding it.
heed_interrupts() {
  local ignored
  ignored=$(sed -n 's/^SigIgn:[[:space:]]*//p' /proc/self/status)
  [ $((0x$ignored & 2)) -eq 0 ] || exec env --default-signal=INT "$0" "$@"
}

# shellcheck shell=bash disable=SC2154
# Run folders and running labs: what is a run, which files are its own, which labs live, how a verb gets onto a lab's bus. A part
# of lib.sh, whose messages and clock it uses.

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

# shellcheck shell=bash
# What every verb starts with: where things are, how to speak, how to stop. Source it first.
set -u

LAB_SCRIPTS=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
LAB_ROOT=$(dirname "$LAB_SCRIPTS")
LAB_BUILD=${LAB_BUILD:-$LAB_ROOT/build/release} # another build's programs: LAB_BUILD=build/asan lab run ..
LAB_RUNS=${LAB_RUNS:-$LAB_ROOT/runs}
LAB_ROBOTS=${XDG_CACHE_HOME:-${HOME:-/nonexistent}/.cache}/lcmlab/robots/example-robot-data-6.0.0
export LAB_ROOT LAB_BUILD LAB_RUNS
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

# Where a run is: a folder, or a name under runs/. Prints the folder; fails when there is none.
find_run() {
  local dir
  for dir in "$1" "$LAB_RUNS/$1"; do
    if [ -f "$dir/experiment.yaml" ]; then
      readlink -f "$dir"
      return
    fi
  done
  return 1
}

# A run holds a lock on its own folder for as long as it lives: no lock file, and the kernel never forgets to unlock.
run_is_alive() { ! flock -n "$1" true; }

# A script's background job ignores INT, and bash cannot trap what was ignored when it started: start again, heeding it.
heed_interrupts() {
  local ignored
  ignored=$(sed -n 's/^SigIgn:[[:space:]]*//p' /proc/self/status)
  [ $((0x$ignored & 2)) -eq 0 ] || exec env --default-signal=INT "$0" "$@"
}

# shellcheck shell=bash
# Sourced first by every verb: paths, messages, exit codes, the clock; run folders and running labs are in lib-runs.sh.
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

# restore_interrupts ARGS..: when this script ignores INT (it is a background job of a script), restarts it with the
# default action: bash cannot trap a signal that was ignored when bash started.
restore_interrupts() {
  local ignored
  ignored=$(sed -n 's/^SigIgn:[[:space:]]*//p' /proc/self/status)
  [ $((0x$ignored & 2)) -eq 0 ] || exec env --default-signal=INT "$0" "$@"
}

. "$LAB_SCRIPTS/lib-runs.sh"

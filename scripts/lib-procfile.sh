# shellcheck shell=bash disable=SC2034
# Procfiles: lines `NAME: command`, and policy in comment lines `#lab: NAME key=value ..`, which honcho and foreman ignore.
# A part of scripts/supervise, which runs them, and of scripts/lab-up, which checks and combines them.
names=()                                        # in the file's order
declare -A command=() required=() finish=()     # by name
declare -A policy=() cap=()
guests=()                                       # may take part without the launch's nonce

# read_procfile FILE: fills the tables above; exits with 2 at a line that it cannot read.
read_procfile() {
  local line number=0 at
  while IFS= read -r line || [ -n "$line" ]; do
    number=$((number + 1)) at=$1:$number
    if [[ $line =~ ^'#lab:'[[:space:]]*([A-Za-z0-9_-]+)(.*)$ ]]; then
      read_policy "$at" "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}"
    elif [[ $line =~ ^([A-Za-z0-9_-]+):[[:space:]]*([^[:space:]].*)$ ]]; then
      [ -z "${command[${BASH_REMATCH[1]}]:-}" ] || usage_error "$at: two processes are named '${BASH_REMATCH[1]}'"
      names+=("${BASH_REMATCH[1]}")
      command[${BASH_REMATCH[1]}]=${BASH_REMATCH[2]}
    elif [[ ! $line =~ ^[[:space:]]*(#.*)?$ ]]; then
      usage_error "$at: cannot read the line '$line' (a line is NAME: command)"
    fi
  done <"$1"
  [ ${#names[@]} -gt 0 ] || usage_error "$1: no process in it (a line is NAME: command)"
}

read_policy() { # FILE:LINE NAME WORDS
  local word
  for word in $3; do
    case $word in
      required=yes | required=no) required[$2]=${word#*=} ;;
      restart=never | restart=on-failure | restart=always) policy[$2]=${word#*=} ;;
      max=*) [[ ${word#*=} =~ ^[0-9]+$ ]] || usage_error "$1: '$word' is not a count"
        cap[$2]=${word#*=} ;;
      guest=yes) guests+=("$2") ;;
      guest=no) ;;
      finish=*) [[ ${word#*=} =~ ^[0-9]+$ ]] || usage_error "$1: '$word' is not a number of seconds"
        finish[$2]=${word#*=} ;;
      *) usage_error "$1: cannot do '$word' of process '$2'" ;;
    esac
  done
}

# check_policies FILE: policy stands for processes of the file only.
check_policies() {
  local name
  for name in "${!required[@]}" "${!finish[@]}" "${!policy[@]}" "${!cap[@]}"; do
    [ -n "${command[$name]:-}" ] || usage_error "$1: policy for '$name', which is not a process of it"
  done
}

# replaces_parts: whether what was read is meant for a lab of ours: it has one of our processes, and not the simulator
usual_processes=(simulator planner controller logger renderer)
replaces_parts() {
  local name
  [ -z "${command[simulator]:-}" ] || return 1
  for name in "${usual_processes[@]}"; do [ -z "${command[$name]:-}" ] || return 0; done
  return 1
}

# check_names FILE: a name that is nearly one of ours would run beside the process that it was meant to replace.
check_names() {
  local name near
  for name in "${names[@]}"; do
    [[ " ${usual_processes[*]} " != *" $name "* ]] || continue
    near=$(near_names "$name" "${usual_processes[@]}")
    [ -z "$near" ] || [[ $name == "$near"* ]] || usage_error "$1: process '$name' would run beside our own, did you mean: $near?"
  done
}

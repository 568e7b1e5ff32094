# shellcheck shell=bash
# Bash completion of `lab`: . scripts/completion.bash
_lab() {
  local scripts word=${COMP_WORDS[COMP_CWORD]} verb=${COMP_WORDS[1]:-} file run_names
  scripts=$(dirname "$(readlink -f "$(command -v "${COMP_WORDS[0]}" || echo "${COMP_WORDS[0]}")")")
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(for file in "$scripts"/lab-*; do echo "${file##*/lab-}"; done | grep -- "^$word")
    return
  fi
  run_names=$(cd "${LAB_RUNS:-$scripts/../runs}" 2>/dev/null && ls)
  case $word in
    -*) mapfile -t COMPREPLY < <("$scripts/lab-$verb" --help 2>/dev/null | grep -oE -- '(^|[^a-zA-Z-])--?[a-z][a-z-]*' | grep -oE -- '--?[a-z-]+' | sort -u | grep -- "^$word") ;;
    *)
      case $verb in
        run | up) mapfile -t COMPREPLY < <(compgen -f -- "$word"; cd "$scripts/../experiments" && compgen -f -X '!*.yaml' -- "$word") ;;
        sweep) mapfile -t COMPREPLY < <(compgen -f -- "$word"; cd "$scripts/../experiments/sweeps" && compgen -f -X '!*.yaml' -- "$word") ;;
        restart | logs | set) mapfile -t COMPREPLY < <(compgen -W "simulator planner controller logger renderer" -- "$word") ;;
        spy) mapfile -t COMPREPLY < <(compgen -W "list hz echo who ROBOT_STATE REFERENCE COMMAND INPUT EVENT PROCESS RUN END ACK NEED" -- "$word") ;;
        *) mapfile -t COMPREPLY < <(compgen -W "$run_names" -- "$word") ;;
      esac ;;
  esac
}
complete -F _lab lab ./scripts/lab scripts/lab

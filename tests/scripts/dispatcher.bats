#!/usr/bin/env bats
# The one entry: verbs, help, near names; and rules that hold for every script.
bats_require_minimum_version 1.5.0
load common
setup() { common_setup; }

verbs() { for f in "$ROOT"/scripts/lab-*; do echo "${f##*/lab-}"; done; }

@test "help lists every verb with one line" {
  run "$LAB" help
  [ "$status" -eq 0 ]
  for v in $(verbs); do grep -qE "^  $v +[A-Za-z]" <<<"$output"; done
  [ "$output" = "$("$LAB")" ]
}

@test "every verb explains itself with an example" {
  for v in $(verbs); do
    run "$LAB" "$v" --help
    [ "$status" -eq 0 ]
    [[ $output == "lab $v"* ]]
    grep -q "^example: scripts/lab $v" <<<"$output"
  done
}

@test "every verb refuses an unknown option with 2" {
  for v in $(verbs); do
    [ "$v" = test ] && continue # hands them to ctest
    run "$LAB" "$v" --no-such-option
    [ "$status" -eq 2 ]
  done
}

@test "an unknown verb: near names and 2" {
  run "$LAB" rum
  [ "$status" -eq 2 ]
  [[ $output == *"did you mean: run"* ]]
  run "$LAB" ../../bin/true
  [ "$status" -eq 2 ]
}

@test "help VERB is VERB --help, --version names version and commit" {
  [ "$("$LAB" help run)" = "$("$LAB" run --help)" ]
  run "$LAB" help rnu
  [ "$status" -eq 2 ]
  [[ $output == "lab: there is no verb 'rnu', did you mean: run?"* ]]
  run "$LAB" --version
  [ "$status" -eq 0 ]
  [[ $output =~ ^lab\ [0-9.]+\ \(commit\ [0-9a-z-]+ ]]
}

@test "--option=value is --option value in every verb, but not behind --" {
  run "$LAB" run cubic_pd --timeout=0,5
  [ "$status" -eq 2 ]
  [[ $output == "lab run: --timeout is '0,5', a decimal comma: write 0.5 (see: scripts/lab run --help)" ]]
  run bash -c ". '$ROOT/scripts/lib.sh'; printf '[%s]' \"\$@\"" "$ROOT/scripts/lab-x" --a=b=c '--d=' --json e=f -g=h -- --i=j
  [ "$output" = '[--a][b=c][--d][][--json][e=f][-g=h][--][--i=j]' ]
  run bash -c ". '$ROOT/scripts/lib.sh'; printf '[%s]' \"\$@\"" "$ROOT/scripts/lab-exec" --lab=x prog --i=j
  [ "$output" = '[--lab][x][prog][--i=j]' ]
}

@test "an unknown option is answered with near ones, a refusal under --json with JSON on stdout" {
  run "$LAB" run --tiemout 3 cubic_pd
  [ "$status" -eq 2 ]
  [ "$output" = "lab run: unknown option '--tiemout', did you mean: --timeout? (see: scripts/lab run --help)" ]
  run --separate-stderr "$LAB" run --json 'no"such'
  [ "$status" -eq 3 ]
  python3 -c 'import json, sys; x = json.loads(sys.argv[1]); assert x["exit_code"] == 3 and "no\"such" in x["error"], x' "$output"
}

@test "works from anywhere and through a link" {
  cd "$BATS_TEST_TMPDIR"
  ln -s "$LAB" mylab
  run ./mylab help
  [ "$status" -eq 0 ]
  [[ $output == *demo* ]]
}

@test "scripts are shellcheck clean, do not sleep, do not read YAML" {
  cd "$ROOT/scripts"
  files=()
  for f in *; do head -n 1 "$f" | grep -q -e bash -e shellcheck && files+=("$f"); done
  shellcheck -x "${files[@]}" "$ROOT/.ci/run"
  ! grep -nwE '^[^#]*\b(sleep|usleep)\b' ./*
  ! grep -nE '(grep|sed|awk)[^|]*\.yaml' ./*
}

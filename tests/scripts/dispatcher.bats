#!/usr/bin/env bats
# The one entry: verbs, help, near names; and rules that hold for every script.
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

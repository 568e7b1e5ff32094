#!/usr/bin/env bats
# lab sweep: which file, which folder, what goes on to lab-experiment.
load common
setup() {
  common_setup
  mkdir -p "$LAB_BUILD/bin"
  printf '#!/bin/sh\nprintf "%%s|" "$@"\n' >"$LAB_BUILD/bin/lab-experiment"
  chmod +x "$LAB_BUILD/bin/lab-experiment"
}

@test "a sweep by name, by file, and into a folder" {
  run "$LAB" sweep kp_kd
  [ "$output" = "sweep|$ROOT/experiments/sweeps/kp_kd.yaml|-o|$LAB_RUNS/sweep-kp_kd|" ]
  touch "$BATS_TEST_TMPDIR/my file.yaml"
  run "$LAB" sweep "$BATS_TEST_TMPDIR/my file.yaml" -j 3 --engine slurm --json
  [ "$output" = "sweep|$BATS_TEST_TMPDIR/my file.yaml|-o|$LAB_RUNS/sweep-my file|-j|3|--engine|slurm|--json|" ]
  run "$LAB" sweep dt.yaml -o here --dry-run
  [ "$output" = "sweep|$ROOT/experiments/sweeps/dt.yaml|-o|here|--dry-run|" ]
}

@test "usage errors are one line and exit 2" {
  for words in "" "a b" "--fast" "kp_kd -o" "kp_kd -j"; do
    # shellcheck disable=SC2086  # several words
    run "$LAB" sweep $words
    [ "$status" -eq 2 ] && [ "${#lines[@]}" -eq 1 ]
  done
}

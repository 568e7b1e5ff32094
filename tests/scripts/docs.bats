#!/usr/bin/env bats
# shellcheck disable=SC2016
# What the pages point at exists: tests that are named as proofs, files that are linked.
load common
setup() { common_setup; }

# Suite.Name of every test in the sources.
tests() {
  grep -rhoE 'TEST(_F|_P)?\([A-Za-z]+, *[A-Za-z0-9]+' "$ROOT"/tests/core |
    sed -E 's/TEST(_F|_P)?\(//; s/, */./' | sort -u
}

@test "every test named in docs/algorithms.md exists" {
  tests >"$BATS_TEST_TMPDIR/tests"
  named=$(grep -oE '`[A-Z][A-Za-z]+\.[A-Z][A-Za-z]+`' "$ROOT/docs/algorithms.md" | tr -d '`' | sort -u)
  [ "$(wc -l <<<"$named")" -gt 30 ]
  while read -r name; do grep -qx "$name" "$BATS_TEST_TMPDIR/tests" || { echo "no such test: $name"; return 1; }; done <<<"$named"
}

@test "every claim of docs/frames.md names a test, and every test of frames_test.cc is named" {
  grep -oE '\[`[A-Za-z]+`\]' "$ROOT/docs/frames.md" | tr -d '[]`' | sort -u >"$BATS_TEST_TMPDIR/named"
  grep -hoE 'TEST(_F|_P)?\([A-Za-z]+, *[A-Za-z0-9]+' "$ROOT/tests/core/algorithm/frames_test.cc" |
    sed -E 's/.*, *//' | sort -u >"$BATS_TEST_TMPDIR/written"
  run diff "$BATS_TEST_TMPDIR/named" "$BATS_TEST_TMPDIR/written"
  echo "$output"
  [ "$status" -eq 0 ]
}

@test "every example is in docs/examples.md, and every link in docs leads somewhere" {
  for f in "$ROOT"/examples/[0-9]*.cc; do grep -q "(../examples/$(basename "$f"))" "$ROOT/docs/examples.md"; done
  for page in "$ROOT"/README.md "$ROOT"/docs/*.md; do
    while read -r link; do
      [ -e "$(dirname "$page")/$link" ] || { echo "$page: $link"; return 1; }
    done < <(grep -oE '\]\([^):# ]+[)# ]' "$page" | sed -E 's/^..//; s/.$//')
  done
}

@test "the catalogue's pictures are small, and all of them are shown" {
  for f in "$ROOT"/docs/pictures/catalogue/*; do
    grep -q "(pictures/catalogue/$(basename "$f"))" "$ROOT/docs/experiments.md" || { echo "not shown: $f"; return 1; }
    most=30000
    [[ $f != *.svg ]] || most=45000
    [ "$(stat -c %s "$f")" -le $most ] || { echo "too large: $f"; return 1; }
  done
}

@test "every source that a page names exists" {
  tops='core|wire|lab|procs|render|lcmtypes|bench|examples|scripts|tests|experiments|models|docs'
  for page in "$ROOT"/README.md "$ROOT"/CONTRIBUTING.md "$ROOT"/docs/*.md; do
    while read -r file; do
      [ -e "$ROOT/$file" ] || { echo "$page: $file"; return 1; }
    done < <(grep -oE "\`($tops)/[A-Za-z0-9_./-]+\.[a-z]+\`" "$page" | tr -d '`' | grep -v NAME)
  done
}

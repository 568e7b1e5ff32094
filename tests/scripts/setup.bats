#!/usr/bin/env bats
# lab setup: silent when all is there, one exact command when it may not install.
load common
setup() {
  common_setup
  export LAB_PACKAGES=$BATS_TEST_TMPDIR/packages
  mkdir "$BATS_TEST_TMPDIR/bin"
  PATH=$BATS_TEST_TMPDIR/bin:$PATH
}

pretend() { # NAME LINE: a command of that name in front of the real one
  printf '#!/bin/bash\n%s\n' "$2" >"$BATS_TEST_TMPDIR/bin/$1"
  chmod +x "$BATS_TEST_TMPDIR/bin/$1"
}

@test "all there: silent, 0" {
  command -v dpkg-query || skip "no dpkg here"
  printf '# a comment\n\nbash\ncoreutils\n' >"$LAB_PACKAGES"
  run "$LAB" setup
  [ "$status" -eq 0 ]
  [ -z "$output" ]
}

@test "missing, and not root: the exact command, 2" {
  printf 'bash\nno-such-package\n' >"$LAB_PACKAGES"
  pretend dpkg-query 'echo "ii  bash"; echo "rc  no-such-package"'
  pretend id 'echo 1000'
  pretend sudo 'exit 1'
  run "$LAB" setup
  [ "$status" -eq 2 ]
  grep -qx '  sudo apt-get update && sudo apt-get install -y --no-install-recommends no-such-package' <<<"$output"
}

@test "missing, and sudo without password: installs only what is missing" {
  printf 'bash\nno-such-package\n' >"$LAB_PACKAGES"
  pretend dpkg-query 'echo "ii  bash"'
  pretend id 'echo 1000'
  pretend sudo "shift; echo \"sudo \$*\" >>$BATS_TEST_TMPDIR/asked"
  run "$LAB" setup
  [ "$status" -eq 0 ]
  [ "$(grep -c apt-get "$BATS_TEST_TMPDIR/asked")" -eq 2 ]
  grep -q 'apt-get install -y --no-install-recommends no-such-package' "$BATS_TEST_TMPDIR/asked"
}

@test "an installation that fails is 1" {
  echo no-such-package >"$LAB_PACKAGES"
  pretend dpkg-query 'true'
  pretend id 'echo 0'
  pretend apt-get 'exit 100'
  run "$LAB" setup
  [ "$status" -eq 1 ]
}

@test "packages.txt: names only, each once" {
  list=$ROOT/scripts/packages.txt
  ! sed -E 's/^#(test|full): *//' "$list" | grep -vE '^ *(#|$)' | grep -vE '^[a-z0-9.+-]+$'
  [ -z "$(sed -E 's/^#(test|full): *//' "$list" | grep -vE '^ *(#|$)' | sort | uniq -d)" ]
}

@test "--test and --full: what only tests and only the long tests need, too" {
  printf 'bash\n# only for tests\n#test: no-such-tester\n#full: no-such-compiler\n' >"$LAB_PACKAGES"
  pretend dpkg-query 'echo "ii  bash"'
  pretend id 'echo 1000'
  pretend sudo 'exit 1'
  run "$LAB" setup
  [ "$status" -eq 0 ]
  run "$LAB" setup --test
  [ "$status" -eq 2 ]
  [[ $output == *"--no-install-recommends no-such-tester" ]]
  run "$LAB" setup --full
  [ "$status" -eq 2 ]
  [[ $output == *"--no-install-recommends no-such-tester no-such-compiler" ]]
  run "$LAB" setup --tset
  [ "$status" -eq 2 ]
  [[ $output == *"unknown option '--tset'"* ]]
}

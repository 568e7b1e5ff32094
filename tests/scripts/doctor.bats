#!/usr/bin/env bats
# lab doctor: each trouble is found when it is made to happen, each with its remedy; and it is not found without.
load common

setup() { common_setup; }
teardown() { common_teardown; }

# verdict_of WHAT: verdict and remedy in $output of doctor --json
verdict_of() { python3 -c 'import json, sys; print(next(f["verdict"] + " " + f["remedy"] for f in json.load(sys.stdin) if f["what"] == sys.argv[1]))' "$1" <<<"$output"; }

# doctor [COMMAND..]: its findings, seen by the doctor under COMMAND, which runs the words it is given
doctor() { output=$("$@" "$LAB" doctor --json || true); }

needs() { # root|userns|CAPABILITY
  case $1 in
    root) [ "$(id -u)" = 0 ] || skip "needs root" ;;
    userns) unshare -Urn true 2>/dev/null || skip "no user namespaces here" ;;
    *) command -v capsh >/dev/null && [ "$(id -u)" = 0 ] || skip "needs root and capsh" ;;
  esac
}

@test "each finding is a line, each remedy another" {
  run "$LAB" doctor
  [ "$status" -eq 1 ]
  grep -qE '^bad +programs +not built: lab-simulator' <<<"$output"
  grep -A1 '^bad  *programs' <<<"$output" | grep -qE '^ +-> scripts/lab build$'
  [ "$(grep -cE '^(ok|note|bad) ' <<<"$output")" -ge 8 ]
  [ "$(grep -cE '^(note|bad) ' <<<"$output")" -eq "$(grep -c -- '->' <<<"$output")" ]
}

@test "programs that are not built, and that are" {
  doctor
  [ "$(verdict_of programs)" = "bad scripts/lab build" ]
  mkdir -p "$LAB_BUILD/bin"
  for p in simulator planner controller logger renderer experiment send spy model; do
    ln -s /bin/true "$LAB_BUILD/bin/lab-$p"
  done
  doctor
  [ "$(verdict_of programs)" = "ok " ]
}

@test "a package that is missing" {
  command -v dpkg-query >/dev/null || skip "no dpkg here"
  printf '# reason\ncoreutils\nno-such-package-here\n' >"$BATS_TEST_TMPDIR/packages"
  LAB_PACKAGES=$BATS_TEST_TMPDIR/packages doctor
  [ "$(verdict_of packages)" = "bad scripts/lab setup" ]
  [[ $output == *"missing: no-such-package-here"* ]]
  sed -i '/no-such/d' "$BATS_TEST_TMPDIR/packages"
  LAB_PACKAGES=$BATS_TEST_TMPDIR/packages doctor
  [ "$(verdict_of packages)" = "ok " ]
}

@test "a run folder that was killed, and one that cannot be written" {
  mkdir -p "$LAB_RUNS/old/processes"
  echo '{"lcmlab": "running", "state": "running", "files": ["manifest.json", "processes/control"]}' >"$LAB_RUNS/old/manifest.json"
  mkfifo "$LAB_RUNS/old/processes/control"
  doctor
  [ "$(verdict_of leftovers)" = "note scripts/lab clean old" ]
  exec {lock}<"$LAB_RUNS/old" # it runs: its owner holds the lock
  flock -n "$lock"
  doctor
  [ "$(verdict_of leftovers)" = "ok " ]
  exec {lock}<&-
  doctor
  yes | "$LAB" clean old # the remedy
  doctor
  [ "$(verdict_of leftovers)" = "ok " ]
  LAB_RUNS=/proc/nowhere doctor
  [[ $(verdict_of 'run folder') == "bad LAB_RUNS="* ]]
}

@test "a disk that is full, or nearly" {
  needs userns
  way=(unshare -m)
  "${way[@]}" true 2>/dev/null || way=(unshare -Urm)
  disk=$BATS_TEST_TMPDIR/disk
  mkdir "$disk"
  # shellcheck disable=SC2016  # expands there
  on_disk() { output=$(LAB_RUNS=$disk/runs "${way[@]}" bash -c 'mount -t tmpfs -o size=$1 lab "$0" && mkdir "$0/runs" && { [ -z "$3" ] || head -c $3 /dev/zero 2>/dev/null >"$0/runs/log"; }; "$2" doctor --json' "$disk" "$1" "$LAB" "${2:-}" || true); }
  on_disk 1m 2000000
  [ "$(verdict_of disk)" = "bad scripts/lab clean" ]
  [[ $output == *"0 MB free"* ]]
  on_disk 500m
  [ "$(verdict_of disk)" = "note scripts/lab clean" ]
  on_disk 2000m
  [ "$(verdict_of disk)" = "ok " ]
}

@test "no multicast route, and its remedy" {
  needs userns
  doctor unshare -Urn
  [[ $(verdict_of 'multicast route') == "bad sudo ip route add 224.0.0.0/4 dev lo && sudo ip link set lo multicast on"* ]]
  remedy=$(verdict_of 'multicast route')
  remedy=${remedy#bad } remedy=${remedy%% (or*}
  doctor unshare -Urn bash -c "ip link set lo up; ${remedy//sudo /}"' && exec "$@"' bash
  [[ $(verdict_of 'multicast route') == ok* ]]
}

@test "a port that another process uses" {
  needs userns
  # shellcheck disable=SC2016
  on_port() { doctor unshare -Urn bash -c 'python3 -c "import socket, subprocess, sys; s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); s.bind((\"\", int(sys.argv[1]))); subprocess.run(sys.argv[2:])" '"$1"' "$@"' bash; }
  on_port 7667
  [[ $(verdict_of 'LCM port') == "note lab up --private, or LCM_DEFAULT_URL with another port" ]]
  on_port 7668
  [ "$(verdict_of 'LCM port')" = "ok " ]
}

@test "buffers that the kernel clamps, for root without the right too" {
  needs cap_net_admin
  most=$(cat /proc/sys/net/core/rmem_max)
  export LCM_DEFAULT_URL="udpm://239.255.76.67:7667?ttl=0&recv_buf_size=$((most + 100000))"
  doctor
  [ "$(verdict_of 'socket buffers')" = "ok " ]
  output=$(capsh --drop=cap_net_admin -- -c "$LAB doctor --json" || true)
  [ "$(verdict_of 'socket buffers')" = "note sudo sysctl -w net.core.rmem_max=$((most + 100000))" ]
  [[ $output == *"clamped to $most bytes"* ]]
}

@test "no right to namespaces" {
  needs userns
  # a user namespace whose owner may make none below it
  # shellcheck disable=SC2016
  doctor unshare -Ur bash -c 'for kind in user net pid; do echo 0 >/proc/sys/user/max_${kind}_namespaces; done; exec "$@"' bash
  [[ $(verdict_of namespaces) == "note sudo sysctl -w kernel.unprivileged_userns_clone=1, or run as root" ]]
  doctor unshare -Ur bash -c 'exec "$@"' bash
  [ "$(verdict_of namespaces)" = "ok " ]
}

@test "no right to real time" {
  needs cap_sys_nice
  output=$(capsh --drop=cap_sys_nice -- -c "$LAB doctor --json" || true)
  [[ $(verdict_of 'real time') == "note as root, or in /etc/security/limits.conf: root - rtprio 60 (and memlock unlimited)" ]]
}

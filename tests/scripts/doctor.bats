#!/usr/bin/env bats
# lab doctor: each trouble is found when it is made to happen, each with its remedy.
load common

setup() { common_setup; }
teardown() { common_teardown; }

# verdict_of WHAT: in $output of doctor --json
verdict_of() { python3 -c 'import json, sys; print(next(f["verdict"] + " " + f["remedy"] for f in json.load(sys.stdin) if f["what"] == sys.argv[1]))' "$1" <<<"$output"; }

@test "programs that are not built" {
  run "$LAB" doctor --json
  [ "$status" -eq 1 ]
  [ "$(verdict_of programs)" = "bad scripts/lab build" ]
}

@test "a run folder that was killed, and one that cannot be written" {
  mkdir -p "$LAB_RUNS/old/processes"
  mkfifo "$LAB_RUNS/old/processes/control"
  run "$LAB" doctor --json
  [ "$(verdict_of leftovers)" = "note scripts/lab clean old" ]
  LAB_RUNS=/proc/nowhere run "$LAB" doctor --json
  [[ $(verdict_of 'run folder') == bad* ]]
}

@test "no multicast route, and a port that somebody else is on" {
  unshare -Urn true 2>/dev/null || skip "no namespaces here"
  output=$(unshare -Urn "$LAB" doctor --json || true)
  [[ $(verdict_of 'multicast route') == "bad sudo ip route add"* ]]
  output=$(unshare -Urn bash -c "ip link set lo up; ip route add 224.0.0.0/4 dev lo
    python3 -c 'import socket, subprocess; s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); s.bind((\"\", 7667)); subprocess.run([\"$LAB\", \"doctor\", \"--json\"])'")
  [[ $(verdict_of 'multicast route') == ok* ]]
  [[ $(verdict_of 'LCM port') == note* ]]
}

@test "no right to namespaces or real time" {
  command -v capsh >/dev/null && [ "$(id -u)" = 0 ] || skip "needs root and capsh"
  output=$(capsh --drop=cap_sys_nice -- -c "$LAB doctor --json" || true)
  [[ $(verdict_of 'real time') == note* ]]
}

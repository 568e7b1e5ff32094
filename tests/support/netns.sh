#!/bin/sh
# Runs a command in a private network namespace where LCM works on loopback:
#   tests/support/netns.sh COMMAND [ARG..]
# As root with `unshare -n`, else in a user namespace of its own. Where neither is allowed: exit 77 (ctest: skipped),
# or 1 when CI is set, because there a skipped network test would be a lie.
set -eu
[ $# -gt 0 ] || { echo "usage: $0 COMMAND [ARG..]" >&2; exit 2; }

if unshare -n true 2>/dev/null; then
  flags=-n
elif unshare -Urn true 2>/dev/null; then
  flags=-Urn
else
  echo "$0: no private network namespace: neither 'unshare -n' nor 'unshare -Urn' is allowed here" >&2
  [ -n "${CI:-}" ] && exit 1
  exit 77
fi
exec unshare "$flags" sh -c '
  export LAB_PRIVATE_NETNS=1  # tests that touch routes or the firewall insist on it
  ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo || exit 1
  exec "$@"' sh "$@"

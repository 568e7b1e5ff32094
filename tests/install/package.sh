#!/usr/bin/env bash
# An outside project finds the installed library, by CMake and by pkg-config, builds and computes the right numbers.
# usage: package.sh BUILD_DIR COMPILER
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
build=$1 compiler=$2
work=$build/install_test
rm -rf "$work" && mkdir -p "$work"

# an install may be moved
cmake --install "$build" --prefix "$work/first" --component core >"$work/install.log"
mv "$work/first" "$work/prefix"
[ ! -e "$work/prefix/include/rbd/kernel" ] || { echo "kernel headers are installed"; exit 1; }
# whatever an installed header includes is installed too
cd "$work/prefix/include"
grep -rhoP '#include "\Krbd/[^"]+' rbd | sort -u | while read -r header; do
  [ -e "$header" ] || { echo "an installed header includes $header, which is not installed"; exit 1; }
done
cd "$here"

cmake -G Ninja -S "$here/outside" -B "$work/outside" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_BUILD_TYPE=Release >"$work/configure.log" 2>&1 || { cat "$work/configure.log"; exit 1; }
cmake --build "$work/outside" >"$work/build.log" 2>&1 || { cat "$work/build.log"; exit 1; }
"$work/outside/outside"

# what is not there is said
if cmake -G Ninja -S "$here/outside" -B "$work/missing" -DCMAKE_PREFIX_PATH="$work/prefix" -DEXTRA=wings >"$work/missing.log" 2>&1; then
  echo "a component 'wings' was found" && exit 1
fi
grep -q wings "$work/missing.log"

pkgconfig=$(dirname "$(find "$work/prefix" -name lcmlab.pc)")
read -ra flags <<<"$(PKG_CONFIG_PATH=$pkgconfig pkg-config --cflags --libs lcmlab-urdf)"
"$compiler" -std=c++20 -O2 "$here/outside/main.cc" -o "$work/by_pkg_config" "${flags[@]}"
"$work/by_pkg_config"

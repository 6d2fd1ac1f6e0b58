#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# clang-tidy (.clang-tidy) over lib and apps. The adapters of CGAL, OMPL and FCL are left out: their headers alone take
# minutes each. Usage: run_tidy.sh TOP BUILD [regular expression of files]
set -euo pipefail
top=$1 build=$2 only=${3:-.}
# A configuration of its own: clang cannot read the precompiled headers of g++, so their source is included. Warnings of
# clang that g++ does not share, as of attributes of lambdas, are left to g++.
cmake -S "$top" -B "$build" -G Ninja -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON \
  -DMILLPOSE_TESTS=OFF -DMILLPOSE_UNITY=ON >/dev/null
cd "$top"
mapfile -t files < <(git ls-files 'lib/*.cpp' 'apps/*.cpp' | grep -E "$only" | xargs grep -LE '#include <(CGAL|ompl|fcl)/')
[ ${#files[@]} -gt 0 ] || { echo "no file matches $only"; exit 1; }
# Most of the time goes into headers, so files are looked at as the build compiles them: several of a module as one, of
# which those that are left out are taken.
wanted=$build/wanted_files
printf "$top/%s\n" "${files[@]}" >"$wanted"
mapfile -t units < <(find "$build" -name 'unity_*_cxx.cxx')
alone=$(cat "$wanted")
for unit in "${units[@]}"; do
  alone=$(grep -vxFf <(sed -n 's/^#include "\(.*\)"$/\1/p' "$unit") <<<"$alone" || true)
  kept=$(grep -E '^#include' "$unit" | grep -Ff "$wanted" || true)
  [ "$kept" = "$(grep -E '^#include' "$unit")" ] || printf '%s\n' "$kept" >"$unit"
done
mapfile -t units < <(grep -l '^#include' "${units[@]}")
[ -z "$alone" ] || mapfile -t -O "${#units[@]}" units <<<"$alone"
run-clang-tidy-16 -quiet -checks=-bugprone-suspicious-include -p "$build" -j "$(nproc)" "-extra-arg=-include$top/lib/base/pch.hpp" -extra-arg=-Wno-unknown-warning-option -extra-arg=-Wno-unknown-pragmas \
  -extra-arg=-Wno-unused-command-line-argument -extra-arg=-Wno-ignored-attributes -extra-arg=-Wno-c++2b-extensions -extra-arg=-Wno-missing-braces -extra-arg=-Wno-shadow "${units[@]/#/^}" 2>/dev/null

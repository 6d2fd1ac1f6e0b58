#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# clang-tidy (.clang-tidy) over lib and apps. The adapters of CGAL, OMPL and FCL are left out: their headers alone take
# minutes each. Usage: run_tidy.sh TOP BUILD [regular expression of files]
set -euo pipefail
top=$1 build=$2 only=${3:-.}
# A configuration of its own: clang cannot read the precompiled headers of g++, so their source is included. Warnings of
# clang 14 that g++ does not share, as of attributes of lambdas, are left to g++.
cmake -S "$top" -B "$build" -G Ninja -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON \
  -DMILLPOSE_TESTS=OFF -DMILLPOSE_UNITY=OFF >/dev/null
mapfile -t files < <(cd "$top" && git ls-files 'lib/*.cpp' 'apps/*.cpp' | grep -E "$only" |
  xargs grep -LE '#include <(CGAL|ompl|fcl)/')
[ ${#files[@]} -gt 0 ] || { echo "no file matches $only"; exit 1; }
cd "$top"
run-clang-tidy -quiet -p "$build" -j "$(nproc)" "-extra-arg=-include$top/lib/base/pch.hpp" -extra-arg=-Wno-unknown-warning-option -extra-arg=-Wno-unknown-pragmas \
  -extra-arg=-Wno-unused-command-line-argument -extra-arg=-Wno-ignored-attributes -extra-arg=-Wno-c++2b-extensions -extra-arg=-Wno-missing-braces "${files[@]/#/^$top/}" 2>/dev/null

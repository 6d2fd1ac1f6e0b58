# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by ./millpose and ./run-tests: what a fresh clone on Debian 12 needs before it can run.

# Installs what is missing of packages.txt, and of packages-slow.txt when $packages_slow is set. Without root it names
# the command to run instead.
millpose_packages() {
  local wanted missing=()
  local lists=("$top/packages.txt")
  [ -z "${packages_slow:-}" ] || lists+=("$top/packages-slow.txt")
  mapfile -t wanted < <(grep -hEv '^[[:space:]]*(#|$)' "${lists[@]}")
  local have
  have=$(dpkg-query -W -f '${db:Status-Abbrev} ${Package}\n' "${wanted[@]}" 2>/dev/null | awk '$1 == "ii" {print $2}' || true)
  local package
  for package in "${wanted[@]}"; do
    grep -qxF "$package" <<<"$have" || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  if [ "$(id -u)" -ne 0 ]; then
    echo "millpose: packages are missing; run this once, then try again:" >&2
    echo "  sudo apt-get update && sudo apt-get install -y --no-install-recommends ${missing[*]}" >&2
    exit 2
  fi
  echo "millpose: installing ${#missing[@]} packages: ${missing[*]}" >&2
  export DEBIAN_FRONTEND=noninteractive
  apt-get update -qq >&2
  apt-get install -y -qq --no-install-recommends "${missing[@]}" >"$log" 2>&1 || { cat "$log" >&2; exit 3; }
}

# Configures once and builds the target $1; quiet unless there is work or trouble.
millpose_setup() {
  local log
  log=$(mktemp)
  trap 'rm -f "$log"' RETURN
  millpose_packages
  local build=$top/build/release
  if [ ! -f "$build/build.ninja" ]; then
    echo "millpose: configuring" >&2
    (cd "$top" && cmake --preset release) >"$log" 2>&1 || { cat "$log" >&2; rm -f "$build/build.ninja"; exit 3; }
  fi
  if [ "$(ninja -C "$build" -n "$1" 2>/dev/null | tail -n 1)" != "ninja: no work to do." ]; then
    echo "millpose: building (the first time takes some minutes)" >&2
    ninja -C "$build" "$1" >"$log" 2>&1 || { cat "$log" >&2; exit 3; }
  fi
}

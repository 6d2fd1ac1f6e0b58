# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by ./millpose and ./run-tests: what a fresh clone on Debian 12 needs before it can run. Quiet unless there is
# work or trouble; all it says goes to stderr.

# millpose_run_logged <what fails> <command…>: runs it with its output in build/setup.log, shown only when it fails,
# without the steps that a build counted. What the command writes to descriptor 8 is shown at once.
millpose_run_logged() {
  local what=$1 log=$top/build/setup.log
  shift
  exec 7>&2  # the trap runs where stderr is the log
  trap 'printf "\nmillpose: stopped; the same command goes on from there\n" >&7; exit 130' INT
  local status=0
  "$@" 8>&2 >"$log" 2>&1 || status=$?
  trap - INT
  exec 7>&-
  [ "$status" -ne 0 ] || return 0
  grep -Ev '^\[[0-9]+/[0-9]+\]' "$log" >&2 || true
  echo "millpose: $what failed (see above, all of it in $log)" >&2
  exit 3
}

# Installs what is missing of packages.txt, and of packages-slow.txt when $packages_slow is set. Without root it names
# the command to run instead. Works without /proc, so no process substitution.
millpose_packages() {
  local wanted have package missing=() lists=("$top/packages.txt")
  [ -z "${packages_slow:-}" ] || lists+=("$top/packages-slow.txt")
  wanted=$(grep -hEv '^[[:space:]]*(#|$)' "${lists[@]}")
  # shellcheck disable=SC2086  # one word a package
  have=$(dpkg-query -W -f '${db:Status-Abbrev} ${Package}\n' $wanted 2>/dev/null | awk '$1 == "ii" {print $2}' || true)
  for package in $wanted; do
    grep -qxF "$package" <<<"$have" || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  if [ "$(id -u)" -ne 0 ]; then
    echo "millpose: packages are missing; run this once, then try again:" >&2
    echo "  sudo apt-get update && sudo apt-get install -y --no-install-recommends ${missing[*]}" >&2
    exit 2
  fi
  echo "millpose: installing ${#missing[@]} packages: ${missing[*]}" >&2
  mkdir -p "$top/build"
  millpose_run_logged "apt-get update" env DEBIAN_FRONTEND=noninteractive apt-get update -qq
  millpose_run_logged "apt-get install" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends "${missing[@]}"
}

millpose_up_to_date() {
  [ -f "$1/build.ninja" ] && [ "$(ninja -C "$1" -n "$2" 2>/dev/null | tail -n 1)" = "ninja: no work to do." ]
}

# millpose_build <build folder> <target>: ninja, with its count and the time left on descriptor 8: a line that moves on a
# terminal, else one a minute. The time left takes all steps for alike.
millpose_build() {
  local began=$SECONDS shown=$SECONDS columns=80
  [ ! -t 8 ] || columns=$(stty size <&8 2>/dev/null | cut -d ' ' -f 2) || true
  [ "${columns:-0}" -gt 0 ] || columns=80
  # Ctrl-C is for ninja: what it says last still belongs to the log.
  ninja -C "$1" "$2" | (trap '' INT; while IFS= read -r line; do
    printf '%s\n' "$line"
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]] || continue
    local done=${BASH_REMATCH[1]} all=${BASH_REMATCH[2]} took=$((SECONDS - began))
    local left=$((done > 0 ? took * (all - done) / done : 0))
    local text="millpose: compiling, step $done of $all, $((took / 60)) min $((took % 60)) s, about $((left / 60)) min $((left % 60)) s left"
    if [ -t 8 ]; then
      printf '\r%-*s' $((columns - 1)) "${text:0:columns-1}" >&8
    elif ((SECONDS - shown >= 60)); then
      shown=$SECONDS
      printf '%s\n' "$text" >&8
    fi
  done)
  local status=${PIPESTATUS[0]}
  [ ! -t 8 ] || printf '\r%-*s\r' $((columns - 1)) '' >&8
  return "$status"
}

# millpose_setup <target> [<preset>]: installs, configures once and builds what is out of date.
millpose_setup() {
  local target=$1 preset=${2:-release}
  local build=$top/build/$preset
  millpose_packages
  millpose_up_to_date "$build" "$target" && return
  mkdir -p "$top/build"
  exec 9>"$top/build/.lock"  # two that start at once must not build into one folder
  flock -n 9 || { echo "millpose: waiting for another build" >&2; flock 9; }
  if [ ! -f "$build/build.ninja" ]; then
    echo "millpose: configuring" >&2
    millpose_run_logged "configuring" env -C "$top" cmake --preset "$preset"
  fi
  if ! millpose_up_to_date "$build" "$target"; then
    echo "millpose: compiling; the first time takes about 10 minutes on two cores," >&2
    echo "millpose: later only what changed is compiled" >&2
    millpose_run_logged "building" millpose_build "$build" "$target"
  fi
  exec 9>&-
}

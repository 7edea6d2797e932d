#!/usr/bin/env bash
# Runs the README's commands in an empty Debian system, see --help.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
# shellcheck source=../scripts/workspace.sh
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/workspace.sh"

usage() {
  cat <<TEXT
usage: bash fresh_root.sh bullseye|bookworm|trixie [demo|test]...

Makes an empty Debian 11 (bullseye), 12 (bookworm) or 13 (trixie) by debootstrap, puts the files of the commit HEAD into
it, and runs there what a newcomer would run. Closes with a verdict and a time for each, and removes everything that it made.
Needs root and debootstrap.

  demo     bash ddm_launch/scripts/demo.sh
  test     bash ddm_launch/scripts/test.sh
  --help   this text

Without any of the two: demo and test, one after the other in the same system.

  TMPDIR          folder for the system, default /tmp; takes 10 GB
  DEBIAN_MIRROR   address of a Debian mirror, default that of this machine's apt
TEXT
}

refuse() {
  printf 'fresh_root.sh: %s\n\n' "$*" >&2
  usage >&2
  exit 2
}

parse_arguments() {
  local word
  for word in "$@"; do [[ $word != --help && $word != -h ]] || { usage && exit 0; }; done
  suite=${1:-}
  [[ $suite =~ ^(bullseye|bookworm|trixie)$ ]] ||
    refuse "the first argument must be bullseye, bookworm or trixie, got '$suite'"
  shift
  parts=("$@")
  ((${#parts[@]})) || parts=(demo test)
  for word in "${parts[@]}"; do
    [[ $word =~ ^(demo|test)$ ]] || refuse "unknown argument '$word'"
  done
}

check_tools() {
  local tool
  for tool in debootstrap unshare git; do
    command -v "$tool" >/dev/null || fail "$tool is not installed. Remedy: install it by your package manager."
  done
  [[ $(id -u) == 0 ]] || fail "only root can make a system. Remedy: call this script as root."
}

# The mirror that this machine's apt uses for Debian itself.
default_mirror() {
  apt-get indextargets --format '$(SITE)' 'Created-By: Packages' 'Origin: Debian' 'Label: Debian' 2>/dev/null | head -n 1
}

make_root() {  # FOLDER
  debootstrap --variant=minbase "$suite" "$1" "$mirror" >"$1.log" 2>&1 || {
    tail -n 20 "$1.log" >&2
    fail "debootstrap failed, see above."
  }
  printf '127.0.0.1 localhost\n127.0.1.1 %s\n' "$(uname -n)" >"$1/etc/hosts"  # as Debian's installer does
}

run_script() {  # demo|test
  local root=$folder/root
  if [[ ! -d $root ]]; then
    make_root "$root"
    mkdir "$root/root/ddm"
    git -C "$checkout" archive HEAD | tar -x -C "$root/root/ddm"
  fi
  mount -t proc proc "$root/proc"
  mount -t sysfs sysfs "$root/sys"
  mount -t devpts -o newinstance,ptmxmode=666 devpts "$root/dev/pts"
  mkdir -p "$root/dev/shm"
  mount -t tmpfs tmpfs "$root/dev/shm"
  chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    sh -c "cd /root/ddm && bash ddm_launch/scripts/$1.sh" </dev/null
}

# Mounts and processes end with it.
run_part() {  # demo|test
  export folder suite mirror checkout
  unshare --mount-proc --pid --fork --kill-child bash -euo pipefail -c "$(declare -f); run_script $1"
}

main() {
  parse_arguments "$@"
  check_tools
  mirror=${DEBIAN_MIRROR:-$(default_mirror)}
  [[ -n $mirror ]] || fail "this machine's apt names no Debian mirror. Remedy: set DEBIAN_MIRROR."
  folder=$(mktemp -d)
  trap 'rm -rf --one-file-system "$folder"' EXIT
  local part start code failed=0 verdicts=()
  for part in "${parts[@]}"; do
    say "$suite, commit $(git -C "$checkout" rev-parse --short HEAD): $part"
    start=$SECONDS code=0
    run_part "$part" || code=$?
    verdicts+=("$(printf '%5d s  %s %s: %s' $((SECONDS - start)) "$suite" "$part" \
      "$( ((code == 0)) && echo passed || echo "failed with code $code")")")
    ((code == 0)) || failed=1
  done
  say "Result"
  printf '%s\n' "${verdicts[@]}"
  return "$failed"
}

main "$@"

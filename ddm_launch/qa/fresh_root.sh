#!/usr/bin/env bash
# Runs the README's commands in an empty Debian system, see --help.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
# shellcheck source=../scripts/workspace.sh
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/workspace.sh"

usage="usage: bash fresh_root.sh bullseye|bookworm|trixie demo|test

Makes an empty Debian 11 (bullseye), 12 (bookworm) or 13 (trixie) by debootstrap, puts the files of the commit HEAD into it, and
runs there the script of this name in ddm_launch/scripts. Closes with a verdict and a time, and removes everything that it
made. Needs root and debootstrap.

  TMPDIR          folder for the system, default /tmp; takes 10 GB
  DEBIAN_MIRROR   address of a Debian mirror, default that of this machine's apt"

# Prints the address of the mirror that this machine's apt uses for Debian's own packages.
default_mirror() {
  apt-get indextargets --format '$(SITE)' 'Created-By: Packages' 'Origin: Debian' 'Label: Debian' 2>/dev/null | head -n 1
}

make_root() {  # FOLDER
  debootstrap --variant=minbase "$suite" "$1" "$mirror" >"$1.log" 2>&1 || {
    tail -n 20 "$1.log" >&2
    fail "debootstrap failed, see above."
  }
  printf '127.0.0.1 localhost\n127.0.1.1 %s\n' "$(uname -n)" >"$1/etc/hosts"  # same content as from Debian's installer
}

# Runs in its own namespaces, so that mounts and processes end with them.
run_script() {
  mount -t proc proc "$root/proc"
  mount -t sysfs sysfs "$root/sys"
  mount -t devpts -o newinstance,ptmxmode=666 devpts "$root/dev/pts"
  mkdir -p "$root/dev/shm"
  mount -t tmpfs tmpfs "$root/dev/shm"
  chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    sh -c "cd /root/ddm && bash ddm_launch/scripts/$script.sh" </dev/null
}

main() {
  [[ " $* " != *" --help "* ]] || { echo "$usage" && exit 0; }
  [[ "$*" =~ ^(bullseye|bookworm|trixie)\ (demo|test)$ ]] || { printf "bad arguments '%s'\n\n%s\n" "$*" "$usage" >&2 && exit 2; }
  suite=$1 script=$2
  local tool code=0
  for tool in debootstrap unshare git; do
    command -v "$tool" >/dev/null || fail "$tool is not installed. Remedy: install it by your package manager."
  done
  [[ $(id -u) == 0 ]] || fail "only root can make a system. Remedy: call this script as root."
  mirror=${DEBIAN_MIRROR:-$(default_mirror)}
  [[ -n $mirror ]] || fail "this machine's apt names no Debian mirror. Remedy: set DEBIAN_MIRROR."
  folder=$(mktemp -d)  # not local, because the trap runs after main
  trap 'rm -rf --one-file-system "$folder"' EXIT
  say "$suite, commit $(git -C "$checkout" rev-parse --short HEAD): $script"
  root=$folder/root
  make_root "$root"
  mkdir "$root/root/ddm"
  git -C "$checkout" archive HEAD | tar -x -C "$root/root/ddm"
  export root script
  unshare --mount-proc --pid --fork --kill-child bash -euo pipefail -c "$(declare -f run_script); run_script" || code=$?
  say "Result"
  echo "$SECONDS s  $suite $script: $( ((code == 0)) && echo passed || echo "failed with code $code")"
  return "$code"
}

main "$@"

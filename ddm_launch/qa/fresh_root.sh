#!/usr/bin/env bash
# Runs the README's commands in an empty Debian system, and builds and runs the Dockerfile on one, see --help.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/workspace.sh"

usage() {
  cat <<TEXT
usage: bash fresh_root.sh bullseye|bookworm|trixie [demo|test|image]...

Makes an empty Debian 11 (bullseye), 12 (bookworm) or 13 (trixie) by debootstrap, puts the files of the commit HEAD into
it, and runs there what a newcomer would run. Closes with a verdict and a time for each, and removes everything that it made.
Needs root, debootstrap, and for image buildah.

  demo     bash ddm_launch/scripts/demo.sh
  test     bash ddm_launch/scripts/test.sh
  image    builds the Dockerfile on such a system, and runs the image twice: its demo, and a launch file
  --help   this text

Without any of the three: demo and test, one after the other in the same system.

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
    [[ $word =~ ^(demo|test|image)$ ]] || refuse "unknown argument '$word'"
  done
}

check_tools() {
  local tool tools=(debootstrap unshare git)
  [[ " ${parts[*]} " != *' image '* ]] || tools+=(buildah)
  for tool in "${tools[@]}"; do
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

copy_checkout() {  # FOLDER
  mkdir "$1"
  git -C "$checkout" archive HEAD | tar -x -C "$1"
}

run_script() {  # demo|test
  local root=$folder/root
  if [[ ! -d $root ]]; then
    make_root "$root"
    copy_checkout "$root/root/ddm"
  fi
  mount -t proc proc "$root/proc"
  mount -t sysfs sysfs "$root/sys"
  mount -t devpts -o newinstance,ptmxmode=666 devpts "$root/dev/pts"
  mkdir -p "$root/dev/shm"
  mount -t tmpfs tmpfs "$root/dev/shm"
  chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    sh -c "cd /root/ddm && bash ddm_launch/scripts/$1.sh" </dev/null
}

# Without cgroups, so that it also works inside of a container. Images of the caller's own stay out of sight.
run_buildah() {  # COMMAND ARGUMENT...
  TMPDIR=$folder BUILDAH_ISOLATION=chroot buildah --root "$folder/images" --runroot "$folder/containers" "$@"
}

run_container() {  # NAME COMMAND...
  run_buildah run --volume "$folder/runs:/runs" "$1" -- "${@:2}" </dev/null
}

# The image of the Dockerfile, with the empty system instead of Debian's own image.
run_image() {
  local base container entry command
  make_root "$folder/base"
  copy_checkout "$folder/checkout"
  base=$(run_buildah from scratch)
  run_buildah add --quiet "$base" "$folder/base" /
  run_buildah commit --quiet "$base" "ddm_base:$suite"
  run_buildah build --build-arg "BASE=ddm_base:$suite" --tag ddm "$folder/checkout"
  container=$(run_buildah from ddm)
  # run knows neither of the two
  mapfile -t entry < <(run_buildah inspect --format '{{range .OCIv1.Config.Entrypoint}}{{println .}}{{end}}' "$container")
  mapfile -t command < <(run_buildah inspect --format '{{range .OCIv1.Config.Cmd}}{{println .}}{{end}}' "$container")
  mkdir "$folder/runs"
  run_container "$container" "${entry[@]}" "${command[@]}"
  run_container "$container" "${entry[@]}" \
    roslaunch ddm_launch experiment.launch preset:=debug trials:=1 runs:=/runs/one
  grep -x 'finished: true' "$folder/runs/demo/summary.yaml" "$folder/runs/one/summary.yaml"
}

# Mounts and processes end with it.
run_part() {  # demo|test|image
  local function="run_script $1"
  [[ $1 != image ]] || function=run_image
  export folder suite mirror checkout
  unshare --mount-proc --pid --fork --kill-child bash -euo pipefail -c "$(declare -f); $function"
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

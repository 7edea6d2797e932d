# What only the tests need: sourced by test.sh and fuzz.sh, after workspace.sh.
# SPDX-License-Identifier: BSD-3-Clause

# Linters, the check of .rosinstall, sanitizers with symbols in their reports, a compiler for arm64, a screen for rviz, and
# other machines, played by this one.
packages_to_test=(
  catkin-lint catkin-tools python3-wstool clang-format git python3-pytest
  clang libclang-rt-dev libomp-dev llvm
  g++-aarch64-linux-gnu
  xvfb imagemagick
  openssh-client openssh-server iproute2 nftables
  slurmctld slurmd slurm-client munge
)
optional_packages+=(
  catkin-lint catkin-tools  # Debian 11 has no catkin-tools; with Noetic they have other names
  python3-wstool            # not in Debian 13
  libclang-rt-dev           # a part of clang itself in Debian 11
  g++-aarch64-linux-gnu     # not where it is the native compiler
)

# Runs a command as root while no package may start a service (Debian policy 9.11.1: policy-rc.d), and disables those
# that came with it: the tests start daemons of their own, and nobody asked for an sshd.
without_services='
policy=${POLICY_RC_D:-/usr/sbin/policy-rc.d}
if [ ! -e "$policy" ]; then
  printf "#!/bin/sh\nexit 101\n" >"$policy" && chmod 755 "$policy"
  trap '"'"'rm -f "$policy"'"'"' EXIT
fi
units=
for unit in munge slurmctld slurmd ssh; do
  [ -e /lib/systemd/system/$unit.service ] || units="$units $unit"
done
"$@" || exit
for unit in $units; do
  [ ! -e /lib/systemd/system/$unit.service ] || ! command -v systemctl >/dev/null || systemctl disable $unit
done'
around_apt=(sh -c "$without_services" sh)

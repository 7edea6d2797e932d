# Sourced by setup.bash: keeps to the loopback interface what ROS starts, unless the environment says otherwise.
# SPDX-License-Identifier: BSD-3-Clause
# ROS 1 has no authentication. ROS_IP and not ROS_HOSTNAME, because that would win over a ROS_IP that is set later.
case "${ROS_HOSTNAME:-}${ROS_IP:-}|${ROS_MASTER_URI:-http://localhost:11311}" in
  "|http://localhost"[:/]* | "|http://127."*) export ROS_IP=127.0.0.1 ;;
esac

#!/usr/bin/env bash
# Entry point of the Docker image: runs a command in the workspace $DDM_WS.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
# Restricts the nodes to the container, whose host name may not resolve, unless the caller sets a master or an address.
[[ -n ${ROS_MASTER_URI:-}${ROS_IP:-}${ROS_HOSTNAME:-} ]] || export ROS_IP=127.0.0.1
exec "$DDM_WS/devel/env.sh" "$@"

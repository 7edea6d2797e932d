#!/usr/bin/env bash
# Entry point of the Docker image: runs a command in the workspace $DDM_WS.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
# Nodes keep to the container, whose name need not resolve, unless the caller names a master or an address.
[[ -n ${ROS_MASTER_URI:-}${ROS_IP:-}${ROS_HOSTNAME:-} ]] || export ROS_IP=127.0.0.1
exec "$DDM_WS/devel/env.sh" "$@"

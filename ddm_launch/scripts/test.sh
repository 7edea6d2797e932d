#!/usr/bin/env bash
# Runs every test, see --help. All that it does is in qa/, where the tests of the whole are.
# SPDX-License-Identifier: BSD-3-Clause
exec bash "$(dirname "${BASH_SOURCE[0]}")/../qa/test.sh" "$@"

// Keys of the configuration that had another name in older versions.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

namespace ddm {

/// The blocks of a file with today's keys, so that files of older versions stay good. A key whose
/// new name is also given is left as it is, to be refused as unknown.
YAML::Node withTodaysKeys(const YAML::Node& blocks);

}  // namespace ddm

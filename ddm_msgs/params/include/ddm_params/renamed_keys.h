// Keys that have another name today, or are gone.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

namespace ddm {

/// The blocks of a file with today's keys, so that files of older versions stay good. A key whose
/// new name is also given is left as it is, to be refused as unknown. A file with the key `version`
/// was saved by a program, with all keys that there were: those that say nothing are dropped.
YAML::Node withTodaysKeys(const YAML::Node& blocks);

}  // namespace ddm

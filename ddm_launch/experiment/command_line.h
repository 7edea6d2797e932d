// Command line of the programs that take a configuration.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_params/tool.h>

#include <string>

#include "resolution.h"

namespace ddm {

/// A value of the command line that becomes that of `key` ("block/key") if the user gives it. There
/// are no defaults here: those are in the files.
template <class Value>
boost::program_options::typed_value<Value>* given(const std::string& key, Arguments* arguments) {
  return boost::program_options::value<Value>()->notifier(
      [key, arguments](const Value& value) { arguments->set(key, value); });
}

/// The options that choose the files of a configuration.
/// @param about  text above the list of options
boost::program_options::options_description configurationOptions(const std::string& about,
                                                                 Arguments* arguments);

/// The same, --seed and --out.
boost::program_options::options_description commonOptions(const std::string& about,
                                                          Arguments* arguments);

}  // namespace ddm

// Command line of the programs that run an experiment in one process.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/param_reader.h>
#include <ddm_msgs/tool.h>

#include <string>
#include <vector>

#include "configuration.h"

namespace ddm {

/// What all of them are told.
struct Arguments {
  std::string preset;
  std::string plant;
  std::string method;                  ///< empty: what the files say
  std::vector<std::string> nuisances;  ///< names
  int seed = 0;
  std::string out;
  std::vector<std::string> configs;
};

/// The options that name the files of a configuration.
/// @param about  text above the list of options
boost::program_options::options_description configurationOptions(const std::string& about,
                                                                 Arguments* arguments);

/// The same, --seed and --out.
boost::program_options::options_description commonOptions(const std::string& about,
                                                          Arguments* arguments);

/// --method, for a program that lets all of them act.
void addMethodOption(boost::program_options::options_description* options, Arguments* arguments);

/// The files that the arguments name: after the plant's that of the method (config/methods), then
/// those of the nuisances. Blocks beside those of a Configuration are read first.
ParamReader openConfiguration(const Arguments& arguments);

/// Reads all blocks, those of the method too, and sets in `experiment` what the arguments say.
/// @throws std::invalid_argument with all problems
Configuration readConfiguration(const Arguments& arguments, ParamReader* reader);

/// Checks the block `experiment` after arguments have changed it.
/// @throws std::invalid_argument with all problems
void requireValid(const ExperimentOptions& options);

}  // namespace ddm

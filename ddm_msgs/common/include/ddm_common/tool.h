// What all command line tools have in common: options, --help, exit codes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/program_options.hpp>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "ddm_common/plain_file.h"

namespace ddm {

constexpr int kUsageError = 2;  ///< exit code

/// Arguments that belong to no option.
struct Positional {
  const char* name;
  const boost::program_options::value_semantic* value;
  int max_count;  ///< -1: as many as there are
};

/// Reads the command line into the variables that the options were given.
/// @param options  what --help shows; --help itself is added
/// @param style    how options may be written
/// @return false where --help was asked for and has been printed
/// @throws boost::program_options::error for options that are unknown, wrong or missing
inline bool parseCommandLine(
    int argc, char** argv, boost::program_options::options_description options,
    const std::optional<Positional>& positional = std::nullopt,
    int style = boost::program_options::command_line_style::default_style) {
  namespace po = boost::program_options;
  options.add_options()("help,h", "show this text");
  po::options_description all(options);
  po::positional_options_description names;
  if (positional) {
    all.add_options()(positional->name, positional->value);
    names.add(positional->name, positional->max_count);
  }
  po::variables_map values;
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) words.push_back(expandHome(argv[i]));
  po::command_line_parser parser(words);
  po::store(parser.options(all).positional(names).style(style).run(), values);
  if (values.count("help") > 0) {
    std::cout << options << "\n";
    return false;
  }
  po::notify(values);
  return true;
}

/// Runs a tool. What goes wrong is told on stderr, behind its name.
/// @param configure  reads the command line; false: there is nothing to do
/// @return 0 done, 1 `run` threw an exception, 2 `configure` did
template <class Configure, class Run>
int runTool(const std::string& name, const Configure& configure, const Run& run) {
  try {
    if (!configure()) return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << " (see --help)\n";
    return kUsageError;
  }
  try {
    run();
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}

}  // namespace ddm

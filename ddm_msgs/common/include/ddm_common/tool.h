// Common parts of all command line tools: options, --help, exit codes.
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

constexpr int kUsageError = 2;  ///< exit code for an invalid command line

/// Arguments without an option name.
struct Positional {
  const char* name;
  const boost::program_options::value_semantic* value;
  int max_count;  ///< largest number of arguments; -1: no limit
};

/// Reads the command line into the variables that the options refer to.
/// @param options  options for --help; this function adds --help itself
/// @param style    boost::program_options style of the command line
/// @return false if the user asked for --help, which has then been printed
/// @throws boost::program_options::error for unknown, invalid or missing options
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

/// Runs a tool. Prints errors to stderr after the name of the tool.
/// @param configure  reads the command line; returns false if there is nothing to do
/// @return 0: success; 1: `run` threw an exception; 2: `configure` threw an exception
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

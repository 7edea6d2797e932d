// Reads features from CSV text.
// SPDX-License-Identifier: BSD-3-Clause
#include "feature_csv.h"

#include <boost/algorithm/string.hpp>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace ddm {
namespace {

/// The header that the features of a model have: z_1,z_2,...
std::string header(int feature_dim) {
  std::string text;
  for (int i = 1; i <= feature_dim; ++i) text += (i > 1 ? ",z_" : "z_") + std::to_string(i);
  return text;
}

/// A finite decimal number and nothing else: strtod also takes nan, inf and hexadecimal.
bool parseNumber(const std::string& word, double* value) {
  if (word.empty() || word.find_first_not_of("+-.0123456789eE") != std::string::npos) return false;
  char* end = nullptr;
  *value = std::strtod(word.c_str(), &end);
  return *end == '\0' && std::isfinite(*value);
}

}  // namespace

std::vector<Eigen::VectorXd> readFeatures(std::istream& input, int feature_dim) {
  const auto fail = [](std::size_t line, const std::string& rule, const std::string& got) {
    throw std::runtime_error("standard input, line " + std::to_string(line) + ": must be " + rule +
                             ", got '" + got + "'");
  };
  std::vector<Eigen::VectorXd> features;
  std::string text;
  std::getline(input, text);
  boost::trim(text);
  if (text != header(feature_dim)) fail(1, "the header " + header(feature_dim), text);
  for (std::size_t line = 2; std::getline(input, text); ++line) {
    boost::trim(text);
    if (text.empty() && (input >> std::ws).eof()) break;  // blank lines at the end do not count
    std::vector<std::string> words;
    boost::split(words, text, boost::is_any_of(","));
    Eigen::VectorXd z(feature_dim);
    bool good = words.size() == static_cast<std::size_t>(feature_dim);
    for (int i = 0; good && i < feature_dim; ++i)
      good = parseNumber(boost::trim_copy(words[i]), &z[i]);
    if (!good) fail(line, std::to_string(feature_dim) + " finite number(s), comma between", text);
    features.push_back(z);
  }
  if (input.bad()) throw std::runtime_error("standard input cannot be read to its end");
  if (features.empty()) fail(2, "a feature: there is nothing to decode", "");
  return features;
}

}  // namespace ddm

// Reads torques from CSV text, and numbers from words.
// SPDX-License-Identifier: BSD-3-Clause
#include "torque_csv.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace ddm {
namespace {

constexpr char kBlanks[] = " \t\r";

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

/// `text` for a message: short, and without bytes that a terminal would act on.
std::string quoted(const std::string& text) {
  constexpr std::size_t kMaxShown = 40;
  std::string out = text.substr(0, kMaxShown);
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return "\"" + out + (text.size() > kMaxShown ? "...\"" : "\"");
}

}  // namespace

bool parseNumber(const std::string& text, double* value) {
  const std::string word = trimmed(text);
  // strtod also takes nan, inf and hexadecimal; their letters are kept out here.
  if (word.empty() || word.find_first_not_of("+-.0123456789eE") != std::string::npos) return false;
  char* end = nullptr;
  const double number = std::strtod(word.c_str(), &end);
  if (*end != '\0' || !std::isfinite(number)) return false;
  *value = number;
  return true;
}

bool parseNumbers(const std::string& text, Eigen::Index count, Eigen::VectorXd* values) {
  Eigen::VectorXd numbers(count);
  std::size_t begin = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (begin > text.size()) return false;  // fewer cells than that
    const std::size_t end = std::min(text.find(',', begin), text.size());
    if (!parseNumber(text.substr(begin, end - begin), &numbers[i])) return false;
    begin = end + 1;
  }
  if (begin <= text.size()) return false;  // more
  *values = numbers;
  return true;
}

std::string joinedByCommas(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ",") + word;
  return out;
}

std::vector<Eigen::VectorXd> readTorques(std::istream& input,
                                         const std::vector<std::string>& names) {
  const std::string header = joinedByCommas(names);
  const auto size = static_cast<Eigen::Index>(names.size());
  const auto fail = [](std::size_t number, const std::string& what) {
    throw std::runtime_error("standard input, line " + std::to_string(number) + ": " + what);
  };
  std::string line;
  if (!std::getline(input, line) || trimmed(line) != header) {
    fail(1, "must be the header " + header + ", got " +
                (line.empty() ? "nothing" : quoted(trimmed(line))));
  }
  const std::string rule =
      size == 1 ? "one finite number" : std::to_string(size) + " finite numbers";
  std::vector<Eigen::VectorXd> torques;
  std::size_t number = 1;
  std::size_t first_empty = 0;
  while (std::getline(input, line)) {
    ++number;
    if (trimmed(line).empty()) {
      if (first_empty == 0) first_empty = number;
      continue;
    }
    if (first_empty != 0) {
      fail(first_empty, "is empty; remove it or write a torque (" + header + "), 0 for none");
    }
    Eigen::VectorXd torque;
    if (!parseNumbers(line, size, &torque)) {
      fail(number, "a torque must be " + rule + " (" + header + "), got " + quoted(trimmed(line)));
    }
    torques.push_back(torque);
  }
  if (input.bad()) throw std::runtime_error("standard input cannot be read to its end");
  return torques;
}

}  // namespace ddm

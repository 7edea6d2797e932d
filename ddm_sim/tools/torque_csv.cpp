// Reads torques from CSV text, and numbers from words.
// SPDX-License-Identifier: BSD-3-Clause
#include "torque_csv.h"

#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace ddm {
namespace {

constexpr char kHeader[] = "torque_nm";
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

std::vector<double> readTorques(std::istream& input) {
  std::string line;
  if (!std::getline(input, line) || trimmed(line) != kHeader) {
    throw std::runtime_error("standard input, line 1: must be the header " + std::string(kHeader) +
                             ", got " + (line.empty() ? "nothing" : quoted(trimmed(line))));
  }
  std::vector<double> torques;
  std::size_t number = 1;
  std::size_t first_empty = 0;
  while (std::getline(input, line)) {
    ++number;
    if (trimmed(line).empty()) {
      if (first_empty == 0) first_empty = number;
      continue;
    }
    if (first_empty != 0) {
      throw std::runtime_error("standard input, line " + std::to_string(first_empty) +
                               ": is empty; remove it or write a torque [N m], 0 for none");
    }
    double torque = 0.0;
    if (!parseNumber(line, &torque)) {
      throw std::runtime_error("standard input, line " + std::to_string(number) +
                               ": a torque must be one finite number [N m], got " +
                               quoted(trimmed(line)));
    }
    torques.push_back(torque);
  }
  if (input.bad()) throw std::runtime_error("standard input cannot be read to its end");
  return torques;
}

}  // namespace ddm

// Common parts of the fuzz targets: checks, choice of the target, and input.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

namespace ddm {
namespace testing {

/// Aborts the program if a promise is broken, so that libFuzzer keeps the input.
inline void require(bool kept, const char* promise) {
  if (kept) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

/// Returns whether read() accepts its input. To refuse the input, read() must throw an Error with a
/// text; any other exception ends the program.
template <class Error, class Read>
bool accepts(const Read& read) {
  try {
    read();
    return true;
  } catch (const Error& e) {
    require(e.what()[0] != '\0', "a refusal says why");
    return false;
  }
}

/// Function that reads one input. The name of a target is the name of its folder of seeds in
/// corpus/.
using FuzzTarget = void (*)(const std::uint8_t* data, std::size_t size);

/// Returns the target that the environment variable FUZZ_TARGET names. Exits if there is no such
/// target.
inline FuzzTarget chosenTarget(const std::map<std::string, FuzzTarget>& targets) {
  const char* name = std::getenv("FUZZ_TARGET");
  const auto found = targets.find(name != nullptr ? name : "");
  if (found != targets.end()) return found->second;
  std::fprintf(stderr, "FUZZ_TARGET must be one of:");
  for (const auto& target : targets) std::fprintf(stderr, " %s", target.first.c_str());
  std::fprintf(stderr, "\n");
  std::exit(2);
}

/// A file in memory, for functions that take a path.
class MemoryFile {
 public:
  MemoryFile() : file_(::memfd_create("fuzz", 0)) { require(file_ >= 0, "memfd_create works"); }
  ~MemoryFile() { ::close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }
  void write(const void* bytes, std::size_t size) const {
    require(::ftruncate(file_, 0) == 0, "ftruncate works");
    require(::pwrite(file_, bytes, size, 0) == static_cast<ssize_t>(size), "pwrite works");
  }

 private:
  int file_;
};

/// Reads numbers from the front of an input, and zeros after its end.
class FuzzBytes {
 public:
  FuzzBytes(const std::uint8_t* data, std::size_t size)
      : at_(reinterpret_cast<const char*>(data)), left_(size) {}

  template <class Number>
  Number number() {
    Number value = 0;
    const std::size_t size = sizeof(value) < left_ ? sizeof(value) : left_;
    std::copy(at_, at_ + size, reinterpret_cast<char*>(&value));
    at_ += size;
    left_ -= size;
    return value;
  }
  std::string rest() const { return std::string(at_, left_); }
  bool empty() const { return left_ == 0; }

 private:
  const char* at_;
  std::size_t left_;
};

}  // namespace testing
}  // namespace ddm

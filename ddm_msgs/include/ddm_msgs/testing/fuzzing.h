// What the fuzz targets have in common: promises that are kept, and refusals that say why.
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

/// Ends the program where a promise is broken: libFuzzer then keeps the input.
inline void require(bool kept, const char* promise) {
  if (kept) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

/// Whether read() accepts its input. If not it must throw an Error with a text; any other exception
/// ends the program.
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

/// What reads one input. Targets have names, which are those of their folders of seeds in corpus/.
using FuzzTarget = void (*)(const std::uint8_t* data, std::size_t size);

/// The target that the environment variable FUZZ_TARGET names.
inline FuzzTarget chosenTarget(const std::map<std::string, FuzzTarget>& targets) {
  const char* name = std::getenv("FUZZ_TARGET");
  const auto found = targets.find(name != nullptr ? name : "");
  if (found != targets.end()) return found->second;
  std::fprintf(stderr, "FUZZ_TARGET must be one of:");
  for (const auto& target : targets) std::fprintf(stderr, " %s", target.first.c_str());
  std::fprintf(stderr, "\n");
  std::exit(2);
}

/// A file in memory, for what takes a path.
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

/// Numbers from the front of an input; zeros when it is used up.
class FuzzBytes {
 public:
  FuzzBytes(const std::uint8_t* data, std::size_t size)
      : at_(reinterpret_cast<const char*>(data)), left_(size) {}

  template <class Number>
  Number number() {
    Number value = 0;
    const std::size_t size = sizeof(value) < left_ ? sizeof(value) : left_;
    std::copy(at_, at_ + size, reinterpret_cast<char*>(&value));
    skip(size);
    return value;
  }
  /// At most `size` bytes, fewer at the end.
  std::string text(std::size_t size) {
    const std::string out(at_, size < left_ ? size : left_);
    skip(out.size());
    return out;
  }
  std::string rest() { return text(left_); }
  bool empty() const { return left_ == 0; }

 private:
  void skip(std::size_t size) {
    at_ += size;
    left_ -= size;
  }

  const char* at_;
  std::size_t left_;
};

}  // namespace testing
}  // namespace ddm

// Counts what a program takes from the heap. Include it in one file of a program: it defines malloc.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace ddm {
namespace testing {

inline std::atomic<long> allocations{0};
inline std::atomic<long> refused_allocation{-1};  ///< this one finds no memory; -1: none

/// @return whether there is memory for one more
inline bool countAllocation() { return allocations++ != refused_allocation; }

/// How often `work` asks for memory: operator new and Eigen do so through malloc.
inline long allocationsOf(const std::function<void()>& work) {
  const long before = allocations;
  work();
  return allocations - before;
}

}  // namespace testing
}  // namespace ddm

extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT: glibc's own names
void* __libc_calloc(std::size_t count, std::size_t size);        // NOLINT
void* __libc_realloc(void* old, std::size_t size);               // NOLINT
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT

void* malloc(std::size_t size) {
  return ddm::testing::countAllocation() ? __libc_malloc(size) : nullptr;
}
void* calloc(std::size_t count, std::size_t size) {
  ++ddm::testing::allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  ++ddm::testing::allocations;
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++ddm::testing::allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  ++ddm::testing::allocations;
  *out = __libc_memalign(alignment, size);
  return *out == nullptr;
}
}

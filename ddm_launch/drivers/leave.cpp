// The end of a node that ends by itself.
// SPDX-License-Identifier: BSD-3-Clause
#include "leave.h"

#include <chrono>
#include <cstdlib>
#include <thread>

namespace ddm {

void leaveWithin10s(int code) {
  std::thread([code] {
    std::this_thread::sleep_for(std::chrono::seconds(10));
    std::_Exit(code);
  }).detach();
}

}  // namespace ddm

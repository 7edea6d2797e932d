// Fuzz target: the bytes of a bag.
// SPDX-License-Identifier: BSD-3-Clause
#include <sstream>

#include "check_content.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kImageSize = 4;
  std::istringstream bag(std::string(reinterpret_cast<const char*>(data), size));
  ddm::testing::accepts<std::runtime_error>([&] {
    ddm::testing::checkContent(ddm::readBagBytes(&bag, kImageSize, ddm::BagOptions()), kImageSize);
  });
  return 0;
}

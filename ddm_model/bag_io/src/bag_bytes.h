// Reads a bag from any stream.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <istream>

#include "ddm_bag_io/bag_reader.h"

namespace ddm {

/// As readBag(), but for the path in its messages.
/// @param in  binary, can be positioned
BagContent readBagBytes(std::istream* in, int image_size, const BagOptions& options);

}  // namespace ddm

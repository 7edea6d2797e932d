// Model file: a trained model as bytes, with version and checksum.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ddm_model/ddm.h"

namespace ddm {

/// A model as bytes, for a file or a message (little-endian):
///
///   "DDMMODEL" | format version, uint32 | size of the content, uint64 | CRC-32 of the content |
///   content
///
/// Only the present version of the format is read.
std::string serialiseModel(const Ddm& model);

/// The inverse. Sizes are checked against what is there before memory is taken.
/// @param bytes   what serialiseModel() made
/// @param source  file or topic, for messages
/// @throws std::runtime_error naming source and fault: not a model, an unknown version, cut
///         short, wrong checksum, content that makes no sense
Ddm deserialiseModel(const std::string& bytes, const std::string& source);

/// Identity of a model: CRC-32 of its bytes, 8 hexadecimal digits. Equal ids are equal models.
std::string modelId(const std::string& bytes);

/// CRC-32 of any text, 8 hexadecimal digits.
std::string checksum(const std::string& text);

}  // namespace ddm

// Model file: a trained model as bytes, with version and checksum.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ddm_model/ddm.h"

namespace ddm {

/// Writes a model as bytes, for a file or a message (little-endian):
///
///   "DDMMODEL" | format version, uint32 | size of the content, uint64 | CRC-32 of the content |
///   content
///
/// Programs read only the current version of the format.
std::string serialiseModel(const Ddm& model);

/// Reads a model from bytes. Checks each size against the bytes left before it allocates memory.
/// @param bytes   output of serialiseModel()
/// @param source  name of the file or topic, for error messages
/// @throws std::runtime_error that names the source and the fault: not a model, another version,
///         truncated, wrong checksum, or invalid content
Ddm deserialiseModel(const std::string& bytes, const std::string& source);

/// @return id of a model: CRC-32 of its bytes, 8 hexadecimal digits. Equal models have equal ids.
std::string modelId(const std::string& bytes);

/// @return CRC-32 of a text, 8 hexadecimal digits
std::string checksum(const std::string& text);

}  // namespace ddm

// Topics of a bag: selects them, and pairs their torques with the images.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bag_file.h"
#include "ddm_bag_io/bag_reader.h"
#include "pairing.h"

namespace ddm {

/// A topic of a bag. An empty name means that there is none.
struct Topic {
  std::string name;
  std::string type;
};

/// The topics that the reader uses.
struct BagTopics {
  Topic images, torques;
  Topic goal;  ///< may be missing
};

/// @return "/torque" for "torque"
std::string absolute(const std::string& topic);

/// Finds the topics that the options name: exactly, or else in some namespace. An image topic may
/// also be a compressed form.
/// @throws std::runtime_error that names the key and the remedy. Faults: there is no such topic, or
///         several; the type or the image transport cannot be read; a topic has two roles; torques
///         do not name their images, and dt is 0
BagTopics findTopics(const BagFile& bag, const BagOptions& options);

/// Whether images on the topic are sensor_msgs/Image, not CompressedImage.
bool isRaw(const BagConnection& connection);

/// Reads the times of all images and torques, and pairs them. Pixels are not decoded, since many
/// images of a fast camera belong to no sample.
/// @throws std::runtime_error like findTopics() and pairUp(); also if there is no torque, or if two
///         nodes publish torques or images at the same time
Pairs readPairs(BagFile* bag, const BagTopics& topics, const BagOptions& options);

}  // namespace ddm

// Keys that have another name today, or are gone.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_params/renamed_keys.h"

#include <string>

#include "ddm_params/config_blocks.h"

namespace ddm {
namespace {

/// A key, and the value with which it said nothing, as it was saved.
struct OldKey {
  const char* block;
  const char* key;
  const char* value;
};

/// How a rod looks. Older versions drew it with the camera, and saved it with every plant.
constexpr OldKey kLook[] = {{"camera", "half_extent", "1.2"},
                            {"camera", "rod_half_width", "0.1"},
                            {"camera", "edge_softness", "0.2"}};

/// Options that are gone. With another value a run cannot be repeated: it stays, to be refused.
constexpr OldKey kGone[] = {
    {"training", "ensemble_size", "1"},  {"training", "held_out", "0.0"},
    {"mpc", "scale_distance", "false"},  {"training", "consistency_weight", "0.0"},
    {"mpc", "saturation_width", "0.0"},  {"mpc", "terminal_weight", "1.0"},
    {"mpc", "disagreement_bonus", "0.0"}};

/// Moves a key, unless there is something at its new place.
/// @return whether it was moved
bool rename(const std::string& old_block, const std::string& old_key, const std::string& block,
            const std::string& key, YAML::Node* blocks) {
  const YAML::Node& before = *blocks;  // looking for a key must not make it
  const YAML::Node there = before[block];
  if (!hasKey(before, old_block, old_key) || hasKey(before, block, key)) return false;
  if (there.IsDefined() && !there.IsMap()) return false;
  (*blocks)[block][key] = YAML::Clone(before[old_block][old_key]);
  (*blocks)[old_block].remove(old_key);
  return true;
}

bool saysNothing(const OldKey& old, const YAML::Node& blocks) {
  return hasKey(blocks, old.block, old.key) && blocks[old.block][old.key].Scalar() == old.value;
}

void drop(const std::string& block, const std::string& key, YAML::Node* blocks) {
  if (hasKey(*blocks, block, key)) (*blocks)[block].remove(key);
}

/// What a person wrote is about a rod, else it was not written. What a program saved is about the
/// pendulum; a plant of another package could draw with it too, where it is not the default.
void moveLook(const std::string& type, bool saved, YAML::Node* blocks) {
  for (const OldKey& look : kLook) {
    const bool useless = type == "moving_tile" || saysNothing(look, *blocks);
    if (saved && type != "pendulum" && useless) {
      drop(look.block, look.key, blocks);
    } else {
      rename(look.block, look.key, "plant", look.key, blocks);
    }
  }
}

/// It was in degrees for every plant, and used with angles only.
void renameTolerance(const std::string& type, bool saved, YAML::Node* blocks) {
  if (saved && type != "pendulum") {
    drop("evaluation", "tolerance_deg", blocks);
  } else if (rename("evaluation", "tolerance_deg", "evaluation", "tolerance", blocks)) {
    if (!hasKey(*blocks, "evaluation", "error_unit")) (*blocks)["evaluation"]["error_unit"] = "deg";
  }
}

/// Older versions saved the keys of all their plants with each of them.
void dropForeignKeys(const std::string& type, YAML::Node* blocks) {
  if (type == "pendulum") {
    for (const char* key : {"tile_width", "tile_softness"}) drop("plant", key, blocks);
  } else if (type == "moving_tile") {
    for (const char* key : {"gravity", "length", "mass", "friction"}) drop("plant", key, blocks);
  }
}

/// Once some starts could begin at random: training/pca_starts said how many did not.
void dropPcaStarts(YAML::Node* blocks) {
  if (!hasKey(*blocks, "training", "pca_starts") || !hasKey(*blocks, "training", "num_starts"))
    return;
  const YAML::Node training = (*blocks)["training"];
  const int none = -1;
  if (training["pca_starts"].as<int>(none) >= training["num_starts"].as<int>(none)) {
    drop("training", "pca_starts", blocks);
  }
}

}  // namespace

YAML::Node withTodaysKeys(const YAML::Node& blocks) {
  YAML::Node out = YAML::Clone(blocks);
  if (!out.IsMap()) return out;
  const YAML::Node before = YAML::Clone(out);
  const bool saved = before["version"].IsDefined();
  const std::string type =
      hasKey(before, "plant", "type") ? before["plant"]["type"].Scalar() : "pendulum";
  rename("camera", "size", "plant", "picture_size", &out);
  moveLook(type, saved, &out);
  renameTolerance(type, saved, &out);
  if (!saved) return out;
  if (hasKey(before, "camera", "size") || hasKey(before, "evaluation", "tolerance_deg")) {
    dropForeignKeys(type, &out);
  }
  for (const OldKey& gone : kGone) {
    if (saysNothing(gone, out)) drop(gone.block, gone.key, &out);
  }
  dropPcaStarts(&out);
  return out;
}

}  // namespace ddm

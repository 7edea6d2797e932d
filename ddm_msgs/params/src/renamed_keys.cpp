// Keys of the configuration that had another name in older versions, or are gone.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_params/renamed_keys.h"

#include <string>

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

bool isMap(const YAML::Node& node) { return node.IsDefined() && node.IsMap(); }

bool has(const YAML::Node& block, const std::string& key) {
  return isMap(block) && block[key].IsDefined();
}

/// Moves a key, unless there is something at its new place.
/// @return whether it was moved
bool rename(const std::string& old_block, const std::string& old_key, const std::string& block,
            const std::string& key, YAML::Node* blocks) {
  const YAML::Node& before = *blocks;  // looking for a key must not make it
  const YAML::Node there = before[block];
  if (!has(before[old_block], old_key)) return false;
  if (has(there, key) || (there.IsDefined() && !there.IsMap())) return false;
  (*blocks)[block][key] = YAML::Clone(before[old_block][old_key]);
  (*blocks)[old_block].remove(old_key);
  return true;
}

bool saysNothing(const OldKey& old, const YAML::Node& blocks) {
  return has(blocks[old.block], old.key) && blocks[old.block][old.key].Scalar() == old.value;
}

void drop(const std::string& block, const std::string& key, YAML::Node* blocks) {
  if (has(static_cast<const YAML::Node&>(*blocks)[block], key)) (*blocks)[block].remove(key);
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
    YAML::Node evaluation = (*blocks)["evaluation"];
    if (!has(evaluation, "error_unit")) evaluation["error_unit"] = "deg";
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

}  // namespace

YAML::Node withTodaysKeys(const YAML::Node& blocks) {
  YAML::Node out = YAML::Clone(blocks);
  if (!isMap(out)) return out;
  const YAML::Node before = YAML::Clone(out);
  const bool saved = before["version"].IsDefined();
  const std::string type =
      has(before["plant"], "type") ? before["plant"]["type"].Scalar() : "pendulum";
  rename("camera", "size", "plant", "picture_size", &out);
  moveLook(type, saved, &out);
  renameTolerance(type, saved, &out);
  if (!saved) return out;
  if (has(before["camera"], "size") || has(before["evaluation"], "tolerance_deg")) {
    dropForeignKeys(type, &out);
  }
  for (const OldKey& gone : kGone) {
    if (saysNothing(gone, out)) drop(gone.block, gone.key, &out);
  }
  return out;
}

}  // namespace ddm

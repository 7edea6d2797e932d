// Keys of the configuration that had another name in older versions.
// SPDX-License-Identifier: BSD-3-Clause
#include "renamed_keys.h"

#include <string>
#include <vector>

namespace ddm {
namespace {

bool isMap(const YAML::Node& node) { return node.IsDefined() && node.IsMap(); }

bool has(const YAML::Node& block, const std::string& key) {
  return isMap(block) && block[key].IsDefined();
}

/// Moves a key, unless there is something at its new place.
void rename(const std::string& old_key, YAML::Node old_block, const std::string& key,
            YAML::Node block) {
  if (!has(old_block, old_key) || (block.IsDefined() && !block.IsMap()) || has(block, key)) return;
  block[key] = YAML::Clone(old_block[old_key]);
  old_block.remove(old_key);
}

/// Older versions saved all keys of all plants with each of them.
void dropForeignKeys(const std::string& type, YAML::Node plant) {
  if (type == "pendulum") {
    for (const char* key : {"tile_width", "tile_softness"}) plant.remove(key);
    return;
  }
  for (const char* key : {"half_extent", "rod_half_width", "edge_softness"}) plant.remove(key);
  if (type != "moving_tile") return;
  for (const char* key : {"gravity", "length", "mass", "friction"}) plant.remove(key);
}

}  // namespace

YAML::Node withTodaysKeys(const YAML::Node& blocks) {
  YAML::Node out = YAML::Clone(blocks);
  if (!isMap(out)) return out;
  const YAML::Node before = YAML::Clone(out);
  const std::string type =
      has(before["plant"], "type") ? before["plant"]["type"].Scalar() : "pendulum";
  const bool saved_by_older_version =
      before["version"].IsDefined() && has(before["camera"], "size");
  if (has(before["camera"], "size")) rename("size", out["camera"], "picture_size", out["plant"]);
  for (const char* key : {"half_extent", "rod_half_width", "edge_softness"}) {
    if (has(before["camera"], key)) rename(key, out["camera"], key, out["plant"]);
  }
  if (has(before["evaluation"], "tolerance_deg")) {
    YAML::Node evaluation = out["evaluation"];
    if (saved_by_older_version && type != "pendulum") {
      evaluation.remove("tolerance_deg");  // nothing was judged by it
    } else {
      rename("tolerance_deg", evaluation, "tolerance", evaluation);
      if (!has(evaluation, "error_unit")) evaluation["error_unit"] = "deg";
    }
  }
  if (saved_by_older_version) dropForeignKeys(type, out["plant"]);
  return out;
}

}  // namespace ddm

// Interface by which plants of this package and of other packages register.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/param_reader.h>
#include <ddm_sim/plant.h>
#include <ddm_sim/plant_options.h>

#include <memory>
#include <string>

namespace ddm {

/// Reads the block `plant` for one type of plant, and makes plants of this type. Derive from
/// PlantPluginOf.
class PlantPlugin {
 public:
  virtual ~PlantPlugin() = default;

  virtual std::string type() const = 0;  ///< value of `plant/type`, for messages

  /// Constructs a plant. Call makePlant() instead, which also checks the plant.
  /// @throws std::invalid_argument if the options do not fit together
  virtual std::unique_ptr<Plant> make() const = 0;

  /// Reads all keys. The reader collects the problems.
  virtual void read(ParamReader* reader) = 0;

  virtual YAML::Node block() const = 0;  ///< effective values of all keys

  /// Name of the graphics driver if the pixels of the images depend on it, otherwise empty.
  virtual std::string renderer() const { return ""; }
};

/// Constructs a plant.
/// @throws std::invalid_argument as PlantPlugin::make() and checkedPlant()
inline std::unique_ptr<Plant> makePlant(const PlantPlugin& plugin) {
  return checkedPlant(plugin.make(), plugin.type());
}

/// Plugin of a plant whose constructor takes an options struct:
///
///   struct CartOptions : ddm::PlantOptions { ... visit() ... problems() ... };
///   explicit Cart(const CartOptions& options);
template <class PlantType, class Options>
class PlantPluginOf : public PlantPlugin {
 public:
  std::string type() const override { return options_.type; }
  void read(ParamReader* reader) override { options_ = reader->read<Options>("plant"); }
  YAML::Node block() const override { return toYaml(options_); }
  std::unique_ptr<Plant> make() const override { return std::make_unique<PlantType>(options_); }

 private:
  Options options_;
};

}  // namespace ddm

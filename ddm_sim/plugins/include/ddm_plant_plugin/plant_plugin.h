// A plant from another package: what pluginlib loads.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_params/param_reader.h>
#include <ddm_sim/plant_factory.h>

#include <memory>

namespace ddm {

/// Reads the block `plant` of one kind of plants, and makes them. Derive from PlantPluginOf.
class PlantPlugin : public PlantMaker {
 public:
  /// Reads all keys; what is wrong with them stays with the reader.
  virtual void read(ParamReader* reader) = 0;

  virtual PlantBasics basics() const = 0;         ///< the keys that every plant has
  virtual YAML::Node effectiveBlock() const = 0;  ///< all keys, as toYaml() writes them
};

/// The plugin of a plant with these constructor and options:
///
///   struct CartOptions : ddm::PlantBasics { ... visit() ... problems() ... };
///   Cart(const CartOptions& options, const ddm::CameraOptions& camera);
///
/// Both options are valid by themselves when a plant is made; whether they fit together is for the
/// constructor to check, with std::invalid_argument.
template <class PlantType, class Options>
class PlantPluginOf : public PlantPlugin {
 public:
  void read(ParamReader* reader) override { options_ = reader->read<Options>("plant"); }
  PlantBasics basics() const override { return options_; }
  YAML::Node effectiveBlock() const override { return toYaml(options_); }
  std::unique_ptr<Plant> make(const CameraOptions& camera) const override {
    return std::make_unique<PlantType>(options_, camera);
  }

 private:
  Options options_;
};

}  // namespace ddm

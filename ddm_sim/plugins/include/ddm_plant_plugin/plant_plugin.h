// A plant as a configuration describes it: how plants register, ours and those of other packages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/param_reader.h>
#include <ddm_sim/plant.h>
#include <ddm_sim/plant_options.h>

#include <memory>
#include <string>

namespace ddm {

/// Reads the block `plant` of one kind of plants, and makes them. Derive from PlantPluginOf.
class PlantPlugin : public PlantMaker {
 public:
  /// Reads all keys; what is wrong with them stays with the reader.
  virtual void read(ParamReader* reader) = 0;

  virtual YAML::Node block() const = 0;  ///< effective values of all keys

  /// The driver that draws the images, if their pixels depend on one; else empty.
  virtual std::string renderer() const { return ""; }
};

/// The plugin of a plant with these constructor and options:
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

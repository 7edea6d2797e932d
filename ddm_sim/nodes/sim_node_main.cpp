// sim_node: a simulated plant with camera and motors as a ROS node.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/run_node.h>
#include <ddm_plant_plugin/plant_config.h>

#include <memory>
#include <utility>

#include "ddm_sim/plant.h"
#include "sim_node.h"

int main(int argc, char** argv) {
  return ddm::runNode("sim_node", argc, argv, [](auto nh, auto, ddm::ParamReader* params) {
    const auto plant = ddm::readPlant(params);
    const auto camera = params->read<ddm::CameraOptions>("camera");
    const auto sim = params->read<ddm::SimOptions>("sim");
    const auto show = params->read<ddm::ShowOptions>("show");
    params->requireValid();

    YAML::Node effective;
    effective["plant"] = plant->block();
    effective["camera"] = ddm::toYaml(camera);
    effective["sim"] = ddm::toYaml(sim);
    effective["show"] = ddm::toYaml(show);
    ROS_INFO_STREAM("sim_node: effective configuration\n" << effective);

    auto environment = std::make_unique<ddm::Environment>(ddm::makePlant(*plant), camera);
    const std::unique_ptr<ddm::SimNode> node =
        sim.lockstep ? ddm::makeLockstepSim(nh, std::move(environment), sim, show)
                     : ddm::makeRealtimeSim(nh, std::move(environment));
    ros::spin();
  });
}

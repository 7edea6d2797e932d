// Class ModelFolder: a temporary folder with model files for a test.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/testing/temp_folder.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/mujoco_plant.h"

namespace ddm {
namespace testing {

/// A mesh in OBJ format.
constexpr char kTetrahedron[] =
    "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// Temporary folder of `robots`, the only ROS package in these tests.
class ModelFolder {
 public:
  std::string write(const std::string& name, const std::string& text) const {
    const std::filesystem::path file = folder_.file(name);
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return file.string();
  }

  std::shared_ptr<const MujocoModel> load(const std::string& uri) const {
    return std::make_shared<MujocoModel>(uri, [this](const std::string& package) {
      return package == "robots" ? path() : std::string();
    });
  }

  std::shared_ptr<const MujocoModel> loadText(const std::string& text,
                                              const std::string& name = "model.xml") const {
    return load(write(name, text));
  }

  std::string path() const { return folder_.file(""); }

 private:
  TempFolder folder_;
};

/// The text with the first `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

/// MJCF of an arm with two links (0.2 m and 0.1 m) that moves in a plane, with a motor at each
/// joint.
inline std::string armText(const std::string& more = "") {
  return R"(<mujoco><option timestep="0.01" gravity="0 0 0"/>
    <worldbody>
      <camera name="above" pos="0 0 1"/>
      <body><joint name="shoulder" axis="0 0 1" damping="0.1"/>
        <geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.01" contype="0" conaffinity="0"/>
        <body pos="0.2 0 0"><joint name="elbow" axis="0 0 1" damping="0.1" limited="true" range="-150 150"/>
          <geom type="capsule" fromto="0 0 0 0.1 0 0" size="0.01" contype="0" conaffinity="0"/>
          <site name="tip" pos="0.1 0 0"/>
        </body></body>
    </worldbody>
    <actuator>
      <motor name="first" joint="shoulder" gear="2" ctrllimited="true" ctrlrange="-0.5 0.5"/>
      <motor name="second" joint="elbow" gear="0.4" ctrllimited="true" ctrlrange="-1 1"/>
    </actuator>)" +
         more + "</mujoco>";
}

/// URDF of an arm with the same joints. The only property of a motor is the effort of the elbow.
inline std::string armUrdf(const std::string& mesh = "") {
  const std::string shape =
      mesh.empty() ? "<box size='0.1 0.1 0.1'/>" : "<mesh filename='" + mesh + "'/>";
  const std::string inertial =
      "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
      "</inertial>";
  return "<robot name='arm'><link name='base'><visual><geometry>" + shape +
         "</geometry></visual></link><link name='upper'>" + inertial +
         "<visual><geometry><sphere radius='0.1'/></geometry></visual></link><link name='lower'>" +
         inertial +
         "</link><joint name='shoulder' type='continuous'><parent link='base'/><child "
         "link='upper'/><axis xyz='0 0 1'/></joint><joint name='elbow' type='revolute'><parent "
         "link='upper'/><child link='lower'/><axis xyz='0 0 1'/><limit lower='-2' upper='2' "
         "effort='3' velocity='1'/></joint></robot>";
}

/// Options that are valid for both arms, apart from the motors of the URDF.
inline MujocoOptions armOptions() {
  MujocoOptions options;
  options.model = "arm";
  options.dt = 0.05;
  options.goal = {1.0, 0.5};
  options.tolerance = 10.0;
  return options;
}

/// A plant whose model file has this text.
inline std::unique_ptr<MujocoPlant> plantOf(const std::string& text, const MujocoOptions& options,
                                            const std::string& name = "model.xml") {
  const ModelFolder folder;
  return std::make_unique<MujocoPlant>(folder.loadText(text, name), options);
}

inline std::unique_ptr<MujocoPlant> arm(const MujocoOptions& options = armOptions()) {
  return plantOf(armText(), options);
}

/// Options for the URDF arm. The motors have another order than the joints.
inline MujocoOptions urdfOptions() {
  MujocoOptions options = armOptions();
  options.motors = {"elbow", "shoulder"};
  options.max_torque = {2.0, 1.0};
  options.look.position = {0.0, 0.0, 2.0};
  options.look.look_at = {0.0, 0.1, 0.0};
  return options;
}

/// Message of the std::invalid_argument that `make` throws. Empty if `make` throws nothing.
template <class Make>
std::string refusalOf(const Make& make) {
  try {
    make();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

}  // namespace testing
}  // namespace ddm

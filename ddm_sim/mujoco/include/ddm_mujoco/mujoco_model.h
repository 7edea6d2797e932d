// A model file, MJCF or URDF, as MuJoCo understands it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mujoco/mujoco.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ddm {

/// Folder of a ROS package; empty if there is none of this name.
using FindPackage = std::function<std::string(const std::string& package)>;

/// Makes MuJoCo throw std::runtime_error where it would otherwise wait for a key, exit, or write
/// MUJOCO_LOG.TXT into the working folder. To be called before anything else of MuJoCo; cheap and
/// harmless when called again. MujocoModel does it.
void installMujocoHandlers();

/// What has a position in the world: a site, or the centre of mass of a body, which URDF calls
/// link. Its origin would be the joint that turns it, where a pole is at any angle.
struct Place {
  mjtObj type;  ///< mjOBJ_SITE or mjOBJ_BODY
  int id;
};

/// What a URDF says beyond the model that MuJoCo compiles of it. Empty for an MJCF file.
struct UrdfFacts {
  std::map<std::string, double> efforts;       ///< largest torques of joints [N m or N]
  std::map<std::string, std::string> leaders;  ///< joints that mimic another one, and that one
  std::map<std::string, std::string> fixed;    ///< links behind fixed joints, and their parents
  std::vector<std::string> transmissions;      ///< joints that the <transmission> elements name
};

/// A compiled model. It is never changed, so that all plants of one maker share it.
///
/// A URDF is read as its author meant it: its visual shapes are kept, `package://` in mesh names
/// is resolved, links behind fixed joints are merged into their parents, continuous joints turn
/// without end, and joints follow those that they <mimic>. Nothing touches anything, and there is
/// light. A <mujoco> block of the file overrides what it names.
///
/// The file is first read in a process of its own, so that nothing that MuJoCo does with it ends
/// this one.
class MujocoModel {
 public:
  /// @param uri           path, or package://PACKAGE/PATH
  /// @param find_package  finds the packages that the uri and the file name
  /// @throws std::invalid_argument naming file or package and what is wrong: not found, no model,
  ///         something in it that MuJoCo does not take (with its line)
  MujocoModel(const std::string& uri, const FindPackage& find_package);

  const std::string& uri() const { return uri_; }
  const mjModel& get() const { return *model_; }
  std::shared_ptr<const mjModel> share() const { return model_; }

  /// Of the bytes of the file and of all files that it names: "crc32-" and eight hexadecimal
  /// digits.
  const std::string& digest() const { return digest_; }

  /// Number of the object of this name.
  /// @param type  mjOBJ_JOINT, mjOBJ_SITE, ...
  /// @param key   YAML key that has the name, for the message: "plant/error_sites"
  /// @throws std::invalid_argument with the nearest name and all names, if there is no such object
  int id(mjtObj type, const std::string& name, const std::string& key) const;

  /// The site of this name, else the body.
  /// @throws std::invalid_argument as id()
  Place place(const std::string& name, const std::string& key) const;

  const UrdfFacts& urdf() const { return urdf_; }

  /// Largest torque of a joint by a URDF [N m or N]; none if the file does not say. Many files say
  /// 0.
  std::optional<double> effortLimit(const std::string& joint) const;

  /// Name of an object; "joint_2" if it has none.
  std::string name(mjtObj type, int id) const;

  /// Names of all objects of this type.
  std::vector<std::string> names(mjtObj type) const;

 private:
  std::string uri_;
  std::string digest_;
  UrdfFacts urdf_;
  std::shared_ptr<const mjModel> model_;
};

/// Help for an unknown name: "did you mean wrist? There are shoulder, wrist".
std::string suggestion(const std::string& name, const std::vector<std::string>& known);

}  // namespace ddm

// Class MujocoModel: a model file (MJCF or URDF) that MuJoCo has compiled.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>
#include <mujoco/mujoco.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace ddm {

/// Returns the folder of a ROS package, or an empty text if no package has this name.
using FindPackage = std::function<std::string(const std::string& package)>;

/// @throws std::invalid_argument with the concatenated parts; the function never returns
template <class... Parts>
[[noreturn]] void refuseModel(const Parts&... parts) {
  throw std::invalid_argument(textOf(parts...));
}

/// An object with a position in the world: a site, or the centre of mass of a body (a "link" in a
/// URDF). The origin of a body would not do: it often lies on the axis of the joint that turns the
/// body, and stays there at any angle.
struct Place {
  mjtObj type;  ///< mjOBJ_SITE or mjOBJ_BODY
  int id;
};

/// Facts in a URDF file that MuJoCo does not compile into its model. Empty for an MJCF file.
struct UrdfFacts {
  std::map<std::string, double> efforts;  ///< largest torque or force of each joint [N m or N]
  /// Leader of each joint that mimics another joint.
  std::map<std::string, std::string> leaders;
  /// Parent of each link behind a fixed joint.
  std::map<std::string, std::string> fixed;
  /// Joints that the <transmission> elements name.
  std::vector<std::string> transmissions;
};

/// A compiled model. Plants of the same maker share one model, which never changes.
///
/// For a URDF file this class keeps the visual shapes, resolves `package://` in mesh names, merges
/// links behind fixed joints into their parents, lets continuous joints turn without limits, and
/// couples each joint with a <mimic> element to its leader. Contacts are disabled, and a light is
/// added. A <mujoco> block in the file overrides the settings that the block names.
///
/// A separate process reads the file first, so that a crash or an exit inside MuJoCo does not end
/// this process.
class MujocoModel {
 public:
  /// @param uri           path, or package://PACKAGE/PATH
  /// @param find_package  returns the folders of the packages that the uri and the file name
  /// @throws std::invalid_argument naming the file or package and the reason: the file is not
  ///         found, is not a model, or has content that MuJoCo refuses (with its line)
  MujocoModel(const std::string& uri, const FindPackage& find_package);

  const std::string& uri() const { return uri_; }
  const mjModel& get() const { return *model_; }

  /// Checksum over the bytes of the model file and of all files that it names: "crc32-" and eight
  /// hexadecimal digits.
  const std::string& digest() const { return digest_; }

  /// Index of the object with this name.
  /// @param type  mjOBJ_JOINT, mjOBJ_SITE, mjOBJ_BODY or mjOBJ_CAMERA
  /// @param key   YAML key that holds the name, for the error message: "plant/error_sites"
  /// @throws std::invalid_argument with the nearest name and all names, if there is no such object
  int id(mjtObj type, const std::string& name, const std::string& key) const;

  /// The site with this name, or else the body with this name.
  /// @throws std::invalid_argument as id()
  Place place(const std::string& name, const std::string& key) const;

  const UrdfFacts& urdf() const { return urdf_; }

  /// Largest torque or force of a joint in the URDF file [N m or N]. Empty if the file has no
  /// value. Many files have the value 0.
  std::optional<double> effortLimit(const std::string& joint) const;

  /// Name of an object, or a name made from type and index, such as "joint_2", if the object has
  /// none.
  std::string name(mjtObj type, int id) const;

  /// Names of all objects of this type: joints, sites, bodies or cameras.
  std::vector<std::string> names(mjtObj type) const;

 private:
  std::string uri_;
  std::string digest_;
  UrdfFacts urdf_;
  std::shared_ptr<const mjModel> model_;
};

/// Text that helps with an unknown name: "did you mean wrist? There are shoulder, wrist".
std::string suggestion(const std::string& name, const std::vector<std::string>& known);

}  // namespace ddm

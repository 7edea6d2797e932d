// experiment_node: one program for all roles that launch files need: `experiment_node ROLE ...`.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/tool.h>

#include <map>
#include <string>

namespace ddm {

// Each role is in a file of its own.
int experimentNode(int argc, char** argv);        // Algorithm 1 with ROS nodes
int trialNode(int argc, char** argv);             // one trial with ROS nodes
int replayNode(int argc, char** argv);            // plays a bag to mpc_node
int resolveConfiguration(int argc, char** argv);  // prints the configuration for a launch file

}  // namespace ddm

int main(int argc, char** argv) {
  const std::map<std::string, int (*)(int, char**)> roles = {
      {"experiment", ddm::experimentNode},
      {"trial", ddm::trialNode},
      {"replay", ddm::replayNode},
      {"resolve", ddm::resolveConfiguration}};
  const auto role = roles.find(argc > 1 ? argv[1] : "");
  if (role != roles.end()) return role->second(argc - 1, argv + 1);
  std::cerr << "usage: rosrun ddm_launch experiment_node experiment|trial|replay|resolve ...\n"
               "The launch files start it; `experiment_node resolve --help` lists the options of a "
               "configuration.\n";
  return argc > 1 && std::string(argv[1]) == "--help" ? EXIT_SUCCESS : ddm::kUsageError;
}

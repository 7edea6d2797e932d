// Tests which libraries a package loads that needs the DDM messages only.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/topics.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace ddm {
namespace {

/// Names of all files that this process has loaded, including libraries of libraries.
std::string loadedFiles() {
  std::ifstream maps("/proc/self/maps");
  std::ostringstream text;
  text << maps.rdbuf();
  return text.str();
}

TEST(MessagesOnly, LoadNeitherOpenCvNorYamlCppNorOurLibraries) {
  ddm_msgs::Torque torque;
  torque.header.frame_id = topics::kTorque;
  const std::string loaded = loadedFiles();
  ASSERT_NE(loaded.find("librostime"), std::string::npos);  // a library that messages need
  for (const char* library : {"opencv", "yaml", "cv_bridge", "libroscpp.so", "libddm"}) {
    EXPECT_EQ(loaded.find(library), std::string::npos) << library;
  }
}

}  // namespace
}  // namespace ddm

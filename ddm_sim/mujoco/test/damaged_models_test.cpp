// Tests damaged model files: no file may crash or hang the program, or silently give black images.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/plain_file.h>
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "ddm_plant_plugin/plant_config.h"
#include "ddm_sim/plant.h"
#include "model_folder.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;

class Damage {
 public:
  explicit Damage(unsigned int seed) : engine_(seed) {}

  std::string operator()(std::string text) {
    switch (below(5)) {
      case 0:
        for (int i = 0; i <= below(10); ++i) {
          char& byte = text[static_cast<std::size_t>(below(static_cast<int>(text.size())))];
          byte = static_cast<char>(byte ^ (1 << below(8)));
        }
        return text;
      case 1:
        return text.substr(0, static_cast<std::size_t>(below(static_cast<int>(text.size()))));
      case 2:
        return withoutAnElement(text);
      case 3:
        return withAnotherNumber(text);
      default:
        return withAnotherWord(text);
    }
  }

 private:
  int below(int end) {
    return std::uniform_int_distribution<int>(0, std::max(0, end - 1))(engine_);
  }

  static void collect(tinyxml2::XMLElement* element, std::vector<tinyxml2::XMLElement*>* all) {
    for (auto* child = element->FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      all->push_back(child);
      collect(child, all);
    }
  }

  std::string withoutAnElement(const std::string& text) {
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) return text.substr(1);
    std::vector<tinyxml2::XMLElement*> all;
    collect(document.RootElement(), &all);
    if (all.empty()) return "";
    document.DeleteNode(all[static_cast<std::size_t>(below(static_cast<int>(all.size())))]);
    tinyxml2::XMLPrinter printer;
    document.Print(&printer);
    return printer.CStr();
  }

  /// Position and length of a randomly chosen word of these characters.
  std::pair<std::size_t, std::size_t> wordOf(const std::string& text,
                                             const std::string& characters) {
    std::size_t begin = text.find_first_of(
        characters, static_cast<std::size_t>(below(static_cast<int>(text.size()))));
    if (begin == std::string::npos) begin = 0;
    return {begin, std::min(text.find_first_not_of(characters, begin), text.size()) - begin};
  }

  std::string withAnotherNumber(std::string text) {
    const char* const numbers[] = {"0",    "-1",  "1e9",         "1e-300", "nan",
                                   "1e38", "inf", "-2147483648", "65536",  ""};
    const auto word = wordOf(text, "0123456789.-");
    return text.replace(word.first, word.second, numbers[below(10)]);
  }

  std::string withAnotherWord(std::string text) {
    const std::string letters = "abcdefghijklmnopqrstuvwxyz_";
    const auto to = wordOf(text, letters), from = wordOf(text, letters);
    return text.replace(to.first, to.second, text.substr(from.first, from.second));
  }

  std::mt19937 engine_;
};

/// Loads the plant of a file, draws its images and moves it by five steps.
/// @throws std::exception with the problem of the file
/// @return the brightest grey value of the images
int tryPlant(const std::string& plant_file) {
  const std::unique_ptr<Plant> plant = makePlant(*readPlantFiles({plant_file}));
  int brightest = 0;
  for (int t = 0; t < 5; ++t) {
    const RenderedImage image = plant->render(plant->state());
    brightest = std::max<int>(brightest, *std::max_element(image.bytes.begin(), image.bytes.end()));
    plant->step(Eigen::VectorXd::Constant(plant->torqueDim(), 0.1));
  }
  return brightest;
}

std::vector<std::string> meshesIn(const std::string& folder) {
  std::vector<std::string> meshes;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path kind = entry.path().extension();
    if (kind == ".obj" || kind == ".stl") meshes.push_back(entry.path().string());
  }
  return meshes;
}

void writeModels(const testing::ModelFolder& folder) {
  const std::string plant = "plant: {type: mujoco, dt: 0.1, tolerance: 10.0, model: ";
  folder.write("base.obj", testing::kTetrahedron);
  folder.write("arm.xml", testing::armText("<worldbody><light pos='0 0 3'/></worldbody>"));
  folder.write("arm.yaml", plant + "arm.xml}\n");
  folder.write("legs.urdf", testing::armUrdf("base.obj"));
  folder.write("legs.yaml", plant +
                                "legs.urdf, motors: [elbow], camera_position: [0, 0, 2], "
                                "camera_look_at: [0, 0.1, 0]}\n");
  folder.write(
      "rich.xml",
      "<mujoco><option timestep='0.01'/><default><geom contype='0' conaffinity='0'/></default>"
      "<asset><mesh name='m' file='base.obj'/><texture name='t' type='2d' builtin='checker' "
      "width='64' height='64' rgb1='1 0 0' rgb2='0 1 0'/><material name='w' texture='t'/>"
      "<hfield name='h' nrow='8' ncol='8' size='1 1 0.1 0.1'/></asset><worldbody><light pos='0 0 "
      "3'/>"
      "<camera pos='0 -3 1' xyaxes='1 0 0 0 0 1'/><geom type='hfield' hfield='h'/>"
      "<body name='b'><joint name='j' axis='0 1 0' range='-90 90'/><geom type='mesh' mesh='m' "
      "material='w'/><site name='s' pos='0 0 1'/></body></worldbody><tendon><fixed name='f'><joint "
      "joint='j' coef='1'/></fixed></tendon><actuator><motor joint='j' ctrlrange='-1 "
      "1'/></actuator>"
      "<sensor><jointpos joint='j'/></sensor><keyframe><key qpos='0.1'/></keyframe></mujoco>");
  folder.write("rich.yaml", plant + "rich.xml}\n");
}

TEST(DamagedModels, AreDrawnOrRefusedWithAReason) {
  constexpr int kCopies = 100;
  const std::vector<std::string> plants = {"arm.yaml", "legs.yaml", "rich.yaml"};
  const testing::ModelFolder own;
  writeModels(own);
  const fs::path before = fs::current_path();
  std::map<std::string, int> outcomes;
  for (int copy = 0; copy < kCopies; ++copy) {
    const testing::ModelFolder scratch;
    fs::copy(own.path(), scratch.path(), fs::copy_options::recursive);
    fs::current_path(scratch.path());
    const std::string& plant = plants[static_cast<std::size_t>(copy) % plants.size()];
    const YAML::Node block = YAML::LoadFile(plant)["plant"];
    std::vector<std::string> files = {block["model"].as<std::string>()};
    if (copy % 5 == 4) files = meshesIn(".");
    for (const std::string& file : files) {
      const std::string damaged = Damage(static_cast<unsigned int>(copy))(readFile(file));
      std::ofstream(file, std::ios::binary) << damaged;
    }
    try {
      EXPECT_GE(tryPlant(plant), 10) << "black: copy " << copy << " of " << plant;
      ++outcomes["loaded"];
    } catch (const std::exception& e) {
      EXPECT_NE(std::string(e.what()), "") << copy;
      ++outcomes[std::string(e.what()).find("crashes") == std::string::npos
                     ? "refused"
                     : "refused after a crash"];
    }
    fs::current_path(before);
  }
  for (const auto& outcome : outcomes) std::cout << outcome.first << ": " << outcome.second << '\n';
  EXPECT_GT(outcomes["loaded"], kCopies / 20);
  EXPECT_GT(outcomes["refused"], kCopies / 20);
}

}  // namespace
}  // namespace ddm

// Tests of the factory: a plant of another package keeps the rules of a plant or is refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant_factory.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_sim/testing/toy_plant.h"

namespace ddm {
namespace {

using testing::toyOptions;
using testing::ToyPlant;
using Bytes = ToyPlant::Bytes;
using Traits = ToyPlant::Traits;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// What the factory says of it; empty if it makes it.
std::string refusal(const PlantOptions& plant, const CameraOptions& camera = CameraOptions()) {
  try {
    makePlant(plant, camera);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

struct Flaw {
  const char* name;
  std::function<void(Traits*)> spoil;
  std::vector<std::string> words;  ///< that the refusal must have
};

void PrintTo(const Flaw& flaw, std::ostream* out) { *out << flaw.name; }

class PlantFactoryFlawTest : public ::testing::TestWithParam<Flaw> {};

TEST_P(PlantFactoryFlawTest, IsRefusedByName) {
  Traits traits;
  GetParam().spoil(&traits);
  const std::string text = refusal(toyOptions(traits));
  EXPECT_NE(text.find("their_package/Toy"), std::string::npos) << text;
  EXPECT_NE(text.find("doc/your_plant.md"), std::string::npos) << text;
  for (const std::string& word : GetParam().words) {
    EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
  }
}

std::vector<std::string> names(int count) {
  std::vector<std::string> out;
  for (int i = 0; i < count; ++i) out.push_back("name_" + std::to_string(i));
  return out;
}

std::vector<Flaw> namesAndSizes() {
  return {
      {"StateNameMissing", [](Traits* t) { t->states = {"angle_rad"}; }, {"stateNames()", "2"}},
      {"TorqueNameTooMany",
       [](Traits* t) {
         t->torques = {"a_nm", "b_nm"};
       },
       {"torqueNames()", "a_nm, b_nm"}},
      {"TorqueNameMissing", [](Traits* t) { t->torques.clear(); }, {"torqueNames()"}},
      {"NoJoint", [](Traits* t) { t->joints.clear(); }, {"jointNames()"}},
      {"MoreJointsThanStates", [](Traits* t) { t->joints = names(3); }, {"jointNames()", "name_2"}},
      {"NameWithComma",
       [](Traits* t) { t->states[0] = "angle,rad"; },
       {"stateNames()", "angle,rad"}},
      {"NameWithNewline", [](Traits* t) { t->torques[0] = "torque\n"; }, {"torqueNames()"}},
      {"EmptyName", [](Traits* t) { t->joints[0] = ""; }, {"jointNames()"}},
      {"SameNameTwice", [](Traits* t) { t->states[1] = t->states[0]; }, {"stateNames()"}},
      {"NoState",
       [](Traits* t) {
         t->start.resize(0);
         t->states.clear();
         t->joints.clear();
       },
       {"stateDim()", "got 0"}},
      {"NoTorque",
       [](Traits* t) {
         t->torque_dim = 0;
         t->torques.clear();
       },
       {"torqueDim()", "got 0"}},
      {"NegativeTorqueDim", [](Traits* t) { t->torque_dim = -1; }, {"torqueDim()", "got -1"}},
      {"TooManyTorques",
       [](Traits* t) {
         t->torque_dim = 1001;
         t->torques = names(1001);
       },
       {"torqueDim()", "got 1001"}},
      {"OtherTimeStep", [](Traits* t) { t->dt = 0.1; }, {"plant/dt", "got 0.1"}},
      {"NoTimeStep", [](Traits* t) { t->dt = 0.0; }, {"plant/dt", "got 0"}},
      {"OtherLimit", [](Traits* t) { t->max_torque = 1.0; }, {"plant/max_torque", "got 1"}},
      {"OtherImageSize", [](Traits* t) { t->image_size = 50; }, {"camera/size", "got 50"}},
  };
}

std::vector<Flaw> values() {
  return {
      {"StartIsNaN", [](Traits* t) { t->start[0] = kNaN; }, {"state()", "nan"}},
      {"GoalIsNaN", [](Traits* t) { t->goal[1] = kNaN; }, {"goalState()", "nan"}},
      {"GoalOfAnotherSize",
       [](Traits* t) { t->goal = Eigen::Vector3d::Ones(); },
       {"goalState()", "[1 1 1]"}},
      {"DistanceIsNaN", [](Traits* t) { t->goal_error = kNaN; }, {"distanceToGoal()", "nan"}},
      {"NegativeDistance", [](Traits* t) { t->goal_error = -1.0; }, {"distanceToGoal()", "-1"}},
      {"AngleTheLongWayRound", [](Traits* t) { t->goal_error = 4.0; }, {"distanceToGoal()", "4"}},
      {"PlaceIsNaN", [](Traits* t) { t->place[0] = kNaN; }, {"locate()", "nan"}},
      {"PlaceInSpace",
       [](Traits* t) { t->place = Eigen::Vector3d::Ones(); },
       {"locate()", "[1 1 1]"}},
      {"TooFewPixels",
       [](Traits* t) { t->draw = [](const Eigen::VectorXd&) { return Bytes(2600, 255); }; },
       {"draw()", "2601", "2600"}},
      {"CoversLessThanItDraws",
       [](Traits* t) { t->cover = [](const Eigen::VectorXd&) { return Bytes(2601, 254); }; },
       {"cover()", "254"}},
      {"CoversAnotherNumberOfPixels",
       [](Traits* t) { t->cover = [](const Eigen::VectorXd&) { return Bytes(2602, 255); }; },
       {"cover()", "2602"}},
      {"NextStateIsNaN",
       [](Traits* t) {
         t->advance = [](const Eigen::VectorXd&, const Eigen::VectorXd&) {
           return Eigen::VectorXd(Eigen::Vector2d(0.0, kNaN));
         };
       },
       {"advance()"}},
      {"NextStateOfAnotherSize",
       [](Traits* t) {
         t->advance = [](const Eigen::VectorXd&, const Eigen::VectorXd&) {
           return Eigen::VectorXd(Eigen::VectorXd::Zero(1));
         };
       },
       {"advance()", "[0]"}},
      {"PictureThrows",
       [](Traits* t) {
         t->draw = [](const Eigen::VectorXd&) -> Bytes { throw std::runtime_error("no texture"); };
       },
       {"no texture"}},
  };
}

std::vector<Flaw> memories() {
  return {
      {"StateRemembers",
       [](Traits* t) {
         const auto calls = std::make_shared<int>(0);
         t->advance = [calls](const Eigen::VectorXd& state, const Eigen::VectorXd&) {
           return Eigen::VectorXd(state.array() + 1e-12 * ++*calls);
         };
       },
       {"advance()", "same"}},
      {"PictureRemembers",
       [](Traits* t) {
         const auto calls = std::make_shared<int>(0);
         t->draw = [calls](const Eigen::VectorXd&) {
           Bytes picture(2601, 255);
           picture[1000] = static_cast<std::uint8_t>(255 - ++*calls);
           return picture;
         };
       },
       {"draw()", "same"}},
  };
}

std::string nameOf(const ::testing::TestParamInfo<Flaw>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(NamesAndSizes, PlantFactoryFlawTest, ::testing::ValuesIn(namesAndSizes()),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Values, PlantFactoryFlawTest, ::testing::ValuesIn(values()), nameOf);
INSTANTIATE_TEST_SUITE_P(Memories, PlantFactoryFlawTest, ::testing::ValuesIn(memories()), nameOf);

TEST(PlantFactory, MakesASoundPlantOfAnotherPackageAtItsStart) {
  Traits traits;
  traits.start << 0.25, -0.5;
  EXPECT_EQ(makePlant(toyOptions(traits), CameraOptions())->state(), traits.start);
}

TEST(PlantFactory, ReportsAllThatIsWrongWithAPlantAtOnce) {
  Traits traits;
  traits.states.pop_back();
  traits.goal[0] = kNaN;
  traits.image_size = 10;
  const std::string text = refusal(toyOptions(traits));
  for (const char* word : {"stateNames()", "goalState()", "camera/size"}) {
    EXPECT_NE(text.find(word), std::string::npos) << text;
  }
}

TEST(PlantFactory, RefusesAPlantThatIsAnotherOneEachTimeItIsMade) {
  double slope = 0.1;
  const std::string text = refusal(toyOptions([&slope] {
    slope += 0.01;
    Traits traits;
    traits.advance = [slope](const Eigen::VectorXd& state, const Eigen::VectorXd& torque) {
      return Eigen::VectorXd(state.array() + slope * torque[0]);
    };
    return std::make_unique<ToyPlant>(traits);
  }));
  EXPECT_NE(text.find("same"), std::string::npos) << text;
}

TEST(PlantFactory, RefusesAMakerThatMakesNothing) {
  const std::string text = refusal(toyOptions([] { return nullptr; }));
  EXPECT_NE(text.find("their_package/Toy"), std::string::npos) << text;
}

TEST(PlantFactory, ChecksTheBlocksOfAPluginAsThoseOfOurPlants) {
  PlantOptions plant = toyOptions(Traits());
  plant.dt = 0.0;
  CameraOptions camera;
  camera.size = 0;
  const std::string text = refusal(plant, camera);
  for (const char* key : {"plant/dt", "camera/size"}) {
    EXPECT_NE(text.find(key), std::string::npos) << text;
  }
}

TEST(PlantFactory, RefusesClutterBehindAPlantThatDoesNotSayWhatItCovers) {
  Traits traits;
  traits.cover = [](const Eigen::VectorXd&) { return Bytes(); };
  EXPECT_EQ(refusal(toyOptions(traits)), "");
  CameraOptions camera;
  camera.clutter = 0.25;
  const std::string text = refusal(toyOptions(traits), camera);
  for (const char* word : {"their_package/Toy", "cover()", "camera/clutter", "0.25"}) {
    EXPECT_NE(text.find(word), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace ddm

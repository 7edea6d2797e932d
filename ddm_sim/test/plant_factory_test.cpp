// Tests of the factory: a plant of another package keeps the rules of a plant or is refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant_factory.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_msgs/testing/not_finite.h"
#include "ddm_sim/testing/toy_plant.h"

namespace ddm {
namespace {

using testing::ToyMaker;
using testing::ToyPlant;
using Traits = ToyPlant::Traits;

/// What the factory says of it; empty if it makes it.
std::string refusal(const PlantMaker& maker) {
  try {
    makePlant(maker);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

std::string refusal(const Traits& traits) { return refusal(ToyMaker(traits)); }

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
  const std::string text = refusal(traits);
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
      {"StateNameMissing",
       [](Traits* t) { t->info.state_names.pop_back(); },
       {"start", "start_std", "goal", "1"}},
      {"StateNameTooMany",
       [](Traits* t) { t->info.state_names.push_back("more_m"); },
       {"start", "start_std", "goal", "3"}},
      {"TorqueNameTooMany",
       [](Traits* t) { t->info.torque_names.push_back("more_n"); },
       {"max_torque", "2"}},
      {"NoTorqueName", [](Traits* t) { t->info.torque_names.clear(); }, {"torque_names"}},
      {"NoStateName", [](Traits* t) { t->info.state_names.clear(); }, {"state_names"}},
      {"NoJoint", [](Traits* t) { t->info.joints.clear(); }, {"joints"}},
      {"MoreJointsThanStates",
       [](Traits* t) {
         t->info.joints = {
             {"a", JointKind::kAngle}, {"b", JointKind::kAngle}, {"c", JointKind::kAngle}};
       },
       {"joints", "a, b, c"}},
      {"NameWithComma",
       [](Traits* t) { t->info.state_names[0] = "angle,rad"; },
       {"state_names", "angle,rad"}},
      {"NameWithBlank", [](Traits* t) { t->info.state_names[0] = "a b"; }, {"state_names", "a b"}},
      {"NameWithQuote", [](Traits* t) { t->info.joints[0].name = "a\"b"; }, {"joints"}},
      {"NameWithNewline",
       [](Traits* t) { t->info.torque_names[0] = "torque\n"; },
       {"torque_names"}},
      {"EmptyName", [](Traits* t) { t->info.joints[0].name = ""; }, {"joints"}},
      {"SameNameTwice",
       [](Traits* t) { t->info.state_names[1] = t->info.state_names[0]; },
       {"state_names"}},
      {"TooManyTorques",
       [](Traits* t) {
         t->info.torque_names = names(1001);
         t->info.max_torque = Eigen::VectorXd::Ones(1001);
       },
       {"torque_names", "1001"}},
      {"TooManyStates",
       [](Traits* t) {
         t->info.state_names = names(1001);
         t->info.start = t->info.start_std = t->info.goal = Eigen::VectorXd::Zero(1001);
       },
       {"state_names", "1001"}},
  };
}

std::vector<Flaw> numbers() {
  return {
      {"NoTimeStep", [](Traits* t) { t->info.dt = 0.0; }, {"dt", "got 0"}},
      {"TimeStepIsNaN", [](Traits* t) { t->info.dt = kNaN; }, {"dt", "nan"}},
      {"NoLimit", [](Traits* t) { t->info.max_torque[0] = 0.0; }, {"max_torque", "[0]"}},
      {"LimitIsNaN", [](Traits* t) { t->info.max_torque[0] = kNaN; }, {"max_torque", "nan"}},
      {"LimitMissing", [](Traits* t) { t->info.max_torque.resize(0); }, {"max_torque"}},
      {"StartIsNaN", [](Traits* t) { t->info.start[0] = kNaN; }, {"start", "nan"}},
      {"SpreadIsNaN", [](Traits* t) { t->info.start_std[1] = kNaN; }, {"start_std", "nan"}},
      {"NegativeSpread", [](Traits* t) { t->info.start_std[1] = -0.1; }, {"start_std", "-0.1"}},
      {"GoalIsNaN", [](Traits* t) { t->info.goal[1] = kNaN; }, {"goal", "nan"}},
      {"GoalOfAnotherSize",
       [](Traits* t) { t->info.goal = Eigen::VectorXd::Ones(3); },
       {"goal", "[1 1 1]"}},
      {"NoTolerance", [](Traits* t) { t->info.tolerance = 0.0; }, {"tolerance", "got 0"}},
      {"ToleranceIsNaN", [](Traits* t) { t->info.tolerance = kNaN; }, {"tolerance", "nan"}},
      {"NoUnitOfTheError", [](Traits* t) { t->info.error_unit = ""; }, {"error_unit"}},
  };
}

/// Everywhere the same picture.
void show(Traits* traits, const Picture& picture) {
  traits->draw = [picture](const Eigen::VectorXd&) { return picture; };
}

std::vector<Flaw> answers() {
  using Vector = Eigen::VectorXd;
  return {
      {"ErrorIsNaN",
       [](Traits* t) { t->distance = [](const Vector&, const Vector&) { return kNaN; }; },
       {"error", "nan"}},
      {"NegativeError",
       [](Traits* t) { t->distance = [](const Vector&, const Vector&) { return -1.0; }; },
       {"error", "-1"}},
      {"ErrorAtTheGoal",
       [](Traits* t) { t->distance = [](const Vector&, const Vector&) { return 0.51; }; },
       {"goal", "tolerance", "0.51"}},
      {"ErrorThrows",
       [](Traits* t) {
         t->distance = [](const Vector&, const Vector&) -> double {
           throw std::runtime_error("no ruler");
         };
       },
       {"distance()", "no ruler"}},
      {"DrawnGoalOfAnotherSize",
       [](Traits* t) { t->draw_goal = [](std::mt19937_64*) { return Vector::Ones(3); }; },
       {"drawGoal()", "[1 1 1]"}},
      {"DrawnGoalIsNaN",
       [](Traits* t) { t->draw_goal = [](std::mt19937_64*) { return Vector::Constant(2, kNaN); }; },
       {"drawGoal()", "nan"}},
      {"DrawnGoalIsAnotherEachTime",
       [](Traits* t) {
         const auto calls = std::make_shared<int>(0);
         t->draw_goal = [calls](std::mt19937_64*) { return Vector::Constant(2, ++*calls); };
       },
       {"drawGoal()"}},
      {"PictureOfTheDrawnGoalOfAnotherSize",
       [](Traits* t) {
         t->draw_goal = [](std::mt19937_64*) { return Vector::Constant(2, 9.0); };
         t->draw = [](const Vector& state) {
           return testing::plainPicture(state[0] > 8.0 ? 52 : 51, 255);
         };
       },
       {"draw()", "goal"}},
      {"RewardIsNaN",
       [](Traits* t) { t->reward = [](const Vector&, const Vector&) { return kNaN; }; },
       {"reward()", "nan"}},
      {"PlaceIsNaN",
       [](Traits* t) { t->locate = [](const Vector&) { return Vector::Constant(2, kNaN); }; },
       {"visiblePosition()", "nan"}},
      {"NoPlace",
       [](Traits* t) { t->locate = [](const Vector&) { return Vector(); }; },
       {"visiblePosition()"}},
      {"TooFewPixels",
       [](Traits* t) {
         Picture picture = testing::plainPicture(51, 255);
         picture.bytes.pop_back();
         show(t, picture);
       },
       {"draw()", "51", "2600"}},
      {"CoversLessThanItDraws",
       [](Traits* t) {
         Picture picture = testing::plainPicture(51, 200);
         picture.cover[77] = 199;
         show(t, picture);
       },
       {"cover", "199", "200", "77"}},
      {"CoversLessThanTheBrightestColour",
       [](Traits* t) {
         show(t, {1, 1, 3, {10, 200, 10}, {100}});
       },
       {"cover", "100", "200"}},
      {"CoversAnotherNumberOfPixels",
       [](Traits* t) {
         Picture picture = testing::plainPicture(51, 255);
         picture.cover.push_back(255);
         show(t, picture);
       },
       {"draw()", "cover", "2602"}},
      {"NextStateIsNaN",
       [](Traits* t) {
         t->advance = [](const Vector&, const Vector&) { return Vector::Constant(2, kNaN); };
       },
       {"advance()"}},
      {"NextStateOfAnotherSize",
       [](Traits* t) { t->advance = [](const Vector&, const Vector&) { return Vector::Zero(1); }; },
       {"advance()", "[0]"}},
      {"PictureThrows",
       [](Traits* t) {
         t->draw = [](const Vector&) -> Picture { throw std::runtime_error("no texture"); };
       },
       {"draw()", "no texture"}},
      {"PictureGrows",
       [](Traits* t) {
         t->draw = [](const Vector& state) {
           return testing::plainPicture(state[0] > 0.3 ? 52 : 51, 255);
         };
       },
       {"draw()", "size"}},
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
       {"advance()"}},
      {"PictureRemembers",
       [](Traits* t) {
         const auto calls = std::make_shared<int>(0);
         t->draw = [calls](const Eigen::VectorXd&) {
           Picture picture = testing::plainPicture(51, 255);
           picture.bytes[1000] = static_cast<std::uint8_t>(255 - ++*calls);
           return picture;
         };
       },
       {"draw()"}},
  };
}

std::string nameOf(const ::testing::TestParamInfo<Flaw>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(NamesAndSizes, PlantFactoryFlawTest, ::testing::ValuesIn(namesAndSizes()),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Numbers, PlantFactoryFlawTest, ::testing::ValuesIn(numbers()), nameOf);
INSTANTIATE_TEST_SUITE_P(Answers, PlantFactoryFlawTest, ::testing::ValuesIn(answers()), nameOf);
INSTANTIATE_TEST_SUITE_P(Memories, PlantFactoryFlawTest, ::testing::ValuesIn(memories()), nameOf);

TEST(PlantFactory, MakesASoundPlantOfAnotherPackageAtItsStart) {
  Traits traits;
  traits.info.start << 0.25, -0.5;
  EXPECT_EQ(makePlant(ToyMaker(traits))->state(), traits.info.start);
}

TEST(PlantFactory, MakesAPlantThatDoesNotKnowWhatItCovers) {
  Traits traits;
  show(&traits, {3, 2, 3, std::vector<std::uint8_t>(18, 255), {}});
  EXPECT_EQ(refusal(traits), "");
}

TEST(PlantFactory, ReportsAllThatIsWrongWithAPlantAtOnce) {
  Traits traits;
  traits.info.joints.clear();
  traits.info.goal[0] = kNaN;
  traits.info.tolerance = -1.0;
  traits.info.dt = 0.0;
  const std::string text = refusal(traits);
  for (const char* word : {"joints", "goal", "tolerance", "dt"}) {
    EXPECT_NE(text.find(word), std::string::npos) << text;
  }
}

TEST(PlantFactory, DoesNotBlameAClassForWhatAModelFileDoes) {
  struct ModelMaker : ToyMaker {
    using ToyMaker::ToyMaker;
    std::string type() const override { return "mujoco"; }
  };
  Traits traits;
  traits.advance = [](const Eigen::VectorXd&, const Eigen::VectorXd&) -> Eigen::VectorXd {
    throw std::range_error("unstable: use a smaller timestep");
  };
  EXPECT_NE(refusal(ToyMaker(traits)).find("Correct its class"), std::string::npos);
  const std::string text = refusal(ModelMaker(traits));
  EXPECT_NE(text.find("unstable: use a smaller timestep"), std::string::npos) << text;
  EXPECT_EQ(text.find("class"), std::string::npos) << text;
}

TEST(PlantFactory, RefusesAPlantThatIsAnotherOneEachTimeItIsMade) {
  double slope = 0.1;
  const std::string text = refusal(ToyMaker([&slope] {
    slope += 0.01;
    Traits traits;
    traits.advance = [slope](const Eigen::VectorXd& state, const Eigen::VectorXd& torque) {
      return Eigen::VectorXd(state.array() + slope * torque[0]);
    };
    return std::make_unique<ToyPlant>(traits);
  }));
  EXPECT_NE(text.find("advance()"), std::string::npos) << text;
}

TEST(PlantFactory, RefusesAMakerThatMakesNothing) {
  const std::string text = refusal(ToyMaker([] { return nullptr; }));
  EXPECT_NE(text.find("their_package/Toy"), std::string::npos) << text;
}

TEST(PlantFactory, LetsTheRefusalOfOptionsPass) {
  const auto refuse = []() -> std::unique_ptr<Plant> {
    throw std::invalid_argument("plant/length");
  };
  EXPECT_EQ(refusal(ToyMaker(refuse)), "plant/length");
}

}  // namespace
}  // namespace ddm

// rendering_time PLANT...: how long pictures take, those for the learner and those for people.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_params/param_reader.h>
#include <ddm_params/tool.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ddm_sim/plant_factory.h>

#include <chrono>
#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <random>
#include <stdexcept>
#include <vector>

#include "evaluation.h"

namespace ddm {
namespace {

constexpr int kPictures = 200;

/// How long some work took [ms].
struct Times {
  double wall;
  double cpu;  ///< of all threads: on a busy machine what one idle core would take
};

Times timesOf(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t cpu = std::clock();
  work();
  const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - begin;
  return {wall.count(), 1e3 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC};
}

/// Prints a row: the first picture, with all that is made for it, then the others.
void measure(const char* plant, const char* name, const std::function<void()>& draw) {
  const double first = timesOf(draw).wall;
  std::vector<double> wall, cpu;
  for (int i = 0; i < kPictures; ++i) {
    const Times times = timesOf(draw);
    wall.push_back(times.wall);
    cpu.push_back(times.cpu);
  }
  std::printf("%s,%s,%.3f,%.3f,%.3f,%.1f\n", plant, name, quantile(wall, 0.5), quantile(wall, 0.99),
              quantile(cpu, 0.5), first);
  std::fflush(stdout);
}

void measurePlant(const char* name) {
  ParamReader reader = ParamReader::fromFiles({plantFile(name)});
  const auto maker = readPlant(&reader);
  reader.requireValid();
  const std::unique_ptr<Plant> plant = makePlant(*maker);
  std::mt19937_64 engine(0);
  const auto state = [&] { return plant->drawStart(engine); };
  measure(name, "learner", [&] { plant->render(state()); });
  if (plant->viewModel()) measure(name, "people", [&] { plant->view(state()); });
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  return ddm::runTool(
      "rendering_time",
      [&] {
        if (argc < 2)
          throw std::invalid_argument("usage: rosrun ddm_launch rendering_time PLANT...");
        return true;
      },
      [&] {
        std::printf("plant,picture,median_ms,p99_ms,cpu_median_ms,first_ms\n");
        for (int i = 1; i < argc; ++i) ddm::measurePlant(argv[i]);
      });
}

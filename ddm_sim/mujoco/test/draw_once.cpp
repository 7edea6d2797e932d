// draw_once SCENE.xml ANGLE SIZE SAMPLES: prints a picture's bytes, for the tests.
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "ddm_mujoco/renderer.h"
#include "scene_model.h"

int main(int argc, char** argv) {
  if (argc < 5) return 2;
  try {
    const ddm::testing::SceneModel scene(std::atof(argv[2]), argv[1]);
    ddm::RenderOptions options;
    options.width = options.height = std::atoi(argv[3]);
    options.samples = std::atoi(argv[4]);
    options.colour = true;
    ddm::Renderer renderer(scene.model, options, ddm::SceneOptions());
    for (const int byte : renderer.draw(*scene.data).bytes) std::printf("%02x", byte);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
  return 0;
}

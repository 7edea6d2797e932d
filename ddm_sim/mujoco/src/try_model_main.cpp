// Program try_model PATH [NAME FILE]... < TEXT, run by tryInOwnProcess(): prints `ok` or a reason.
// SPDX-License-Identifier: BSD-3-Clause
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>

#include "load_model.h"

namespace {

void limit(int resource, rlim_t value) {
  const rlimit both = {value, value};
  setrlimit(static_cast<__rlimit_resource_t>(resource), &both);
}

/// Of this process now [bytes].
rlim_t addressSpace() {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "--help") {
    std::cout
        << "usage: try_model PATH [NAME FILE]... < TEXT\n\nReads the text of a model file as "
           "MuJoCo "
           "does and prints ok, or the reason for which a plant\nrefuses it. Plants of the type "
           "mujoco run this program before they read a model themselves.\n";
    return EXIT_SUCCESS;
  }
  constexpr rlim_t kMemory = rlim_t{4} << 30;  // more than this program needs by itself [bytes]
  constexpr rlim_t kComputing = 60;            // [s]
  constexpr unsigned int kWaiting = 300;       // for a loaded machine or a file that never ends [s]
  limit(RLIMIT_AS, addressSpace() + kMemory);
  limit(RLIMIT_CPU, kComputing);
  limit(RLIMIT_CORE, 0);
  alarm(kWaiting);
  if (argc < 2) return EXIT_FAILURE;
  ddm::ModelText model;
  model.path = argv[1];
  for (int i = 2; i + 1 < argc; i += 2) model.meshes.emplace_back(argv[i], argv[i + 1]);
  model.text.assign(std::istreambuf_iterator<char>(std::cin), std::istreambuf_iterator<char>());
  std::string said = "ok";
  try {
    ddm::tryHere(model);
  } catch (const std::bad_alloc&) {
    said = "it needs more than 4 GB of memory: make its meshes, textures and sizes smaller";
  } catch (const std::exception& e) {
    said = e.what();
    if (said.empty()) said = "MuJoCo refuses it without a reason";
  }
  std::fwrite(said.data(), 1, said.size(), stdout);
  std::fflush(stdout);
  _exit(0);  // what MuJoCo leaves behind is not cleaned up
}

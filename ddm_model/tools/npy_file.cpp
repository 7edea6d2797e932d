// NumPy's .npy files: one array each, for those who go on in Python.
// SPDX-License-Identifier: BSD-3-Clause
#include "npy_file.h"

namespace ddm {

std::string npyBytes(const std::string& type, const std::vector<Eigen::Index>& shape, bool fortran,
                     const void* values, std::size_t num_bytes) {
  std::string axes;
  for (const Eigen::Index size : shape) axes += std::to_string(size) + ",";
  std::string header = "{'descr': '" + type +
                       "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': (" +
                       axes + ")}";
  constexpr std::size_t kPreamble = 10;  // magic, version, length of the header
  while ((kPreamble + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  return bytes + header + std::string(static_cast<const char*>(values), num_bytes);
}

}  // namespace ddm

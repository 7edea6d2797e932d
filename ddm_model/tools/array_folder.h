// A folder of NumPy's .npy files, for those who go on in Python.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_files/plain_file.h>

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>

namespace ddm {

inline const char* npyType(double) { return "<f8"; }
inline const char* npyType(float) { return "<f4"; }
inline const char* npyType(std::uint8_t) { return "|u1"; }
inline const char* npyType(std::int64_t) { return "<i8"; }

/// All functions throw std::runtime_error with the path if a file cannot be written.
class ArrayFolder {
 public:
  /// Makes the folder if need be.
  explicit ArrayFolder(std::string path) : path_(std::move(path)) {
    std::filesystem::create_directories(path_);
  }

  /// Writes NAME.npy, format 1.0: a matrix; a vector has one axis, a 1 x 1 matrix is a number.
  template <class Derived>
  void write(const std::string& name, const Eigen::PlainObjectBase<Derived>& matrix) const {
    using Scalar = typename Derived::Scalar;
    std::string shape;
    if (Derived::SizeAtCompileTime != 1) shape += std::to_string(matrix.rows()) + ",";
    if (Derived::ColsAtCompileTime != 1) shape += std::to_string(matrix.cols()) + ",";
    std::string header = std::string("{'descr': '") + npyType(Scalar()) +
                         "', 'fortran_order': True, 'shape': (" + shape + ")}";
    constexpr std::size_t kRest = 11;  // magic, version, size of the header, end of its line
    const std::size_t blocks = (kRest + header.size() + 63) / 64;
    header.resize(64 * blocks - kRest, ' ');
    header += '\n';
    std::string bytes("\x93NUMPY\x01\x00", 8);
    bytes += static_cast<char>(header.size() & 0xff);
    bytes += static_cast<char>(header.size() >> 8);
    bytes += header;
    bytes.append(reinterpret_cast<const char*>(matrix.data()), matrix.size() * sizeof(Scalar));
    writeFileAtomically(path_ + "/" + name + ".npy", bytes);
  }

  template <class Number>
  void writeNumber(const std::string& name, Number value) const {
    const Eigen::Matrix<Number, 1, 1> number = Eigen::Matrix<Number, 1, 1>::Constant(value);
    write(name, number);
  }

 private:
  std::string path_;
};

}  // namespace ddm

// NumPy's .npy files: one array each, for those who go on in Python.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace ddm {

/// An array as the bytes of a .npy file, format 1.0.
/// @param type     NumPy's name, "<f8"
/// @param shape    size along each axis, the first one varies slowest
/// @param fortran  the first axis varies fastest instead
std::string npyBytes(const std::string& type, const std::vector<Eigen::Index>& shape, bool fortran,
                     const void* values, std::size_t num_bytes);

inline const char* npyType(double) { return "<f8"; }
inline const char* npyType(float) { return "<f4"; }
inline const char* npyType(std::uint8_t) { return "|u1"; }
inline const char* npyType(std::int64_t) { return "<i8"; }

/// A matrix with its shape; a vector has one axis.
template <class Derived>
std::string npyOf(const Eigen::PlainObjectBase<Derived>& matrix) {
  std::vector<Eigen::Index> shape = {matrix.rows()};
  if (Derived::ColsAtCompileTime != 1) shape.push_back(matrix.cols());
  return npyBytes(npyType(typename Derived::Scalar()), shape, /*fortran=*/true, matrix.data(),
                  static_cast<std::size_t>(matrix.size()) * sizeof(typename Derived::Scalar));
}

/// A single number.
template <class Number>
std::string npyOfNumber(Number value) {
  return npyBytes(npyType(value), {}, false, &value, sizeof(value));
}

}  // namespace ddm

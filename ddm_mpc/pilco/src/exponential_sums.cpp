// Sums of n x n weighted exponentials: nearly all the time of PILCO is spent here.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/exponential_sums.h"

#include <cstdint>
#include <cstring>

namespace ddm::pilco {
namespace {

/// Written with the vector extensions that GCC and Clang share, because Eigen is bound to one
/// instruction set for the whole build (its types depend on it). Everything is inlined into the
/// function that chooses the instruction set.
template <int kBytes>
struct Kernel {
  static constexpr int kLanes = kBytes / static_cast<int>(sizeof(double));
  static_assert(kRowPadding % kLanes == 0, "a column must be a whole number of registers");
  typedef double Pack __attribute__((vector_size(kBytes)));
  typedef std::int64_t Bits __attribute__((vector_size(kBytes)));

  /// x = exp(x): 2^k exp(r) with k = round(x / ln 2), |r| <= ln(2) / 2, and the Taylor polynomial
  /// of degree 12, whose remainder there is 2e-16.
  __attribute__((always_inline)) static inline void exponential(Pack* x) {
    const Pack lowest = Pack{} - 500.0;  // less, times a weight, may be denormal: slow
    const Pack highest = Pack{} + 709.0;
    Pack v = *x;
    v = v < lowest ? lowest : v;
    v = v > highest ? highest : v;
    const Pack shift = Pack{} + 6755399441055744.0;  // 1.5 * 2^52: k stands in the low bits
    const Pack shifted = v * 1.4426950408889634 + shift;
    Bits k_bits;
    std::memcpy(&k_bits, &shifted, sizeof(shifted));
    const Pack k = shifted - shift;
    // ln 2 in two parts; the product of k with the first one is exact.
    const Pack r = (v - k * 0.693147180369123816490) - k * 1.90821492927058770002e-10;
    Pack p = r * (1.0 / 479001600.0) + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    p = p * r + 1.0;
    p = p * r + 1.0;
    Bits result;
    std::memcpy(&result, &p, sizeof(p));
    result += k_bits << 52;  // adds k to the exponent
    std::memcpy(x, &result, sizeof(result));
  }

  __attribute__((always_inline)) static inline double sum(const Pack& pack) {
    double lanes[kLanes];
    std::memcpy(lanes, &pack, kBytes);
    double total = 0.0;
    for (const double lane : lanes) total += lane;
    return total;
  }

  /// @tparam kDim  D where it is known to the compiler, which then keeps the moments in registers;
  ///               0 for any D
  /// @param moments  memory for D registers, for kDim = 0
  template <int kDim>
  __attribute__((always_inline)) static inline void run(const ExponentialMatrix& matrix,
                                                        Pack* moments, ExponentialSums* sums) {
    const Eigen::Index rows = matrix.u.rows();
    const Eigen::Index dim = kDim > 0 ? kDim : matrix.u.cols();
    const double* const u = matrix.u.data();
    const double* const f = matrix.f.data();
    double* const row_sums = sums->rows.data();
    Pack in_registers[kDim > 0 ? kDim : 1];
    Pack* const moment = kDim > 0 ? in_registers : moments;
    for (Eigen::Index j = 0; j < matrix.g.size(); ++j) {
      const double* const v = matrix.v.data() + j * dim;
      const double* const weights = matrix.weights + j * matrix.weight_stride;
      const double g = matrix.g[j];
      const double column_weight = matrix.column_weights[j];
      for (Eigen::Index d = 0; d < dim; ++d) moment[d] = Pack{};
      Pack column_sum = Pack{};
      for (Eigen::Index i = matrix.lower_triangle ? j / kLanes * kLanes : 0; i < rows;
           i += kLanes) {
        Pack p, factor;
        std::memcpy(&p, f + i, kBytes);
        p += g;
        for (Eigen::Index d = 0; d < dim; ++d) {
          std::memcpy(&factor, u + d * rows + i, kBytes);
          p += factor * v[d];
        }
        exponential(&p);
        std::memcpy(&factor, weights + i, kBytes);
        p *= factor * column_weight;
        std::memcpy(&factor, row_sums + i, kBytes);
        factor += p;
        std::memcpy(row_sums + i, &factor, kBytes);
        column_sum += p;
        for (Eigen::Index d = 0; d < dim; ++d) {
          std::memcpy(&factor, u + d * rows + i, kBytes);
          moment[d] += factor * p;
        }
      }
      sums->columns[j] = sum(column_sum);
      for (Eigen::Index d = 0; d < dim; ++d) sums->moments(d, j) = sum(moment[d]);
    }
  }

  __attribute__((always_inline)) static inline void choose(const ExponentialMatrix& matrix,
                                                           ExponentialSums* sums) {
    switch (matrix.u.cols()) {
      case 3:
        return run<3>(matrix, nullptr, sums);
      case 4:
        return run<4>(matrix, nullptr, sums);
      case 5:
        return run<5>(matrix, nullptr, sums);
      default: {
        Eigen::VectorXd memory(matrix.u.cols() * kLanes + kLanes);
        return run<0>(matrix, aligned(memory.data()), sums);
      }
    }
  }

  __attribute__((always_inline)) static inline Pack* aligned(double* memory) {
    const std::uintptr_t address = reinterpret_cast<std::uintptr_t>(memory);
    return reinterpret_cast<Pack*>((address + kBytes - 1) / kBytes * kBytes);
  }
};

#if defined(__AVX512F__)
constexpr int kBuildBytes = 64;
#elif defined(__AVX__)
constexpr int kBuildBytes = 32;
#else
constexpr int kBuildBytes = 16;
#endif

#if defined(__x86_64__) && !(defined(__AVX2__) && defined(__FMA__))
#define DDM_PILCO_CHOOSE_AT_RUN_TIME
__attribute__((target("avx2,fma"))) void runWithAvx2(const ExponentialMatrix& matrix,
                                                     ExponentialSums* sums) {
  Kernel<32>::choose(matrix, sums);
}
#endif

void runAsBuilt(const ExponentialMatrix& matrix, ExponentialSums* sums) {
  Kernel<kBuildBytes>::choose(matrix, sums);
}

}  // namespace

void exponentialSums(const ExponentialMatrix& matrix, ExponentialSums* sums) {
  const Eigen::Index rows = matrix.u.rows();
  const Eigen::Index dim = matrix.u.cols();
  const Eigen::Index cols = matrix.g.size();
  eigen_assert(rows % kRowPadding == 0 && matrix.f.size() == rows && matrix.weights != nullptr &&
               matrix.v.rows() == dim && matrix.v.cols() == cols &&
               matrix.column_weights.size() == cols);
  sums->rows.setZero(rows);
  sums->columns.resize(cols);
  sums->moments.resize(dim, cols);
#ifdef DDM_PILCO_CHOOSE_AT_RUN_TIME
  static const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (has_avx2) {
    runWithAvx2(matrix, sums);
    return;
  }
#endif
  runAsBuilt(matrix, sums);
}

}  // namespace ddm::pilco

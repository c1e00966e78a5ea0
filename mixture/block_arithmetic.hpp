#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstdint>

#include "mixture/point_blocks.hpp"

namespace modebank {

/// A few lanes at a time stay in registers, with enough independent sums to hide the latency of an addition.
inline constexpr Eigen::Index lane_count = 8;
using Lanes = Eigen::Array<double, lane_count, 1>;
static_assert(block_size % lane_count == 0);

/// sum_n a_n b_n over one block, summed lane by lane.
template <class A, class B>
double block_dot(const A& a, const B& b) {
  Lanes sum = Lanes::Zero();
  for (Eigen::Index n = 0; n < block_size; n += lane_count)
    sum += a.template segment<lane_count>(n) * b.template segment<lane_count>(n);
  return sum.sum();
}

/// exp of every entry, for entries in [-700, 700] (not checked), to 4e-16 relative: 2^n times the Taylor polynomial of
/// degree 12 on [-log(2)/2, log(2)/2]. Eigen's exp takes more than twice as long in a portable (SSE2) build, where it
/// is half of an EM iteration; free of branches, so that compilers vectorise it.
template <class Column>
void block_exp(Column&& values) {
  constexpr double inverse_log2 = 1.4426950408889634074;
  // Cephes' split of log 2: n * log2_high is exact.
  constexpr double log2_high = 6.93145751953125e-1, log2_low = 1.42860682030941723212e-6;
  // Adding it rounds to an integer, which is then in the low bits of the mantissa.
  constexpr double rounder = 6755399441055744.0;
  for (Eigen::Index i = 0; i < block_size; ++i) {
    const double x = values(i);
    const double shifted = x * inverse_log2 + rounder, n = shifted - rounder;
    const double r = (x - n * log2_high) - n * log2_low;
    const double r2 = r * r, r4 = r2 * r2;
    const double low = (1.0 / 2 + r * (1.0 / 6)) + r2 * (1.0 / 24 + r * (1.0 / 120));
    const double middle = (1.0 / 720 + r * (1.0 / 5040)) + r2 * (1.0 / 40320 + r * (1.0 / 362880));
    const double high = (1.0 / 3628800 + r * (1.0 / 39916800)) + r2 * (1.0 / 479001600);
    const double exp_minus_one = r + r2 * (low + r4 * (middle + r4 * high));
    const double power = std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) + 1023) << 52);
    values(i) = power + power * exp_minus_one;
  }
}

}  // namespace modebank

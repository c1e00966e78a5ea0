#pragma once

#include "filter/step/bank.hpp"

/// The motions of a bank. Modes of one motion share theta and differ in noise (Bank::motion).
namespace modebank {

/// Number of motions, passages among them.
Eigen::Index motion_count(const Bank& bank);
/// Mean stay in a motion [samples]: one over the rate at which the chain leaves the motion's modes G. With the
/// stationary probabilities pi of T,
///   rate = sum_{i in G} pi_i sum_{j not in G} T(i, j) / sum_{i in G} pi_i.
/// Infinite if it is never left.
double stay_in_motion(const Bank& bank, Eigen::Index motion);
/// Number of motions with a mean stay of five samples or more, at least one. A shorter one is a passage from one motion
/// to another: it stays in the bank, and is not counted.
Eigen::Index counted_motions(const Bank& bank);

/// The 63 % response time of a single linear model [samples], the smallest over states and inputs; 1 without one, as
/// for an integrator.
double response_samples(const Bank& single);
/// The gain in log score from which on a description of the runs with more motions counts [nats over all samples]:
/// max(12, .02 per max(one sample, a tenth of the response time)). Errors within one response of the system are alike
/// in kind, so the limit counts response times: a faster logger changes neither limit nor gain.
double least_nats(double samples, double response_samples);

}  // namespace modebank

#pragma once

#include <cstddef>

/// Between scalar_imm.cpp and its kernels, which are compiled once per instruction set. Pointers are aligned to 64
/// bytes and hold `stride` numbers per row.
namespace modebank::scalar_imm {

/// One run, a mode per lane. Modes beyond the bank's have F = Q = 0, variance 1 and are never reached.
struct ModeLanes {
  std::size_t modes, stride, inputs, count;  ///< count: samples
  double C, R;
  const double *F, *c, *Q;                ///< stride
  const double* B;                        ///< inputs x stride
  const double* transition;               ///< modes x stride, row: from
  const double* measurement;              ///< count
  const double* v;                        ///< inputs x (count - 1), one transition after the other
  double *mean, *variance, *probability;  ///< stride: the start, overwritten
};
using ModeKernel = double (*)(const ModeLanes&);
/// Null where the bank needs more registers than there are.
ModeKernel mode_kernel(std::size_t modes);

/// A run per lane, as many as a register has.
struct RunLanes {
  bool shared_bank;                       ///< one bank for all, whose numbers stand once; else one per lane
  std::size_t modes, inputs, count;       ///< count: transitions
  const double *C, *R;                    ///< 1
  const double *F, *c, *Q;                ///< modes
  const double* B;                        ///< inputs x modes
  const double* transition;               ///< modes x modes, first index: from
  const double* measurement;              ///< count x lanes; NaN after a run's end
  const double* v;                        ///< count x inputs x lanes
  double *mean, *variance, *probability;  ///< modes x lanes: the start, overwritten; variance follows mean
  double* next;                           ///< 2 x modes x lanes: workspace, means and variances in turn with those
  double* workspace;                      ///< 5 x modes x lanes
  double* log_likelihood;                 ///< lanes: added to
};
void run_lanes(const RunLanes& lanes);
std::size_t lane_count();

}  // namespace modebank::scalar_imm

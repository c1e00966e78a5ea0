#pragma once

/// All installed headers. A program may include this header and link only some components. The functions of other
/// components are then declared, but cannot be linked.

#include "modebank/archive/load_bank.hpp"
#include "modebank/base/dual.hpp"
#if __has_include(<Eigen/Core>)
#include "modebank/base/eigen.hpp"
#endif
#include "modebank/base/error.hpp"
#include "modebank/base/matrix.hpp"
#include "modebank/base/names.hpp"
#include "modebank/base/recording.hpp"
#include "modebank/filter/bank.hpp"
#include "modebank/filter/bank_filter.hpp"
#include "modebank/filter/forecast_weights.hpp"
#include "modebank/filter/options.hpp"
#include "modebank/ident/auto_diff_motion_model.hpp"
#include "modebank/ident/input_delays.hpp"
#include "modebank/ident/motion_model.hpp"
#include "modebank/ident/options.hpp"
#include "modebank/ident/windows.hpp"
#include "modebank/judge/evaluate.hpp"
#include "modebank/learn/learn.hpp"
#include "modebank/learn/options.hpp"
#include "modebank/learn/results.hpp"
#include "modebank/mixture/candidate.hpp"
#include "modebank/mixture/mixture.hpp"
#include "modebank/mixture/options.hpp"

#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"
#include "io/archive/archive.hpp"
#include "modebank/filter/options.hpp"

namespace modebank::app {

/// A number's standard error where it is not known is NaN; of what is no estimate (companion rows, an absent c) it is
/// 0.
struct ModeErrors {
  Eigen::MatrixXd A, B;  ///< of the archive's increment, and so of A = I + increment
  Eigen::VectorXd c;
};

/// What every exported form says, read once. A is I + the archive's increment.
struct ExportedBank {
  std::string filter;     ///< which of the archive's filters: bank or a competitor
  std::string archive;    ///< file name
  std::string sha256;     ///< of the archive's content
  Provenance provenance;  ///< of the archive
  FilterOptions options;  ///< how the archive ran it
  Calibration verdict = Calibration::undecided;
  std::string verdict_words;  ///< with what it rests on
  std::string judged_on;      ///< held-out, training; empty: it was not judged
  double coverage_95 = 0.0;
  std::string finding;  ///< whether runs ask for modes of motion; may be empty
  Bank bank;
  std::vector<Channel> measurements;     ///< n_y
  std::vector<Channel> states;           ///< n, lagged ones among them
  std::vector<Channel> inputs;           ///< m, lagged ones among them
  std::vector<Channel> recorded_inputs;  ///< u as it is recorded
  double input_lag_s = 0.0;              ///< inputs were taken this much earlier than recorded
  std::vector<std::string> mode_names;   ///< K
  std::vector<double> use;               ///< K, mean probability on judged runs; empty of competitors
  std::vector<std::string> parameter_names, parameter_units;  ///< p, of the modes' theta
  std::vector<ModeErrors> errors;                             ///< K
  std::vector<bool> open;                                     ///< p, what the training runs leave open; or empty

  const LinearStructure& structure() const { return bank.structure; }
  Eigen::MatrixXd A(Eigen::Index mode) const { return bank.modes[static_cast<std::size_t>(mode)].model.full_form(); }
  bool may_be_trusted() const {
    return verdict != Calibration::overconfident && verdict != Calibration::underconfident;
  }
  /// The verdict in a sentence.
  std::string verdict_text() const;
  /// Sentences on what a reader of the bank's numbers alone would not learn.
  std::vector<std::string> remarks() const;
};

/// Why a value may not be taken as it stands, for a remark beside it; empty where it may.
std::string doubt_about(double value, double standard_error);
/// The doubt about an entry of a mode's theta.
std::string doubt_about_parameter(const ExportedBank& bank, Eigen::Index mode, Eigen::Index parameter);

/// The equation that every form states, in one line of ASCII.
inline constexpr const char* exported_equation =
    "x[k+1] = A x[k] + B u[k] + c + w, w ~ N(0, Q); y[k] = C x[k] + v, v ~ N(0, R)";
/// What T's rows are.
inline constexpr const char* transition_meaning =
    "T[i][j] = P(mode j next | mode i now): a row is the mode that is left, and sums to one";

/// The filter's bank with what is known of it. Throws DataError when the archive holds none of this name.
ExportedBank exported_bank(const Archive& archive, const OpenArchive& file, const std::string& filter,
                           const FilterOptions& options, double input_lag_s);

}  // namespace modebank::app

#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "app/text/motions.hpp"
#include "filter/step/bank.hpp"
#include "io/archive/archive.hpp"
#include "modebank/filter/options.hpp"

namespace modebank::app {

/// Standard errors. NaN means unknown. 0 marks entries that are not estimates: companion rows, an absent c.
struct ModeErrors {
  Eigen::MatrixXd A, B;  ///< errors of the increment in the archive; A = I + increment has the same errors
  Eigen::VectorXd c;
};

/// Content that all exported forms share; read only once. A is I + the increment in the archive.
struct ExportedBank {
  std::string filter;     ///< filter of the archive: "bank", or a competitor
  std::string archive;    ///< file name
  std::string sha256;     ///< hash of the archive's content
  Provenance provenance;  ///< provenance of the archive, with the version that wrote it
  FilterOptions options;  ///< options with which the archive's filter was judged
  Calibration verdict = Calibration::undecided;
  std::string verdict_words;  ///< verdict with its numbers
  std::string judged_on;      ///< held-out or training runs; empty if the filter was not judged
  double coverage_95 = 0.0;
  std::string finding;  ///< the finding on modes of motion; may be empty
  Bank bank;
  std::vector<Channel> measurements;     ///< n_y
  std::vector<Channel> states;           ///< n states of the model, with lagged states
  std::vector<Channel> inputs;           ///< m inputs of the model, with lagged inputs
  std::vector<Channel> recorded_inputs;  ///< the inputs as recorded, without lags
  double input_lag_s = 0.0;              ///< time by which the bank uses its inputs earlier than recorded
  std::vector<std::string> mode_names;   ///< K
  std::vector<double> use;               ///< K, mean probability of each mode on judged runs; empty for competitors
  std::vector<Motion> motions;           ///< most used first; for competitors, ordered by their share of windows
  std::vector<std::string> parameter_names, parameter_units;  ///< p, names and units of the entries of a mode's theta
  std::vector<ModeErrors> errors;                             ///< K
  std::vector<bool> unidentifiable;  ///< p, true if the training runs do not determine the parameter; may be empty

  const LinearStructure& structure() const { return bank.structure; }
  Eigen::MatrixXd A(Eigen::Index mode) const { return bank.modes[static_cast<std::size_t>(mode)].model.full_form(); }
  bool may_be_trusted() const {
    return verdict != Calibration::overconfident && verdict != Calibration::underconfident;
  }
  /// The verdict as a sentence.
  std::string verdict_text() const;
  /// Sentences on facts that the numbers of the bank do not show.
  std::vector<std::string> remarks() const;
};

/// Remark on an unreliable value; empty if the value is reliable.
std::string doubt_about(double value, double standard_error);
/// Same as doubt_about, for an entry of a mode's theta.
std::string doubt_about_parameter(const ExportedBank& bank, Eigen::Index mode, Eigen::Index parameter);

/// The equation of the model for all forms, as one line of ASCII.
inline constexpr const char* exported_equation =
    "x[k+1] = A x[k] + B u[k] + c + w, w ~ N(0, Q); y[k] = C x[k] + v, v ~ N(0, R)";
/// Meaning of the rows of T.
inline constexpr const char* transition_meaning =
    "T[i][j] = P(mode j next | mode i now): a row is the mode that is left, and sums to one";

/// A bank of the archive's filter, with all data for an export. Throws DataError if the archive does not have this
/// filter.
ExportedBank exported_bank(const Archive& archive, const OpenArchive& file, const std::string& filter,
                           const FilterOptions& options, double input_lag_s);

}  // namespace modebank::app

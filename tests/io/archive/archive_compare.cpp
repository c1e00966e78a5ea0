// Compares archives field by field: every field becomes a line of text, numbers with all their bits.
#include <cstdio>
#include <cstring>
#include <optional>
#include <type_traits>

#include "tests/io/archive/archive_fixture.hpp"

namespace modebank::test {

namespace {

/// All fields of a value as text. Two values are equal if their texts are.
class Listing {
 public:
  template <class... T>
  void operator()(const T&... values) {
    (put(values), ...);
    text += '\n';
  }
  std::string text;

 private:
  void put(const std::string& value) { text += '"' + value + "\" "; }
  void put(double value) {
    char word[40];
    std::snprintf(word, sizeof word, "%a ", value);
    text += word;
  }
  template <class T>
  requires std::is_integral_v<T> || std::is_enum_v<T>
  void put(T value) { text += std::to_string(static_cast<long long>(value)) + ' '; }
  template <class Derived>
  void put(const Eigen::DenseBase<Derived>& values) {
    text += std::to_string(values.rows()) + " x " + std::to_string(values.cols()) + ": ";
    for (Index j = 0; j < values.cols(); ++j)
      for (Index i = 0; i < values.rows(); ++i) put(values.derived()(i, j));
  }
  template <class A, class B>
  void put(const std::pair<A, B>& values) {
    put(values.first), put(values.second);
  }
  template <class T>
  void put(const std::vector<T>& values) {
    text += std::to_string(values.size()) + " of\n";
    for (const T& value : values) put(value);
  }
  template <class T>
  void put(const std::optional<T>& value) {
    text += value ? "one " : "none ";
    if (value) put(*value);
  }
  template <class T>
  requires(std::is_class_v<T> && !std::is_base_of_v<Eigen::DenseBase<T>, T>) void put(const T& value) {
    list(*this, value);
  }
};

void list(Listing& to, const Channel& c) { to(c.name, c.unit); }
void list(Listing& to, const InputFile& f) { to(f.path, f.bytes, f.sha256); }
void list(Listing& to, const Provenance& p) {
  to(p.modebank_version, p.created, p.command_line, p.config_hash, p.data_hash, p.versions, p.inputs);
}
void list(Listing& to, const Trajectory& t) {
  to(t.run, t.role, t.lag_s, t.time_s, t.time_origin_ns, t.state, t.input, t.truth);
}
void list(Listing& to, const Recording& r) { to(r.states, r.inputs, r.runs, r.quantum); }
void list(Listing& to, const RunLag& r) { to(r.run, r.status, r.lag_s, r.applied_lag_s); }
void list(Listing& to, const LagReport& r) {
  to(r.correction, r.lag.mean, r.lag.between_sd, r.lag.count, r.lag.standard_error, r.runs);
  for (const auto& score : r.scores) to(score.correction, score.gain_standard_error);
}
void list(Listing& to, const LinearStructure& s) {
  to(s.states, s.inputs, s.intercept, s.state_lags, s.input_lags, s.parameter_names());
  for (Index i = 0; i < s.inputs; ++i) to(s.input_delay[i]);
}
void list(Listing& to, const Window& w) { to(w.run, w.start); }
void list(Listing& to, const WindowFits& w) {
  to(w.structure, w.length, w.step, w.loss, w.windows, w.parameters, w.covariance, w.noise_variance, w.condition);
  to(w.rank, w.information, w.inlier_fraction, w.status, w.r_squared, w.weighed_information, w.transitions, w.prior_sd);
  to(w.global.theta, w.global.covariance, w.global.residual_covariance, w.global.transitions);
}
void list(Listing& to, const ResidualTests& t) {
  to(t.samples, t.level, t.autocorrelation, t.autocorrelation_band, t.cross_correlation, t.cross_correlation_band,
     t.ljung_box_p);
}
void list(Listing& to, const ResidualTestSet& s) { to(s.model, s.runs); }
void list(Listing& to, const Candidate& c) {
  to(c.components, c.covariance, c.log_likelihood, c.parameters, c.effective_samples, c.bic, c.aic, c.iterations);
  to(c.converged, c.agreeing_restarts, c.selected, c.bic_naive, c.restarts, c.floor_active, c.failed, c.status);
}
void list(Listing& to, const MixtureResult& m) {
  to(m.mixture.weights, m.mixture.means, m.mixture.covariances, m.mixture.type, m.mixture.noise.weight);
  to(m.mixture.noise.lower, m.mixture.noise.upper, m.feature_names, m.labels, m.responsibilities.all(), m.candidates);
}
void list(Listing& to, const Mode& m) {
  to(m.model.A, m.model.B, m.model.c, m.Q, m.parameter_covariance, m.standard_error, m.Q_standard_error, m.bend,
     m.bend_standard_error, m.weight);
}
void list(Listing& to, const Term& t) { to(t.kind, t.variables, t.knot); }
void list(Listing& to, const ScreenedMode& s) { to(s.component, s.weight, s.spectral_radius, s.reason); }
void list(Listing& to, const Bank& b) {
  to(b.structure, b.modes, b.terms.terms, b.terms.direction, b.terms.low, b.terms.high, b.terms.unit, b.C, b.R);
  to(b.transition.matrix(), b.transition_logit.weights, b.transition_logit.reference, b.motion);
  to(b.initial_probability, b.R_standard_error, b.transition_standard_error);
  to(b.state_names, b.input_names, b.dt_s);
  to(b.screened);
}
/// The drifting competitor has one mode and neither errors nor weights.
void list_drifting(Listing& to, const Bank& b) {
  to(b.structure, b.state_names, b.input_names, b.dt_s, b.theta(0), b.noise_variance(), b.drift.scale);
  to(b.drift.rates.q, b.drift.rates.p0, b.drift.rates.leak, b.drift.tuning.log_score, b.drift.tuning.samples,
     b.running_noise.lam, b.running_noise.nu, b.running_noise.floor, b.running_noise.horizon_factor,
     b.running_noise.level, b.running_noise.switching);
}
void list(Listing& to, const PairedGain& g) {
  to(g.competitor, g.samples, g.gain, g.standard_error, g.degrees_of_freedom, g.margin, g.by_blocks, g.rank_p);
}
void list(Listing& to, const BetterMean& m) { to(m.competitor, m.horizon, m.state, m.rmse_bank, m.rmse); }
void list(Listing& to, const Finding& f) {
  to(f.answer, f.role, f.runs, f.modes, f.best_competitor, f.gain, f.standard_error, f.description);
  to(f.stay, f.stay_asked, f.terms_asked, f.pattern.gain, f.pattern.standard_error, f.better_description, f.equations);
  to(f.text, f.gains, f.better_means);
}
void list(Listing& to, const RunEvaluation& e) {
  to(e.prediction, e.innovation, e.innovation_covariance, e.state, e.covariance, e.nis, e.pit, e.log_density);
  to(e.mode_probability_predicted, e.mode_probability, e.viterbi_mode);
}
void list(Listing& to, const FreeRun& r) { to(r.mean, r.deviation, r.lower, r.upper, r.mode); }
void list(Listing& to, const FilterEvaluation& e) { to(e.filter, e.runs, e.free_runs); }
void list(Listing& to, const SummaryRow& r) {
  to(r.filter, r.role, r.run, r.samples, r.log_score, r.rmse, r.nis_mean, r.nis_above, r.nis_below, r.too_far);
  to(r.too_close, r.pit_distance, r.whiteness_p, r.coverage_50, r.coverage_90, r.coverage_95, r.coverage_99);
}
void list(Listing& to, const FreeRunRow& r) {
  to(r.filter, r.role, r.run, r.start, r.samples, r.log_score, r.rmse, r.nrmse, r.fit, r.lost_paths);
  to(r.coverage_50, r.coverage_90, r.coverage_95, r.coverage_99);
}
void list(Listing& to, const HorizonRow& r) {
  to(r.filter, r.role, r.run, r.horizon, r.samples, r.log_score, r.rmse, r.coverage_95);
}
void list(Listing& to, const DiagnosticsRow& r) {
  to(r.filter, r.role, r.mode, r.samples, r.usage, r.entropy, r.dwell, r.dwell_model, r.nis_mean, r.nees_mean);
  to(r.coverage_50, r.coverage_50_lower, r.coverage_50_upper, r.coverage_90, r.coverage_90_lower, r.coverage_90_upper);
  to(r.coverage_95, r.coverage_95_lower, r.coverage_95_upper, r.coverage_99, r.coverage_99_lower, r.coverage_99_upper);
  to(r.too_far, r.too_far_lower, r.too_far_upper, r.too_close, r.too_close_lower, r.too_close_upper, r.whiteness_p);
  to(r.autocorrelation, r.autocorrelation_lag, r.state_rmse, r.verdict, r.reason, r.flags);
}
void list(Listing& to, const ConfusionRow& r) { to(r.filter, r.role, r.label, r.mode, r.samples, r.share); }
void list(Listing& to, const CombinationRow& r) { to(r.role, r.horizon, r.filter, r.weight, r.start); }
void list(Listing& to, const LeftOutRow& r) { to(r.filter, r.horizon, r.samples, r.log_score, r.rmse, r.start); }
void list(Listing& to, const RunLabels& l) { to(l.names, l.of_runs); }
void list(Listing& to, const Archive& a) {
  to(a.provenance), to(a.config), to(a.recording), to(a.lag), to(a.windows), to(a.mixture), to(a.bank);
  to(a.measured_fit, a.learned_transitions, a.mode_names, a.labels, a.confusion);
  to(a.unrefined), to(a.baseline), to(a.noise_only), to(a.one_motion), to(a.nonlinear), to(a.drifting.has_value());
  if (a.drifting) list_drifting(to, *a.drifting);
  to(a.finding), to(a.evaluations), to(a.residual_tests), to(a.summary), to(a.free_runs), to(a.horizons);
  to(a.combination), to(a.left_out), to(a.diagnostics);
}

template <class T>
std::string listed(const T& value) {
  Listing listing;
  list(listing, value);
  return listing.text;
}

}  // namespace

::testing::AssertionResult same_bits(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& expected) {
  if (actual.rows() != expected.rows() || actual.cols() != expected.cols())
    return ::testing::AssertionFailure() << "shape " << actual.rows() << " x " << actual.cols() << ", expected "
                                         << expected.rows() << " x " << expected.cols();
  for (Index j = 0; j < actual.cols(); ++j)
    for (Index i = 0; i < actual.rows(); ++i)
      if (std::memcmp(&actual(i, j), &expected(i, j), sizeof(double)) != 0)
        return ::testing::AssertionFailure()
               << "at (" << i << ", " << j << "): " << actual(i, j) << ", expected " << expected(i, j);
  return ::testing::AssertionSuccess();
}

void expect_same(const RunEvaluation& actual, const RunEvaluation& expected) {
  EXPECT_EQ(listed(actual), listed(expected));
}

void expect_same(const Archive& actual, const Archive& expected) {
  // Not EXPECT_EQ, whose difference of large archives would take minutes.
  const std::string a = listed(actual), e = listed(expected);
  const auto at = std::mismatch(a.begin(), a.end(), e.begin(), e.end()).first - a.begin();
  EXPECT_TRUE(a == e) << "from here: " << a.substr(static_cast<std::size_t>(at), 200);
}

}  // namespace modebank::test

#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "ident/lag/structure.hpp"
#include "ident/lag/structure_scorer.hpp"

/// How structures are compared once they are scored.
namespace modebank {

using ScoredStructures = std::map<Lags, LeftOutForecast>;

/// Coefficients per equation, but for the constant.
struct StructureSize {
  Eigen::Index states = 1, inputs = 0;
  Eigen::Index operator()(const Lags& lags) const { return lags[0] * states + lags[1] * inputs; }
};

inline bool acts_at_once(const Lags& lags) { return lags[2] == 0; }
inline bool acts_later(const Lags& lags) { return lags[2] > 0; }

ScoredStructures select(const ScoredStructures& all, bool (*wanted)(const Lags&));

/// The highest score, the first of equals. Of those that are wanted, of which there must be one.
Lags best_of(const ScoredStructures& all);
Lags best_of(const ScoredStructures& all, bool (*wanted)(const Lags&));

/// Whether structures without delay gain what they must over the others, best against best: 0.02 nats per sample, and
/// more than the standard error of that.
bool gains_enough(const ScoredStructures& at_once, const ScoredStructures& later, const Eigen::VectorXd& weight);
/// The best of all structures, one without delay only where it gains enough.
Lags best_with_delay_rule(const ScoredStructures& all, const Eigen::VectorXd& weight);

/// A loss over so many samples [nats/sample] that chance makes, or that is next to nothing.
double loss_by_chance(double samples);

/// The loss of a structure against another [nats/sample], and its standard error over parts.
struct StructureLoss {
  double mean = 0.0, standard_error = 0.0;
  double weight = 1.0;  ///< samples
  /// Whether the mean is at most its error or loss_by_chance.
  bool negligible() const;
};
StructureLoss loss_against(const LeftOutForecast& best, const LeftOutForecast& other, const Eigen::VectorXd& weight);

/// Half of them the best, the others the smallest that lose no more than one standard error.
std::vector<Lags> finalists_of(const ScoredStructures& all, const StructureSize& size, const Eigen::VectorXd& weight,
                               std::size_t count);

/// The smallest whose loss against the best is negligible; of equally small ones the best.
Lags smallest_as_good(const ScoredStructures& all, const StructureSize& size, const Eigen::VectorXd& weight);

/// A row for each, the best first.
std::vector<StructureScore> score_table(const ScoredStructures& all, const Lags& chosen, const Eigen::VectorXd& weight);

}  // namespace modebank

#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "ident/lag/structure.hpp"
#include "ident/lag/structure_scorer.hpp"

/// Rules for comparing structures by their scores.
namespace modebank {

using ScoredStructures = std::map<Lags, LeftOutForecast>;

/// Number of coefficients per equation without the constant.
struct StructureSize {
  Eigen::Index states = 1, inputs = 0;
  Eigen::Index operator()(const Lags& lags) const { return lags[0] * states + lags[1] * inputs; }
};

inline bool acts_at_once(const Lags& lags) { return lags[2] == 0; }
inline bool acts_later(const Lags& lags) { return lags[2] > 0; }

ScoredStructures select(const ScoredStructures& all, bool (*wanted)(const Lags&));

/// The structure with the highest score. On a tie, the first structure with this score. Only structures for which
/// `wanted` is true are considered; there must be at least one.
Lags best_of(const ScoredStructures& all);
Lags best_of(const ScoredStructures& all, bool (*wanted)(const Lags&));

/// Whether the best structure without delay is clearly better than the best structure with a delay. The gain must be at
/// least 0.02 nats per sample and above its standard error.
bool gains_enough(const ScoredStructures& at_once, const ScoredStructures& later, const Eigen::VectorXd& weight);
/// The best structure. A structure without delay is returned only if gains_enough holds.
Lags best_with_delay_rule(const ScoredStructures& all, const Eigen::VectorXd& weight);

/// Largest loss that counts as chance for this number of samples, or as negligible [nats/sample].
double loss_by_chance(double samples);

/// The loss of one structure relative to another [nats/sample], with its standard error over parts.
struct StructureLoss {
  double mean = 0.0, standard_error = 0.0;
  double weight = 1.0;  ///< number of samples

  /// Whether the mean loss is at most its standard error, or at most loss_by_chance.
  bool negligible() const;
};
StructureLoss loss_against(const LeftOutForecast& best, const LeftOutForecast& other, const Eigen::VectorXd& weight);

/// The finalists. Half of them are the structures with the best scores. The other half are the smallest structures
/// whose loss is at most one standard error.
std::vector<Lags> finalists_of(const ScoredStructures& all, const StructureSize& size, const Eigen::VectorXd& weight,
                               std::size_t count);

/// The smallest structure whose loss relative to the best one is negligible. Among equally small structures, the one
/// with the highest score.
Lags smallest_as_good(const ScoredStructures& all, const StructureSize& size, const Eigen::VectorXd& weight);

/// One row per structure, ordered by decreasing score.
std::vector<StructureScore> score_table(const ScoredStructures& all, const Lags& chosen, const Eigen::VectorXd& weight);

}  // namespace modebank

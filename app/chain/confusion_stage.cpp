#include "app/chain/stages.hpp"
#include "app/text/judged_runs.hpp"

namespace modebank {

std::vector<ConfusionRow> confusion_of(const Archive& archive) {
  if (!archive.labels || !archive.bank) return {};
  const Role role = judged_role(archive);
  const std::vector<Trajectory>& runs = archive.recording->runs;
  Eigen::MatrixXi counts = Eigen::MatrixXi::Zero(std::ssize(archive.labels->names), archive.bank->mode_count());
  for (const FilterEvaluation& evaluation : archive.evaluations)
    for (std::size_t r = 0; r < runs.size() && evaluation.filter == "bank"; ++r) {
      const Eigen::MatrixXd& probability = evaluation.runs[r].mode_probability;  // K x N
      for (Index k = 0; k < runs[r].samples() && runs[r].role == role; ++k) {
        Index mode = 0;
        const int label = archive.labels->of_runs[r](k);
        if (label < 0 || !probability.col(k).allFinite()) continue;
        probability.col(k).maxCoeff(&mode);
        ++counts(label, mode);
      }
    }
  std::vector<ConfusionRow> rows;
  for (Index label = 0; label < counts.rows(); ++label)
    for (Index mode = 0; mode < counts.cols() && counts.row(label).sum() > 0; ++mode)
      rows.push_back({"bank", role, archive.labels->names[static_cast<std::size_t>(label)], mode, counts(label, mode),
                      static_cast<double>(counts(label, mode)) / counts.row(label).sum()});
  return rows;
}

}  // namespace modebank

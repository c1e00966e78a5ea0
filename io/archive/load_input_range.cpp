#include "io/archive/load_input_range.hpp"

#include <cmath>

#include "ident/base/not_a_number.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/archive/groups/group_reader.hpp"
#include "io/archive/groups/over_runs.hpp"
#include "io/archive/layout_data.hpp"

namespace modebank {
namespace {

/// Extends the range to the values of a run. Missing values are ignored.
void widen(InputRange& range, const Eigen::MatrixXd& input) {
  for (Eigen::Index i = 0; i < input.rows(); ++i)
    for (const double value : input.row(i)) {
      range.least(i) = std::fmin(range.least(i), value);
      range.largest(i) = std::fmax(range.largest(i), value);
    }
}

}  // namespace

InputRange load_input_range(const OpenArchive& archive) {
  InputRange range;
  read_root(archive, [&](GroupReader& root) {
    root.optional_group("data", true, {}, [&](GroupReader& data) {
      Recording recording;
      layout::exchange_channels(data, recording);
      std::vector<RunRow> rows;
      data.table("runs", rows, column("name", &RunRow::name), column("role", &RunRow::role),
                 column("first", &RunRow::first).obeying(rule::not_negative),
                 column("samples", &RunRow::samples).obeying(rule::not_negative));
      data.set_size("m", recording.inputs.size());
      const auto inputs = static_cast<Eigen::Index>(recording.inputs.size());
      range.least = range.largest = Eigen::VectorXd::Constant(inputs, not_a_number);
      over_runs(data, rows_of(rows), [&](auto& samples, std::size_t i) {
        if (rows[i].role != Role::train) return;
        Eigen::MatrixXd input;
        samples.field("input", input, {"S", "m"});
        widen(range, input);
      });
    });
  });
  return range;
}

}  // namespace modebank

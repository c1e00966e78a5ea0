#include "io/import/bring.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Eigen::VectorXd;

/// Keeps the samples whose times lie within the time span of `source`.
void keep_covered(FileStream& target, const FileStream& source) {
  const VectorXd& time_s = target.stream.time_s;
  const VectorXd& covered = source.stream.time_s;
  const double* const from = std::lower_bound(time_s.data(), time_s.data() + time_s.size(), covered(0));
  const double* const to = std::upper_bound(from, time_s.data() + time_s.size(), covered(covered.size() - 1));
  const Index first = from - time_s.data(), count = to - from;
  if (count == 0)
    throw DataError(fmt::format("{}: columns {} ({} to {} s) and {} ({} to {} s) do not overlap in time", target.file,
                                target.time_column, target.time_text(0), target.time_text(time_s.size() - 1),
                                source.time_column, source.time_text(0), source.time_text(covered.size() - 1)));
  target.line = std::vector<std::uint64_t>(target.line.begin() + first, target.line.begin() + first + count);
  target.stream = {time_s.segment(first, count).eval(), target.stream.values.middleCols(first, count).eval()};
}

}  // namespace

void bring_to(FileStream& target, const FileStream& source, const std::vector<Index>& channels, Bring how) {
  keep_covered(target, source);
  const Stream theirs{source.stream.time_s, source.stream.values(channels, Eigen::all)};
  const VectorXd& time_s = target.stream.time_s;
  Eigen::MatrixXd values = how == Bring::held ? hold(theirs, time_s) : interpolate(theirs, time_s);
  if (how == Bring::interpolated) blank_gaps(theirs.time_s, time_s, values);
  target.stream.values(channels, Eigen::all) = values;
}

}  // namespace modebank

#include "filter/step/snapshot_numbers.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace modebank {

namespace {

using Eigen::Index;

constexpr double numbers_format = 3.0;

/// Calls part(x) for every part of a snapshot, in the order of the numbers.
template <class Snapshot, class Part>
void for_each_part(Snapshot& snapshot, Part part) {
  part(snapshot.started);
  part(snapshot.means);
  part(snapshot.covariances);
  part(snapshot.mode_probability);
  part(snapshot.drift.theta);
  part(snapshot.drift.P);
  part(snapshot.drift.variance);
  part(snapshot.drift.level);
  part(snapshot.samples.inputs);
  part(snapshot.samples.measurements);
  part(snapshot.samples.samples);
  part(snapshot.samples.whole);
  part(snapshot.samples.time_s);
}

struct NumbersWriter {
  std::vector<double>& numbers;

  void operator()(bool value) const { numbers.push_back(value ? 1.0 : 0.0); }
  void operator()(double value) const { numbers.push_back(value); }
  void operator()(Index value) const { numbers.push_back(static_cast<double>(value)); }
  template <class Derived>
  void operator()(const Eigen::PlainObjectBase<Derived>& matrix) const {
    (*this)(matrix.rows());
    (*this)(matrix.cols());
    numbers.insert(numbers.end(), matrix.data(), matrix.data() + matrix.size());
  }
  void operator()(const std::vector<Eigen::MatrixXd>& matrices) const {
    (*this)(static_cast<Index>(matrices.size()));
    for (const Eigen::MatrixXd& matrix : matrices) (*this)(matrix);
  }
};

class NumbersReader {
 public:
  explicit NumbersReader(const std::vector<double>& numbers) : numbers_(numbers) {}

  void operator()(bool& value) { value = count(1) == 1; }
  void operator()(double& value) { value = next(); }
  void operator()(Index& value) {
    constexpr Index most_samples = Index(1) << 53;
    value = count(most_samples);
  }
  template <class Derived>
  void operator()(Eigen::PlainObjectBase<Derived>& matrix) {
    const Index rows = count(left()), cols = count(left());
    if (Derived::ColsAtCompileTime == 1 && cols != 1) refuse();
    if (rows > 0 && cols > left() / rows) refuse();
    matrix.resize(rows, cols);
    for (double& value : matrix.reshaped()) value = next();
  }
  void operator()(std::vector<Eigen::MatrixXd>& matrices) {
    matrices.resize(static_cast<std::size_t>(count(left() / 2)));  // two sizes precede each of these
    for (Eigen::MatrixXd& matrix : matrices) (*this)(matrix);
  }
  void require_end() const {
    if (left() > 0) refuse();
  }

 private:
  const std::vector<double>& numbers_;
  std::size_t at_ = 0;

  [[noreturn]] static void refuse() {
    throw std::invalid_argument("the snapshot is damaged: its sizes do not match its number of values");
  }
  Index left() const { return static_cast<Index>(numbers_.size() - at_); }
  double next() {
    if (left() == 0) refuse();
    return numbers_[at_++];
  }
  /// Reads a whole number from 0 to `most`.
  Index count(Index most) {
    const double value = next();
    if (!(value >= 0.0 && value <= static_cast<double>(most) && value == std::floor(value))) refuse();
    return static_cast<Index>(value);
  }
};

}  // namespace

std::vector<double> to_numbers(const FilterSnapshot& snapshot) {
  std::vector<double> numbers{numbers_format};
  for_each_part(snapshot, NumbersWriter{numbers});
  return numbers;
}

FilterSnapshot snapshot_of(const std::vector<double>& numbers) {
  NumbersReader reader(numbers);
  double format = 0.0;
  reader(format);
  if (format != numbers_format)
    throw std::invalid_argument("the snapshot comes from another version of the library, or not from a filter");
  FilterSnapshot snapshot;
  for_each_part(snapshot, [&](auto& part) { reader(part); });
  reader.require_end();
  return snapshot;
}

}  // namespace modebank

#include "app/init/mounting.hpp"

#include <array>
#include <cmath>

#include "ident/data/streams.hpp"

namespace modebank::app {
namespace {

using Eigen::VectorXd;
constexpr std::array axes{Axis::x, Axis::y, Axis::z};
/// [m/s^2] A mean acceleration in this range is gravity. The range allows for wrong sensor scales.
constexpr double least_gravity = 7.0, most_gravity = 12.5;

const SurveyedChannel* channel_of(const SurveyedTable& table, Axis axis, bool (*names)(std::string_view, Axis)) {
  for (const SurveyedChannel& channel : table.channels)
    if (channel.is_number() && names(channel.name, axis)) return &channel;
  return nullptr;
}

/// The yaw rate in another table than the gyro's.
std::pair<const SurveyedTable*, const SurveyedChannel*> other_yaw_rate(const std::vector<SurveyedFile>& files,
                                                                       const ChannelPlace& z_rate) {
  for (std::size_t f = 0; f < files.size(); ++f)
    for (std::size_t t = 0; t < files[f].tables.size(); ++t) {
      if (f == z_rate.file && t == z_rate.table) continue;
      const SurveyedTable& table = files[f].tables[t];
      const SurveyedChannel* found = channel_of(table, Axis::z, names_angular_rate);
      if (found != nullptr && found->moves()) return {&table, found};
    }
  return {};
}

Stream usable(const SurveyedTable& table, const VectorXd& values) {
  return in_order({table.time_s.array() + static_cast<double>(table.origin_ns) / 1e9, values.transpose()});
}

double correlation_of(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) {
  const Eigen::ArrayXd da = a - a.mean(), db = b - b.mean();
  const double scale = std::sqrt(da.square().sum() * db.square().sum());
  return scale > 0.0 ? (da * db).sum() / scale : 0.0;
}

/// Largest correlation of two channels from different tables, over lags from -2 s to 2 s. It uses the samples of the
/// slower channel. 0 if the channels share fewer than ten samples.
double correlation(const SurveyedTable& a, const VectorXd& in_a, const SurveyedTable& b, const VectorXd& in_b) {
  constexpr double longest_lag_s = 2.0;
  constexpr int lags = 40;
  Stream slow = usable(a, in_a), fast = usable(b, in_b);
  if (slow.time_s.size() > fast.time_s.size()) std::swap(slow, fast);
  if (slow.time_s.size() < 10) return 0.0;
  double largest = 0.0;
  for (int i = -lags; i <= lags; ++i) {
    const VectorXd shifted = slow.time_s.array() + longest_lag_s * i / lags;
    std::vector<Eigen::Index> inside;
    for (Eigen::Index k = 0; k < shifted.size(); ++k)
      if (shifted(k) >= fast.time_s(0) && shifted(k) <= fast.time_s(fast.time_s.size() - 1)) inside.push_back(k);
    if (inside.size() < 10) continue;
    const Eigen::MatrixXd there = interpolate(fast, shifted(inside));
    const Eigen::ArrayXd x = slow.values.row(0)(inside).transpose(), y = there.row(0).transpose();
    if (!x.isFinite().all() || !y.isFinite().all()) return 0.0;
    const double found = correlation_of(x, y);
    if (std::abs(found) > std::abs(largest)) largest = found;
  }
  return largest;
}

}  // namespace

std::optional<Mounting> find_mounting(const std::vector<SurveyedFile>& files, const ChannelPlace& z_rate) {
  const SurveyedTable& table = files[z_rate.file].tables[z_rate.table];
  Mounting mounting;
  for (const Axis axis : axes) {
    const SurveyedChannel* along = channel_of(table, axis, names_acceleration);
    if (along == nullptr) continue;
    const double mean = along->check.mean;
    if (std::abs(mean) >= least_gravity && std::abs(mean) <= most_gravity &&
        std::abs(mean) > std::abs(mounting.gravity)) {
      mounting.up = axis;
      mounting.reversed = mean < 0.0;
      mounting.gravity = mean;
    }
  }
  if (mounting.gravity == 0.0 || (mounting.up == Axis::z && !mounting.reversed)) return std::nullopt;
  const SurveyedChannel *z = &table.channels[z_rate.channel], *up = channel_of(table, mounting.up, names_angular_rate);
  if (up == nullptr) return std::nullopt;
  mounting.z_rate = z->name;
  mounting.up_rate = up->name;
  if (const auto [where, other] = other_yaw_rate(files, z_rate); other != nullptr) {
    mounting.other = other->name;
    mounting.z_correlation = correlation(*where, other->values, table, z->values);
    mounting.up_correlation = correlation(*where, other->values, table, up->values);
  }
  return mounting;
}

}  // namespace modebank::app

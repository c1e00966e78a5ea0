#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/chain/listener.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// The banks of an archive, to score them on other data.
struct StoredBanks {
  Bank bank;
  std::optional<Bank> baseline, noise_only, one_motion, unrefined;
  std::optional<Bank> drifting;
  MeasuredFit measured_fit = MeasuredFit::none;
  std::vector<std::string> mode_names = {};
  std::optional<Bank> nonlinear = {};
  bool terms_asked = false;
  std::vector<LeftOutRow> left_out = {};
};

/// A remark if the sample period of the data is not the step of the bank; else empty.
std::string period_remark(const std::string& file, const Bank& bank, const Recording& recording);

/// `one_model`: for a single Kalman filter, the bank is the archive's baseline. Warns if the scores can be misread:
/// test runs that trained the bank, other columns, another sample period. Throws DataError if the bank does not exist
/// or its channels do not fit the data's channels.
StoredBanks read_banks(const std::filesystem::path& file, const Recording& recording, bool one_model, const Tell& tell);

}  // namespace modebank

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/chain/listener.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// The banks of an archive, to be scored on other data.
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

/// What is to be said where data are sampled at another period than the bank's steps take; empty where they are not.
std::string period_remark(const std::string& file, const Bank& bank, const Recording& recording);

/// `one_model`: a single Kalman filter is asked for, so that the bank is the archive's baseline. Warns of what makes
/// the scores mean something else than they seem to: test runs that the bank was trained on, other columns, another
/// sample period. Throws DataError when there is no such bank or its channels do not fit the data's.
StoredBanks read_banks(const std::filesystem::path& file, const Recording& recording, bool one_model,
                       const Listener& listener);

}  // namespace modebank

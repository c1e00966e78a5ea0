#include "io/archive/filter_checkpoint.hpp"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "ident/base/not_a_number.hpp"
#include "io/files/replace_file.hpp"
#include "io/files/sha256.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using nlohmann::json;

constexpr const char* checkpoint_format = "modebank checkpoint 2";

/// SHA-256 of a checkpoint, computed without the digest that it contains.
std::string digest_of(json stored) {
  stored.erase("sha256");
  return sha256_hex(stored.dump());
}

json to_json(const Eigen::MatrixXd& matrix) {
  json columns = json::array();
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    json column = json::array();
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
      column.push_back(std::isfinite(matrix(i, j)) ? json(matrix(i, j)) : json());
    columns.push_back(std::move(column));
  }
  return {{"rows", matrix.rows()}, {"columns", std::move(columns)}};
}

Eigen::MatrixXd matrix_of(const json& stored) {
  const json& columns = stored.at("columns");
  const auto rows = stored.at("rows").get<std::size_t>();
  for (const json& column : columns)
    if (!stored.at("rows").is_number_unsigned() || column.size() != rows) throw std::invalid_argument("column length");
  Eigen::MatrixXd matrix(columns.empty() ? 0 : static_cast<Eigen::Index>(rows),
                         static_cast<Eigen::Index>(columns.size()));
  for (Eigen::Index j = 0; j < matrix.cols(); ++j)
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      const json& value = columns.at(static_cast<std::size_t>(j)).at(static_cast<std::size_t>(i));
      matrix(i, j) = value.is_null() ? not_a_number : value.get<double>();
    }
  return matrix;
}

Eigen::VectorXd vector_of(const json& stored) {
  const Eigen::MatrixXd matrix = matrix_of(stored);
  if (matrix.cols() != 1) throw std::invalid_argument("a vector has one column");
  return matrix;
}

json to_json(const std::vector<Eigen::MatrixXd>& matrices) {
  json list = json::array();
  for (const Eigen::MatrixXd& matrix : matrices) list.push_back(to_json(matrix));
  return list;
}

std::vector<Eigen::MatrixXd> matrices_of(const json& stored) {
  std::vector<Eigen::MatrixXd> matrices;
  for (const json& matrix : stored) matrices.push_back(matrix_of(matrix));
  return matrices;
}

/// State of a filter whose modes drift. Empty for other filters.
DriftState drift_of(const json& stored) {
  if (!stored.contains("drift")) return {};
  const json& drift = stored.at("drift");
  return {matrix_of(drift.at("theta")), matrices_of(drift.at("P")), matrices_of(drift.at("cross")),
          drift.contains("variance") ? vector_of(drift.at("variance")) : Eigen::VectorXd()};
}

}  // namespace

FileForm checkpoint_form() {
  return {"a checkpoint of track", [](const std::filesystem::path& path) {
            std::ifstream file(path);
            const json stored = json::parse(file, nullptr, false);
            return stored.is_object() && stored.value("format", json()).is_string() &&
                   stored["format"].get<std::string>().starts_with("modebank checkpoint ");
          }};
}

void save_checkpoint(const std::filesystem::path& path, const std::string& identity, const FilterSnapshot& snapshot) {
  json stored{{"format", checkpoint_format},
              {"identity", identity},
              {"started", snapshot.started},
              {"means", to_json(snapshot.means)},
              {"covariances", to_json(snapshot.covariances)},
              {"mode_probability", to_json(snapshot.mode_probability)},
              {"noise_scale", snapshot.noise_scale},
              {"noise_samples", snapshot.noise_samples},
              {"inputs", to_json(snapshot.samples.inputs)},
              {"measurements", to_json(snapshot.samples.measurements)},
              {"samples", snapshot.samples.samples},
              {"whole", snapshot.samples.whole},
              {"time_s", std::isfinite(snapshot.samples.time_s) ? json(snapshot.samples.time_s) : json()}};
  if (const DriftState& drift = snapshot.drift; drift.theta.size() > 0)
    stored["drift"] = {{"theta", to_json(drift.theta)}, {"P", to_json(drift.P)}, {"cross", to_json(drift.cross)}};
  if (snapshot.drift.variance.size() > 0) stored["drift"]["variance"] = to_json(snapshot.drift.variance);
  stored["sha256"] = digest_of(stored);
  replace_file(final_target(path), {stored.dump(1), "\n"});
}

FilterSnapshot load_checkpoint(const std::filesystem::path& path, const std::string& identity) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw ConfigurationError(path.string() + ": the checkpoint does not exist or is not a regular file");
  std::ifstream file(path);
  if (!file) throw ConfigurationError(path.string() + ": the checkpoint does not exist or cannot be read");
  try {
    const json stored = json::parse(file);
    if (stored.at("format") != checkpoint_format) throw DataError(path.string() + ": is not a checkpoint of track");
    if (stored.at("sha256") != digest_of(stored))
      throw DataError(path.string() +
                      ": the checkpoint was damaged or changed after it was written (its SHA-256 does not match)");
    if (stored.at("identity") != identity)
      throw DataError(path.string() + ": the checkpoint was made with another bank or other filter settings");
    FilterSnapshot snapshot;
    snapshot.started = stored.at("started").get<bool>();
    snapshot.means = matrix_of(stored.at("means"));
    snapshot.covariances = matrix_of(stored.at("covariances"));
    snapshot.mode_probability = vector_of(stored.at("mode_probability"));
    snapshot.noise_scale = stored.at("noise_scale").get<double>();
    snapshot.noise_samples = stored.at("noise_samples").get<double>();
    snapshot.drift = drift_of(stored);
    snapshot.samples.inputs = matrix_of(stored.at("inputs"));
    snapshot.samples.measurements = matrix_of(stored.at("measurements"));
    snapshot.samples.samples = stored.at("samples").get<Eigen::Index>();
    snapshot.samples.whole = stored.at("whole").get<Eigen::Index>();
    snapshot.samples.time_s = stored.at("time_s").is_null() ? not_a_number : stored.at("time_s").get<double>();
    return snapshot;
  } catch (const json::exception&) {
    throw DataError(path.string() + ": is not a complete checkpoint of track");
  } catch (const std::invalid_argument&) {
    throw DataError(path.string() + ": is not a complete checkpoint of track");
  }
}

}  // namespace modebank

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace modebank::app::report {

/// Base64 by RFC 4648, section 4.
std::string base64(const std::string& bytes);

/// Arrays that a page draws. Each array is split into byte planes: all first bytes, all second bytes, and so on.
/// Neighbours in a plane are similar, so the planes compress well. They are deflated and stored in base64. The page
/// unpacks an array when it first needs the values.
class PageArrays {
 public:
  /// Adds an array and returns its reference for the page: {"id", "type": "f4" | "f8" | "i4" | "share", "size"}.
  nlohmann::json add(const Eigen::Ref<const Eigen::VectorXd>& values);        ///< as float32, for drawing
  nlohmann::json add_exact(const Eigen::Ref<const Eigen::VectorXd>& values);  ///< as float64, for times
  /// Shares from 0 to 1 with an error of 1.5e-5 in two bytes, to draw probabilities.
  nlohmann::json add_shares(const Eigen::Ref<const Eigen::VectorXd>& values);
  nlohmann::json add(const std::vector<std::int32_t>& values);

  /// The stored arrays in order; array i has the id "a<i>".
  const std::vector<std::string>& stored() const { return stored_; }
  /// Size in the page of all arrays together [bytes].
  std::size_t bytes() const { return bytes_; }
  /// Largest possible size of an array with `values` values of `width` bytes [bytes].
  static std::size_t most_bytes(Eigen::Index values, std::size_t width);

 private:
  template <class T>
  nlohmann::json store(const T* values, std::size_t count, const char* type);

  std::vector<std::string> stored_;
  std::size_t bytes_ = 0;
};

}  // namespace modebank::app::report

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace modebank::app::report {

/// RFC 4648, section 4.
std::string base64(const std::string& bytes);

/// The arrays a page draws. Each is stored by byte planes (all first bytes, all second bytes, ...; neighbours are alike
/// there), deflated and in base64; the page unpacks one when it first needs it.
class PageArrays {
 public:
  /// Each returns what the page finds the array by: {"id", "type": "f4" | "f8" | "i4" | "share", "size"}.
  nlohmann::json add(const Eigen::Ref<const Eigen::VectorXd>& values);        ///< as float32: for drawing
  nlohmann::json add_exact(const Eigen::Ref<const Eigen::VectorXd>& values);  ///< as float64: times
  /// Shares from 0 to 1 to 1.5e-5, in half the room: for drawing probabilities.
  nlohmann::json add_shares(const Eigen::Ref<const Eigen::VectorXd>& values);
  nlohmann::json add(const std::vector<std::int32_t>& values);

  /// The stored arrays in order; array i has the id "a<i>".
  const std::vector<std::string>& stored() const { return stored_; }
  /// Bytes that all of them take in the page.
  std::size_t bytes() const { return bytes_; }
  /// Those that an array of so many values of this width takes at most.
  static std::size_t most_bytes(Eigen::Index values, std::size_t width);

 private:
  template <class T>
  nlohmann::json store(const T* values, std::size_t count, const char* type);

  std::vector<std::string> stored_;
  std::size_t bytes_ = 0;
};

}  // namespace modebank::app::report

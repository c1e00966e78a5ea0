#include "app/report/page/page_arrays.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace modebank::app::report {
namespace {

template <class T>
std::string byte_planes(const T* values, std::size_t count) {
  std::string planes(count * sizeof(T), '\0');
  const char* bytes = reinterpret_cast<const char*>(values);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t b = 0; b < sizeof(T); ++b) planes[b * count + i] = bytes[i * sizeof(T) + b];
  return planes;
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string result(size, '\0');
  const int status = compress2(reinterpret_cast<Bytef*>(result.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()), 3);
  if (status != Z_OK) throw std::runtime_error(fmt::format("zlib's compress2 failed with status {}", status));
  result.resize(size);
  return result;
}

std::size_t base64_size(std::size_t bytes) { return 4 * ((bytes + 2) / 3); }

constexpr std::size_t bytes_around = 100;  // size of an array's element in the page and of the reference to it

}  // namespace

std::string base64(const std::string& bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text(base64_size(bytes.size()), '=');
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t there = std::min<std::size_t>(3, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t j = 0; j < 3; ++j)
      group = group << 8 | (j < there ? static_cast<unsigned char>(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j <= there; ++j) text[i / 3 * 4 + j] = digits[group >> (18 - 6 * j) & 63];
  }
  return text;
}

template <class T>
nlohmann::json PageArrays::store(const T* values, std::size_t count, const char* type) {
  nlohmann::json place = {{"id", fmt::format("a{}", stored_.size())}, {"type", type}, {"size", count}};
  stored_.push_back(base64(deflated(byte_planes(values, count))));
  bytes_ += stored_.back().size() + bytes_around;
  return place;
}

std::size_t PageArrays::most_bytes(Eigen::Index values, std::size_t width) {
  return base64_size(compressBound(static_cast<uLong>(values) * width)) + bytes_around;
}

nlohmann::json PageArrays::add(const Eigen::Ref<const Eigen::VectorXd>& values) {
  const Eigen::VectorXf rounded = values.cast<float>();
  return store(rounded.data(), static_cast<std::size_t>(rounded.size()), "f4");
}

nlohmann::json PageArrays::add_exact(const Eigen::Ref<const Eigen::VectorXd>& values) {
  return store(values.data(), static_cast<std::size_t>(values.size()), "f8");
}

nlohmann::json PageArrays::add_shares(const Eigen::Ref<const Eigen::VectorXd>& values) {
  constexpr double whole = 65534.0;
  constexpr std::uint16_t unknown = 65535;
  std::vector<std::uint16_t> steps(static_cast<std::size_t>(values.size()));
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double share = values(static_cast<Eigen::Index>(i));
    steps[i] =
        std::isnan(share) ? unknown : static_cast<std::uint16_t>(std::lround(whole * std::clamp(share, 0.0, 1.0)));
  }
  return store(steps.data(), steps.size(), "share");
}

nlohmann::json PageArrays::add(const std::vector<std::int32_t>& values) {
  return store(values.data(), values.size(), "i4");
}

}  // namespace modebank::app::report

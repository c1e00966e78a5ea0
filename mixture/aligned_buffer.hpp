#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

namespace modebank {

/// Doubles aligned to 64 bytes, the widest vector; zero at first unless made `unset`.
class AlignedBuffer {
 public:
  AlignedBuffer() = default;
  explicit AlignedBuffer(std::ptrdiff_t size) : AlignedBuffer(unset(size)) { std::fill_n(data_.get(), size, 0.0); }
  static AlignedBuffer unset(std::ptrdiff_t size) {
    AlignedBuffer result;
    result.data_.reset(
        static_cast<double*>(::operator new(static_cast<std::size_t>(size) * sizeof(double), alignment)));
    return result;
  }
  double* data() { return data_.get(); }
  const double* data() const { return data_.get(); }

 private:
  static constexpr std::align_val_t alignment{64};
  struct Delete {
    void operator()(double* data) const { ::operator delete(data, alignment); }
  };
  std::unique_ptr<double, Delete> data_;
};

}  // namespace modebank

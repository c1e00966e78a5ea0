#pragma once

#include <pybind11/pybind11.h>

#include <chrono>

#include "ident/base/interruption.hpp"

namespace modebank::python {

/// Releases the interpreter's lock. Ctrl-C ends the computation with KeyboardInterrupt, or with the exception of the
/// signal's handler.
class Unlocked {
 public:
  Unlocked() : hook_([this] { look(); }) {}

 private:
  /// Takes the lock and checks for signals. This happens so rarely that it costs no time.
  void look() {
    using std::chrono::steady_clock;
    constexpr std::chrono::milliseconds pause(50);
    if (steady_clock::now() - looked_ < pause) return;
    looked_ = steady_clock::now();
    const pybind11::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
  }

  std::chrono::steady_clock::time_point looked_ = std::chrono::steady_clock::now();
  pybind11::gil_scoped_release unlocked_;
  Interruptible hook_;
};

}  // namespace modebank::python

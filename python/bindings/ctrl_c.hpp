#pragma once

#include <pybind11/pybind11.h>

#include <chrono>

#include "ident/base/interruption.hpp"

namespace modebank::python {

/// Releases the interpreter's lock, and lets Ctrl-C end the computation: it throws KeyboardInterrupt, or the exception
/// of the signal's handler.
class Unlocked {
 public:
  Unlocked() : hook_([this] { look(); }) {}

 private:
  /// Takes the lock to check for signals; rarely enough to cost no time.
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

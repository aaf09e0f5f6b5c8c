#pragma once
/// How a long piece of work talks to its host while it goes on, and how the host stops this one run.

#include <functional>
#include <string>

#include "pellicle/base/errors.h"

namespace pellicle {

/// A value that is handed down by reference; every member may be empty. Members are called from the thread that began
/// the work unless a function says otherwise.
struct Observer {
  /// The fraction that is done, 0..1, and what is going on.
  std::function<void(double fraction, const std::string& what)> progress = {};
  std::function<void(const std::string&message)> inform = {}, warn = {};
  /// Asked between steps, from any thread: true ends the run with Interrupted.
  std::function<bool()> stopped = {};

  void tell_progress(double fraction, const std::string& what) const {
    if (progress) progress(fraction, what);
  }
  void tell(const std::string& message) const {
    if (inform) inform(message);
  }
  void tell_warning(const std::string& message) const {
    if (warn) warn(message);
  }
  /// \throws Interrupted when the host wants this run to end.
  void check_stopped() const {
    if (stopped && stopped()) throw Interrupted();
  }
  /// The same host; fractions 0..1 of a part of the work become `from`..`to` of the whole.
  Observer part(double from, double to) const {
    Observer inner = *this;
    if (progress) {
      inner.progress = [outer = progress, from, to](double fraction, const std::string& what) {
        outer(from + fraction * (to - from), what);
      };
    }
    return inner;
  }
};

}  // namespace pellicle

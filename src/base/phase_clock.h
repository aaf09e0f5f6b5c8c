#pragma once
/// Wall time of the named phases of a piece of work.

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace pellicle {

/// Seconds of each phase, in order of first use.
using PhaseSeconds = std::vector<std::pair<std::string, double>>;

class PhaseClock {
 public:
  /// Ends the phase that runs and starts `name` (empty: none). A name may return: its times add up.
  void start(const std::string& name);
  void stop() { start(""); }
  /// Adds times that were measured elsewhere, after those that are known.
  void add(const PhaseSeconds& phases);
  const PhaseSeconds& seconds() const { return seconds_; }

 private:
  double& seconds_of(const std::string& name);

  PhaseSeconds seconds_;
  std::string running_;
  std::chrono::steady_clock::time_point since_;
};

}  // namespace pellicle

#pragma once
/// Where a result came from and what it cost.

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace pellicle {

/// Program and library versions, by name.
std::string program_version();
std::vector<std::pair<std::string, std::string>> library_versions();

/// Largest resident size of the process so far, bytes.
long peak_memory_bytes();
/// Now, UTC, "2026-01-31T12:34:56Z".
std::string utc_time();

/// Wall time of named phases, in order of first use.
class PhaseClock {
 public:
  /// Ends the phase that runs and starts `name` (empty: none). A name may return: its times add up.
  void start(const std::string& name);
  void stop() { start(""); }
  const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }

 private:
  std::vector<std::pair<std::string, double>> seconds_;
  std::string running_;
  std::chrono::steady_clock::time_point since_;
};

}  // namespace pellicle

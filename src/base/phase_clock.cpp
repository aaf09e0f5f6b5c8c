#include "pellicle/base/phase_clock.h"

#include <algorithm>

namespace pellicle {

double& PhaseClock::seconds_of(const std::string& name) {
  auto known = std::find_if(seconds_.begin(), seconds_.end(), [&](const auto& phase) { return phase.first == name; });
  if (known == seconds_.end()) known = seconds_.emplace(seconds_.end(), name, 0.0);
  return known->second;
}

void PhaseClock::start(const std::string& name) {
  const auto now = std::chrono::steady_clock::now();
  if (!running_.empty()) seconds_of(running_) += std::chrono::duration<double>(now - since_).count();
  running_ = name;
  since_ = now;
  if (!name.empty()) seconds_of(name);
}

void PhaseClock::add(const PhaseSeconds& phases) {
  for (const auto& [name, seconds] : phases) seconds_of(name) += seconds;
}

}  // namespace pellicle

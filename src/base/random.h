#pragma once
/// Seeded random numbers that are the same on every platform (the standard's distributions are not).

#include <cstdint>

namespace pellicle {

/// SplitMix64 (Steele, Lea, Flood 2014): one 64-bit state, good enough for noise and for drawing seeds. Passed by
/// reference to everything that draws: there is no global engine.
class RandomEngine {
 public:
  explicit RandomEngine(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  double uniform();                      ///< in [0, 1)
  double uniform(double lo, double hi);  ///< in [lo, hi)
  double normal();                       ///< mean 0, variance 1 (Box-Muller)
  std::uint64_t poisson(double mean);    ///< exact below mean 30, rounded normal above

 private:
  std::uint64_t state_;
};

}  // namespace pellicle

#pragma once
/// Mathematical constants.

#include <numbers>

namespace pellicle {

inline constexpr double kPi = std::numbers::pi;

}  // namespace pellicle

#pragma once
#include <numbers>

namespace pellicle {

inline constexpr double kPi = std::numbers::pi;

}  // namespace pellicle

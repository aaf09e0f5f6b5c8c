#pragma once
/// The phantoms that several sections share: every shape in every variant.

#include <array>
#include <string>

#include "pellicle/synthetic/phantom.h"

namespace pellicle::bench {

inline constexpr std::array<const char*, 5> kVariants{"isotropic", "0.5x0.5x1.5 oblique", "dark on bright", "25 % bias",
                                                      "shell"};
inline constexpr std::array<const char*, 6> kShapes{"sphere", "ellipsoid", "superquadric", "blob", "bean", "dumbbell"};

/// Radius about 20 voxels, SNR 5, blur 1 voxel.
PhantomSettings phantom_case(const std::string& shape, std::size_t variant);

}  // namespace pellicle::bench

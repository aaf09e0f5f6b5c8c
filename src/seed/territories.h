#pragma once
/// Which part of the image each of many objects may claim.

#include <cstdint>
#include <vector>

#include "pellicle/image/image.h"

namespace pellicle {

/// Seeded watershed: every voxel goes to the seed that it is reached from over the highest pass of `response`
/// (6 neighbours, highest first, first come first served among 65536 levels). Seed i's voxels hold i + 1.
/// \param seeds LPS mm; the nearest voxel each. Of seeds in one voxel the first has it.
Image<std::int32_t> territories_of(const Image<float>& response, const std::vector<Vec3>& seeds);

}  // namespace pellicle

#pragma once
/// The indicator function of a solid from points of its surface, by Gauss's formula.

#include <cstdint>
#include <vector>

#include "pellicle/image/image.h"

namespace pellicle {

/// The indicator of a solid is the sum over its surface of K(x, y) . dA(y), K(x, y) = (y - x) / (4 pi |y - x|^3). Each
/// point stands for one vector dA; the shortest such vectors that give one half at every point are taken, lightly
/// regularised. Neither normals nor an enclosing grid are needed: sheets may lie as near to each other as their points
/// do. (Lin, Xiao, Shi, Wang 2022, Surface reconstruction from point clouds without normals by parametrizing the Gauss
/// formula, ACM Transactions on Graphics 42(2).)
/// \param points three or more; time grows with the third power, memory
/// with the second (108 MB for 3000).
/// \param spacing typical distance between neighbours, mm: within twice this the
/// kernel is smooth.
/// \param grid where it is wanted.
/// \return about 1 inside, 0 outside, one half at the surface. All 0 when the
/// equations have no solution.
Image<float> gauss_field(const std::vector<Vec3>& points, double spacing, const ImageGrid& grid);

}  // namespace pellicle

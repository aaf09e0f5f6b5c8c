#include "pellicle/energies/flux.h"

#include <algorithm>
#include <cmath>

#include "pellicle/base/parallel.h"

namespace pellicle {

double flux(const std::array<CubicField, 3>& gradient, double scale, const std::vector<Vec3>& x,
            const std::vector<Vec3>& area_vector, std::vector<Vec3>& dE_dx, std::vector<Vec3>& dE_da) {
  std::vector<double> part(x.size());
  parallel_for(x.size(), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec3 field;
      for (std::size_t c = 0; c < 3; ++c) {
        Vec3 derivative;
        field[static_cast<int>(c)] = gradient[c].value(x[i], derivative);
        dE_dx[i] += scale * area_vector[i][static_cast<int>(c)] * derivative;
      }
      dE_da[i] += scale * field;
      part[i] = field.dot(area_vector[i]);
    }
  });
  double energy = 0.0;
  for (const double p : part) energy += p;
  return scale * energy;
}

std::array<Image<float>, 3> gradient_images(const Image<float>& image) {
  const ImageGrid& grid = image.grid;
  std::array<Image<float>, 3> out{Image<float>(grid), Image<float>(grid), Image<float>(grid)};
  const Mat3 to_world = grid.index_from_world_matrix().transpose();
  parallel_for(static_cast<std::size_t>(grid.size[2]), 1, [&](std::size_t begin, std::size_t end) {
    for (int k = static_cast<int>(begin); k < static_cast<int>(end); ++k) {
      for (int j = 0; j < grid.size[1]; ++j) {
        for (int i = 0; i < grid.size[0]; ++i) {
          const Index3 at{i, j, k};
          Vec3 by_index;
          for (std::size_t a = 0; a < 3; ++a) {
            Index3 low = at, high = at;
            low[a] = std::max(0, at[a] - 1);
            high[a] = std::min(grid.size[a] - 1, at[a] + 1);
            const double rise = image.at(high[0], high[1], high[2]) - image.at(low[0], low[1], low[2]);
            by_index[static_cast<int>(a)] = high[a] > low[a] ? rise / (high[a] - low[a]) : 0.0;
          }
          const Vec3 g = to_world * by_index;
          for (std::size_t a = 0; a < 3; ++a) out[a].at(i, j, k) = static_cast<float>(g[static_cast<int>(a)]);
        }
      }
    }
  });
  return out;
}

Image<float> flux_antiderivative(const Image<float>& image) {
  const ImageGrid& grid = image.grid;
  const Index3& size = grid.size;
  Image<float> out(grid);
  const double h = grid.spacing[0];
  parallel_for(static_cast<std::size_t>(size[2]), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<double> across(static_cast<std::size_t>(size[0]));
    for (int k = static_cast<int>(begin); k < static_cast<int>(end); ++k) {
      const int below = std::max(0, k - 1), above = std::min(size[2] - 1, k + 1);
      for (int j = 0; j < size[1]; ++j) {
        const int left = std::max(0, j - 1), right = std::min(size[1] - 1, j + 1);
        for (int i = 0; i < size[0]; ++i) {
          const double here = 2.0 * image.at(i, j, k);
          across[static_cast<std::size_t>(i)] =
              (image.at(i, left, k) - here + image.at(i, right, k)) / (grid.spacing[1] * grid.spacing[1]) +
              (image.at(i, j, below) - here + image.at(i, j, above)) / (grid.spacing[2] * grid.spacing[2]);
        }
        double sum = 0.0;
        for (int i = 0; i < size[0]; ++i) {
          const auto at = static_cast<std::size_t>(i);
          if (i > 0) sum += 0.5 * h * (across[at - 1] + across[at]);
          const int low = std::max(0, i - 1), high = std::min(size[0] - 1, i + 1);
          const double rise = image.at(high, j, k) - image.at(low, j, k);
          const double slope = high > low ? rise / ((high - low) * h) : 0.0;
          out.at(i, j, k) = static_cast<float>(slope + sum);
        }
      }
    }
  });
  return out;
}

TermOutput FluxTerm::operator()(const StepView& step) {
  if (!gradient || version != step.image_version) {
    version = step.image_version;
    gradient = std::make_shared<const std::array<Image<float>, 3>>(gradient_images(*step.image));
  }
  const double contrast = std::abs(step.levels.contrast());
  const double scale = step.weight * step.hypothesis.sign * step.h * step.h *
                       std::max(step.smoothing_mm, 0.5 * step.h) / (contrast * step.surface.total_area);
  return {[kept = gradient, scale](const auto& x, const auto& area, auto& dx, auto& da) {
    const std::array<CubicField, 3> fields{CubicField((*kept)[0]), CubicField((*kept)[1]), CubicField((*kept)[2])};
    return flux(fields, scale, x, area, dx, da);
  }};
}

}  // namespace pellicle

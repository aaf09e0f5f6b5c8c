#include "pellicle/image/resample.h"

#include <algorithm>
#include <cmath>

#include "pellicle/base/parallel.h"

namespace pellicle {

IndexBox box_around(const ImageGrid& grid, const Vec3& lo_in_world, const Vec3& hi_in_world, double margin_mm) {
  Vec3 lo = Vec3::Constant(1e300), hi = Vec3::Constant(-1e300);
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 x;
    for (int a = 0; a < 3; ++a) x[a] = (corner >> a & 1) != 0 ? hi_in_world[a] + margin_mm : lo_in_world[a] - margin_mm;
    const Vec3 i = grid.index_from_world(x);
    lo = lo.cwiseMin(i);
    hi = hi.cwiseMax(i);
  }
  IndexBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    const double last = grid.size[a] - 1;
    const int first = static_cast<int>(std::clamp(std::floor(lo[axis]), 0.0, last));
    box.begin[a] = first;
    box.size[a] = static_cast<int>(std::clamp(std::ceil(hi[axis]), static_cast<double>(first), last)) - first + 1;
  }
  return box;
}

Index3 bin_factors(const ImageGrid& grid, double spacing_mm) {
  Index3 factor{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double ratio = spacing_mm / grid.spacing[static_cast<int>(a)];
    factor[a] = std::clamp(static_cast<int>(std::lround(std::min(ratio, 1e6))), 1, std::max(1, grid.size[a]));
  }
  return factor;
}

Image<float> crop_and_bin(const Image<float>& image, const IndexBox& box, const Index3& factor) {
  const ImageGrid& from = image.grid;
  ImageGrid grid = from;
  Vec3 first_centre;
  for (std::size_t a = 0; a < 3; ++a) {
    grid.size[a] = (box.size[a] + factor[a] - 1) / factor[a];
    grid.spacing[static_cast<int>(a)] = from.spacing[static_cast<int>(a)] * factor[a];
    first_centre[static_cast<int>(a)] = box.begin[a] + 0.5 * (factor[a] - 1);
  }
  grid.origin_in_world = from.world_from_index(first_centre);
  Image<float> out(grid);
  const bool copy = factor == Index3{1, 1, 1};
  parallel_for(static_cast<std::size_t>(grid.size[2]), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<float> row(static_cast<std::size_t>(box.size[0]));
    for (int k = static_cast<int>(begin); k < static_cast<int>(end); ++k) {
      for (int j = 0; j < grid.size[1]; ++j) {
        float* target = &out.at(0, j, k);
        if (copy) {
          const float* source = &image.at(box.begin[0], box.begin[1] + j, box.begin[2] + k);
          std::copy(source, source + grid.size[0], target);
          continue;
        }
        // First the sum of the block's rows, contiguous in memory, then of its columns.
        std::fill(row.begin(), row.end(), 0.0F);
        const int k1 = std::min((k + 1) * factor[2], box.size[2]), j1 = std::min((j + 1) * factor[1], box.size[1]);
        for (int kk = k * factor[2]; kk < k1; ++kk) {
          for (int jj = j * factor[1]; jj < j1; ++jj) {
            const float* source = &image.at(box.begin[0], box.begin[1] + jj, box.begin[2] + kk);
            for (std::size_t ii = 0; ii < row.size(); ++ii) row[ii] += source[ii];
          }
        }
        const int rows = (k1 - k * factor[2]) * (j1 - j * factor[1]);
        for (int i = 0; i < grid.size[0]; ++i) {
          const int first = i * factor[0], last = std::min(first + factor[0], box.size[0]);
          double sum = 0.0;
          for (int ii = first; ii < last; ++ii) sum += static_cast<double>(row[static_cast<std::size_t>(ii)]);
          target[i] = static_cast<float>(sum / (rows * (last - first)));
        }
      }
    }
  });
  return out;
}

namespace {

std::vector<float> gaussian_kernel(double sigma_in_voxels) {
  const int radius = std::max(1, static_cast<int>(std::ceil(3.5 * sigma_in_voxels)));
  std::vector<double> weight(static_cast<std::size_t>(2 * radius + 1));
  double sum = 0.0;
  for (int i = -radius; i <= radius; ++i) {
    // Integral over the voxel, not the value at its centre: right also where sigma is below a voxel.
    const double scale = 1.0 / (std::sqrt(2.0) * sigma_in_voxels);
    sum += weight[static_cast<std::size_t>(i + radius)] =
        0.5 * (std::erf((i + 0.5) * scale) - std::erf((i - 0.5) * scale));
  }
  std::vector<float> kernel(weight.size());
  for (std::size_t i = 0; i < kernel.size(); ++i) kernel[i] = static_cast<float>(weight[i] / sum);
  return kernel;
}

// Lines along x: the line with its ends continued, then one pass over it for each weight.
void smooth_x(Image<float>& image, const std::vector<float>& kernel) {
  const auto n = static_cast<std::size_t>(image.grid.size[0]);
  const std::size_t radius = kernel.size() / 2;
  parallel_for(image.voxels.size() / n, 256, [&](std::size_t begin, std::size_t end) {
    std::vector<float> padded(n + 2 * radius);
    for (std::size_t line = begin; line < end; ++line) {
      float* data = image.voxels.data() + line * n;
      std::fill_n(padded.begin(), radius, data[0]);
      std::copy(data, data + n, padded.begin() + static_cast<std::ptrdiff_t>(radius));
      std::fill_n(padded.begin() + static_cast<std::ptrdiff_t>(radius + n), radius, data[n - 1]);
      std::fill(data, data + n, 0.0F);
      for (std::size_t k = 0; k < kernel.size(); ++k) {
        const float w = kernel[k];
        const float* in = padded.data() + k;
        for (std::size_t i = 0; i < n; ++i) data[i] += w * in[i];
      }
    }
  });
}

// Lines along y or z, one x-row of them side by side, so that the inner loop runs over contiguous memory.
void smooth_yz(Image<float>& image, int axis, const std::vector<float>& kernel) {
  const Index3& size = image.grid.size;
  const int n = size[static_cast<std::size_t>(axis)];
  const int radius = static_cast<int>(kernel.size() / 2);
  const auto width = static_cast<std::size_t>(size[0]);
  const std::size_t step = axis == 1 ? width : width * static_cast<std::size_t>(size[1]);
  parallel_for(static_cast<std::size_t>(size[axis == 1 ? 2 : 1]), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<float> buffer(width * static_cast<std::size_t>(n));
    for (std::size_t line = begin; line < end; ++line) {
      float* data = image.voxels.data() + line * (axis == 1 ? width * static_cast<std::size_t>(n) : width);
      for (int i = 0; i < n; ++i) {
        const float* row = data + static_cast<std::size_t>(i) * step;
        std::copy(row, row + width, buffer.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(i) * width));
      }
      for (int i = 0; i < n; ++i) {
        float* out = data + static_cast<std::size_t>(i) * step;
        std::fill(out, out + width, 0.0F);
        for (int k = -radius; k <= radius; ++k) {
          const float w = kernel[static_cast<std::size_t>(k + radius)];
          const float* in = buffer.data() + static_cast<std::size_t>(std::clamp(i + k, 0, n - 1)) * width;
          for (std::size_t c = 0; c < width; ++c) out[c] += w * in[c];
        }
      }
    }
  });
}

}  // namespace

Image<float> gaussian_smooth(Image<float> image, double sigma_mm) {
  for (int axis = 0; axis < 3; ++axis) {
    const double sigma = sigma_mm / image.grid.spacing[axis];
    if (sigma < 0.2 || image.grid.size[static_cast<std::size_t>(axis)] <= 1) continue;
    if (axis == 0) {
      smooth_x(image, gaussian_kernel(sigma));
    } else {
      smooth_yz(image, axis, gaussian_kernel(sigma));
    }
  }
  return image;
}

double noise_of(const Image<float>& image, const IndexBox& box) {
  std::size_t inner = 1;
  for (const int s : box.size) inner *= static_cast<std::size_t>(std::max(1, s - 2));
  const std::size_t stride = std::max<std::size_t>(1, inner / 100000);
  std::vector<float> deviation;
  std::size_t count = 0;
  for (int k = box.begin[2] + 1; k < box.begin[2] + box.size[2] - 1; ++k) {
    for (int j = box.begin[1] + 1; j < box.begin[1] + box.size[1] - 1; ++j) {
      for (int i = box.begin[0] + 1; i < box.begin[0] + box.size[0] - 1; ++i) {
        if (count++ % stride != 0 || image.at(i, j, k) == 0.0F) continue;
        const float mean = (image.at(i - 1, j, k) + image.at(i + 1, j, k) + image.at(i, j - 1, k) +
                            image.at(i, j + 1, k) + image.at(i, j, k - 1) + image.at(i, j, k + 1)) /
                           6.0F;
        deviation.push_back(std::abs(image.at(i, j, k) - mean));
      }
    }
  }
  if (deviation.empty()) return 0.0;
  const auto middle = deviation.begin() + static_cast<std::ptrdiff_t>(deviation.size() / 2);
  std::nth_element(deviation.begin(), middle, deviation.end());
  return 1.4826 * std::sqrt(6.0 / 7.0) * static_cast<double>(*middle);
}

}  // namespace pellicle

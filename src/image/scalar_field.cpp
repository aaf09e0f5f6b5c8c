#include "pellicle/image/scalar_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pellicle {

TrilinearField::TrilinearField(const Image<float>& image)
    : image_(image), index_from_world_(image.grid.index_from_world_matrix()) {}

namespace {

/// Distances in memory from a voxel to its upper neighbours; 0 along an axis of one voxel.
struct Steps {
  std::size_t dx, dy, dz;
  explicit Steps(const Index3& size)
      : dx(size[0] > 1 ? 1 : 0),
        dy(size[1] > 1 ? static_cast<std::size_t>(size[0]) : 0),
        dz(size[2] > 1 ? static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) : 0) {}
};

float blend(const float* p, const Steps& s, const std::array<float, 3>& f) {
  const auto row = [&](const float* q) { return q[0] + f[0] * (q[s.dx] - q[0]); };
  const float a0 = row(p), a1 = row(p + s.dy), b0 = row(p + s.dz), b1 = row(p + s.dz + s.dy);
  const float a = a0 + f[1] * (a1 - a0), b = b0 + f[1] * (b1 - b0);
  return a + f[2] * (b - a);
}

}  // namespace

float TrilinearField::at_index(const Vec3& i) const {
  const Index3& size = image_.grid.size;
  std::array<int, 3> low{};
  std::array<float, 3> f{};
  for (int a = 0; a < 3; ++a) {
    const int n = size[static_cast<std::size_t>(a)];
    const double v = i[a];
    if (!(v >= -0.5 && v <= n - 0.5)) return std::numeric_limits<float>::quiet_NaN();
    const double c = std::clamp(v, 0.0, static_cast<double>(n - 1));
    const int l = std::min(static_cast<int>(c), std::max(0, n - 2));
    low[static_cast<std::size_t>(a)] = l;
    f[static_cast<std::size_t>(a)] = static_cast<float>(c - l);
  }
  return blend(image_.voxels.data() + image_.grid.offset(low[0], low[1], low[2]), Steps(size), f);
}

float TrilinearField::at(const Vec3& x_in_world) const {
  return at_index(index_from_world_ * (x_in_world - image_.grid.origin_in_world));
}

void TrilinearField::along_line(const Vec3& start_in_world, const Vec3& step_in_world, int count, float* out) const {
  const Vec3 start = index_from_world_ * (start_in_world - image_.grid.origin_in_world);
  const Vec3 step = index_from_world_ * step_in_world;
  const Vec3 end = start + static_cast<double>(count - 1) * step;
  const Index3& size = image_.grid.size;
  bool inside = true;
  for (int a = 0; a < 3; ++a) {
    const double last = size[static_cast<std::size_t>(a)] - 1;
    inside = inside && std::min(start[a], end[a]) >= 0.0 && std::max(start[a], end[a]) < last;
  }
  if (!inside) {
    for (int i = 0; i < count; ++i) out[i] = at_index(start + static_cast<double>(i) * step);
    return;
  }
  // The whole line lies between voxel centres: the same values without a look at the border.
  const Steps steps(size);
  for (int i = 0; i < count; ++i) {
    const Vec3 at = start + static_cast<double>(i) * step;
    const std::array<int, 3> low{static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2])};
    const std::array<float, 3> f{static_cast<float>(at[0] - low[0]), static_cast<float>(at[1] - low[1]),
                                 static_cast<float>(at[2] - low[2])};
    out[i] = blend(image_.voxels.data() + image_.grid.offset(low[0], low[1], low[2]), steps, f);
  }
}

CubicField::CubicField(const Image<float>& image)
    : image_(image), index_from_world_(image.grid.index_from_world_matrix()) {}

namespace {
struct CubicWeights {
  std::array<int, 4> index;
  std::array<double, 4> value, slope;
};

CubicWeights weights_at(double x, int n) {
  CubicWeights w{};
  const double base = std::floor(x);
  const double t = x - base;
  // Clamped far from the image, where the field is constant along the axis anyway.
  const int first = static_cast<int>(std::clamp(base, -4.0, static_cast<double>(n) + 4.0)) - 1;
  for (int i = 0; i < 4; ++i) w.index[static_cast<std::size_t>(i)] = std::clamp(first + i, 0, n - 1);
  w.value = {0.5 * t * (-1 + t * (2 - t)), 1 + t * t * (-2.5 + 1.5 * t), 0.5 * t * (1 + t * (4 - 3 * t)),
             0.5 * t * t * (t - 1)};
  w.slope = {-0.5 + t * (2 - 1.5 * t), t * (-5 + 4.5 * t), 0.5 + t * (4 - 4.5 * t), t * (1.5 * t - 1)};
  return w;
}
}  // namespace

double CubicField::value(const Vec3& x_in_world, Vec3& gradient) const {
  const Vec3 i = index_from_world_ * (x_in_world - image_.grid.origin_in_world);
  const CubicWeights wx = weights_at(i.x(), image_.grid.size[0]);
  const CubicWeights wy = weights_at(i.y(), image_.grid.size[1]);
  const CubicWeights wz = weights_at(i.z(), image_.grid.size[2]);
  double value = 0.0;
  Vec3 d = Vec3::Zero();
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t b = 0; b < 4; ++b) {
      const float* row = &image_.at(0, wy.index[b], wz.index[c]);
      double r = 0.0, s = 0.0;
      for (std::size_t a = 0; a < 4; ++a) {
        r += wx.value[a] * row[wx.index[a]];
        s += wx.slope[a] * row[wx.index[a]];
      }
      value += wz.value[c] * wy.value[b] * r;
      d += Vec3(wz.value[c] * wy.value[b] * s, wz.value[c] * wy.slope[b] * r, wz.slope[c] * wy.value[b] * r);
    }
  }
  gradient = index_from_world_.transpose() * d;
  return value;
}

double CubicField::value(const Vec3& x_in_world) const {
  Vec3 ignored;
  return value(x_in_world, ignored);
}

}  // namespace pellicle

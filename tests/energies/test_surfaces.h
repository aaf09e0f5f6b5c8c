#pragma once
/// Sampled spheres, analytic images and rigid motions that the energy tests share.

#include <ceres/ceres.h>

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "pellicle/base/random.h"
#include "pellicle/energies/sample_view.h"
#include "pellicle/image/image.h"
#include "pellicle/surface/surface.h"

namespace pellicle::test {

inline Vec3 random_vector(RandomEngine& random, double size = 1.0) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

inline Mat3 random_matrix(RandomEngine& random) {
  Mat3 m;
  for (int c = 0; c < 3; ++c) m.col(c) = random_vector(random);
  return m;
}

/// x -> turn x + shift.
struct Motion {
  Mat3 turn = Mat3::Identity();
  Vec3 shift = Vec3::Zero();
  Vec3 operator()(const Vec3& x) const { return turn * x + shift; }
};

inline Motion random_motion(RandomEngine& random) {
  Eigen::Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
  return {q.normalized().toRotationMatrix(), random_vector(random, 40.0)};
}

inline ImageGrid moved(ImageGrid grid, const Motion& motion) {
  grid.origin_in_world = motion(grid.origin_in_world);
  grid.direction = motion.turn * grid.direction;
  return grid;
}

/// An oblique grid of the given spacing whose middle is the world's origin.
inline ImageGrid centred_grid(const Index3& size, const Vec3& spacing, const Mat3& direction = Mat3::Identity()) {
  ImageGrid grid;
  grid.size = size;
  grid.spacing = spacing;
  grid.direction = direction;
  const Vec3 middle(0.5 * (size[0] - 1), 0.5 * (size[1] - 1), 0.5 * (size[2] - 1));
  grid.origin_in_world = -(direction * spacing.cwiseProduct(middle));
  return grid;
}

inline Mat3 oblique() {
  return (Eigen::AngleAxisd(0.4, Vec3::UnitX()) * Eigen::AngleAxisd(-0.3, Vec3::UnitY()) *
          Eigen::AngleAxisd(0.7, Vec3::UnitZ()))
      .toRotationMatrix();
}

inline Image<float> image_of(const ImageGrid& grid, const std::function<double(const Vec3&)>& f) {
  Image<float> image(grid);
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        image.at(i, j, k) = static_cast<float>(f(grid.world_from_index(Vec3(i, j, k))));
      }
    }
  }
  return image;
}

/// Samples on a surface of the icosahedron's or tetrahedron's mesh.
struct Samples {
  SampleLayout layout;
  std::vector<Vec3> x, normal;
  /// What energies take; refers to the layout.
  SampledSurface surface(const SampleGraph* graph = nullptr) const { return {layout, {x, normal, {}}, graph}; }
};

inline Samples sphere_samples(int level, double radius, const Vec3& centre = Vec3::Zero(),
                              StartSolid solid = StartSolid::icosahedron) {
  Samples s;
  s.layout = NormalModel::start(solid, SubdivisionRule::smooth).layout(level);
  for (const Vec3& p : s.layout.reference) {
    s.normal.push_back(p.normalized());
    s.x.push_back(centre + radius * s.normal.back());
  }
  return s;
}

/// A sphere whose samples were all moved at random: no symmetry left that could hide a fault.
inline Samples crumpled_sphere(int level, double radius, double amplitude, RandomEngine& random) {
  Samples s = sphere_samples(level, radius, random_vector(random), StartSolid::tetrahedron);
  for (Vec3& p : s.x) p += random_vector(random, amplitude);
  return s;
}

/// Convolution of the ball of radius R with a Gaussian of standard deviation s, at the distance r from its centre.
inline double blurred_ball(double r, double R, double s) {
  const double w = std::sqrt(2.0) * s;
  const double two_pi = 6.283185307179586;
  const double head = 0.5 * (std::erf((R - r) / w) + std::erf((R + r) / w));
  if (r < 1e-6 * R) return std::erf(R / w) - 2.0 * R / (s * std::sqrt(two_pi)) * std::exp(-R * R / (w * w));
  const double near = std::exp(-(R - r) * (R - r) / (w * w)), far = std::exp(-(R + r) * (R + r) / (w * w));
  return head - s / (r * std::sqrt(two_pi)) * (near - far);
}

/// A scalar energy of samples and area vectors as a Ceres cost function of all sample coordinates, for GradientChecker.
class ScalarEnergyCost final : public ceres::CostFunction {
 public:
  using Energy = std::function<double(const std::vector<Vec3>& x, const std::vector<Vec3>& area_vector,
                                      std::vector<Vec3>& dE_dx, std::vector<Vec3>& dE_da)>;
  ScalarEnergyCost(const SampleLayout& layout, Energy energy) : layout_(layout), energy_(std::move(energy)) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(3 * layout.sample_count());
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const auto n = static_cast<std::size_t>(layout_.sample_count());
    std::vector<Vec3> x(n), dx(n, Vec3::Zero()), da(n, Vec3::Zero());
    for (std::size_t i = 0; i < n; ++i) x[i] = Eigen::Map<const Vec3>(parameters[0] + 3 * i);
    residuals[0] = energy_(x, area_vectors(layout_, x), dx, da);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    pull_back_area_vectors(layout_, x, da, dx);
    for (std::size_t i = 0; i < n; ++i) Eigen::Map<Vec3>(jacobians[0] + 3 * i) = dx[i];
    return true;
  }

 private:
  const SampleLayout& layout_;
  Energy energy_;
};

/// Empty when the derivative is that of the value to `tolerance`, relative to the largest entry; else Ceres' report.
inline std::string gradient_fault(const Samples& s, ScalarEnergyCost::Energy energy, double tolerance) {
  const ScalarEnergyCost cost(s.layout, std::move(energy));
  std::vector<double> flat;
  for (const Vec3& p : s.x) flat.insert(flat.end(), p.data(), p.data() + 3);
  double* block = flat.data();
  // The step is relative to the coordinate (about 10 mm): well inside a voxel, well above rounding.
  ceres::NumericDiffOptions options;
  options.relative_step_size = 1e-4;
  options.ridders_relative_initial_step_size = 1e-3;
  const std::vector<const ceres::Manifold*> no_manifolds(1, nullptr);
  const ceres::GradientChecker checker(&cost, &no_manifolds, options);
  ceres::GradientChecker::ProbeResults results;
  checker.Probe(&block, 1.0, &results);
  if (results.jacobians.empty()) return results.error_log.empty() ? "no Jacobian" : results.error_log;
  const auto& analytic = results.jacobians[0];
  const auto& numeric = results.numeric_jacobians[0];
  const double size = numeric.cwiseAbs().maxCoeff(), error = (analytic - numeric).cwiseAbs().maxCoeff();
  if (size > 0.0 && error <= tolerance * size) return {};
  return "largest derivative " + std::to_string(size) + ", largest error relative to it " +
         std::to_string(error / size);
}

/// Half the sum of squares of linear rows: the energy they stand for.
template <class Rows>
double energy_of(const Rows& rows, const std::vector<Vec3>& x) {
  double total = 0.0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if constexpr (requires { rows.residual(r, x).squaredNorm(); }) {
      total += rows.residual(r, x).squaredNorm();
    } else {
      total += rows.residual(r, x) * rows.residual(r, x);
    }
  }
  return 0.5 * total;
}

}  // namespace pellicle::test

#include "pellicle/fit/expert_points.h"

#include <algorithm>
#include <cmath>

#include "pellicle/energies/energy_kinds.h"
#include "pellicle/fit/stage.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

namespace {

constexpr std::size_t kEnough = 12;

}  // namespace

PointDistances distances_to(const ExpertPoints& points, const Surface& surface, double h) {
  const ClosestPoint nearest(tessellate(surface, std::max(3, tessellation_level(surface, 0.5 * h))));
  std::vector<double> distances;
  distances.reserve(points.points.size());
  for (const Vec3& y : points.points) distances.push_back(nearest.query(y).distance);
  return summary_of(points, distances);
}

std::optional<Surface> ellipsoid_of(const ExpertPoints& points, const ModelChoice& model, double h) {
  std::size_t count = 0;
  double total = 0.0;
  Vec3 mean = Vec3::Zero();
  for (std::size_t k = 0; k < points.points.size(); ++k) {
    const double w = points.weight(k);
    count += w > 0.0 ? 1 : 0;
    total += w;
    mean += w * points.points[k];
  }
  if (count < kEnough) return std::nullopt;
  mean /= total;
  Mat3 moments = Mat3::Zero();
  for (std::size_t k = 0; k < points.points.size(); ++k) {
    const Vec3 r = points.points[k] - mean;
    moments += points.weight(k) / total * r * r.transpose();
  }
  // On an ellipsoid with half axes a, the image of the evenly covered unit sphere, the moments are a^2/3.
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(3.0 * moments);
  const Vec3 half_axes = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  if (!(half_axes[0] > std::max(h, 0.05 * half_axes[2]))) return std::nullopt;
  const SurfaceModel start = start_model(model);
  const Mat3 shape = axes.eigenvectors() * half_axes.asDiagonal() * axes.eigenvectors().transpose();
  return Surface{start, on_ellipsoid(start, mean, shape)};
}

std::shared_ptr<const SearchLimit> search_limit_of(const Surface& drawn, const ExpertPoints& points, double h) {
  const TriangleMesh mesh = tessellate(drawn, std::max(3, tessellation_level(drawn, h)));
  const auto count = static_cast<double>(std::max<std::size_t>(1, points.points.size()));
  return std::make_shared<const SearchLimit>(mesh, std::max(3.0 * h, 0.5 * std::sqrt(area_of(mesh) / count)));
}

Surface drawn_to_points(const Image<float>& image, const Surface& start, const ExpertPoints& points,
                        const std::vector<Stage>& stages, const Observer& observer) {
  GeometryCache geometry;
  const StageContext context{image, points, geometry, observer};
  Candidate candidate{.surface = start, .detail = refinements_of(start.model)};
  for (const Stage& stage : stages) {
    // A start that is finer than a stage is drawn by the later ones, by the last one at least.
    if (stage.detail < std::min(candidate.detail, stages.back().detail)) continue;
    Surface before = candidate.surface;
    run_stage(context, {stage}, candidate);
    if (candidate.status != FitStatus::ok) return before;
  }
  return candidate.surface;
}

}  // namespace pellicle

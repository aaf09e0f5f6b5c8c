#include "pellicle/fit/expert_points.h"

#include <algorithm>
#include <cmath>

#include "pellicle/base/random.h"
#include "pellicle/energies/profiles.h"
#include "pellicle/energies/springs.h"
#include "pellicle/fit/stage.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

namespace {

constexpr std::size_t kEnough = 12;

double weight_at(const ExpertPoints& points, std::size_t k) {
  return points.weights.empty() ? 1.0 : points.weights[k];
}

PointDistances summary_of(const ExpertPoints& points, const std::vector<double>& distances) {
  PointDistances out;
  double squares = 0.0;
  for (std::size_t k = 0; k < distances.size(); ++k) {
    if (!(weight_at(points, k) > 0.0)) continue;
    ++out.count;
    squares += distances[k] * distances[k];
    out.max_mm = std::max(out.max_mm, distances[k]);
  }
  if (out.count > 0) out.rms_mm = std::sqrt(squares / static_cast<double>(out.count));
  return out;
}

}  // namespace

ExpertRows expert_rows(const ExpertPoints& points, const SampleLayout& layout, const SurfaceSamples& samples,
                       double weight, double h, bool hold_out) {
  const std::vector<Attachment> attachments = attach(points.points, layout, samples);
  std::vector<double> size, weights;
  size.reserve(attachments.size());
  for (const Attachment& a : attachments) size.push_back(a.distance);
  ExpertRows out;
  out.distances = summary_of(points, size);
  const std::vector<double> sound = huber_weights(size, 3.0, 2.0 / 3.0 * h);
  double total = 0.0, squares = 0.0, left_out = 0.0;
  weights.reserve(size.size());
  for (std::size_t k = 0; k < size.size(); ++k) {
    const double w = weight_at(points, k), robust = w * sound[k];
    if (hold_out && RandomEngine(k).next() % 4 == 0) {
      squares += robust * size[k] * size[k];
      left_out += w;
      weights.push_back(0.0);
    } else {
      total += w;
      weights.push_back(robust);
    }
  }
  if (left_out > 0.0) out.held_out = squares / left_out;
  out.rows = {"springs",
              spring_rows(layout, points.points, attachments, weights, total, points.held ? 1.0 : 0.0, weight)};
  return out;
}

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
    const double w = weight_at(points, k);
    count += w > 0.0 ? 1 : 0;
    total += w;
    mean += w * points.points[k];
  }
  if (count < kEnough) return std::nullopt;
  mean /= total;
  Mat3 moments = Mat3::Zero();
  for (std::size_t k = 0; k < points.points.size(); ++k) {
    const Vec3 r = points.points[k] - mean;
    moments += weight_at(points, k) / total * r * r.transpose();
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

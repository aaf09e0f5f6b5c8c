#include "pellicle/energies/springs.h"

#include <algorithm>
#include <cmath>

#include "pellicle/base/parallel.h"
#include "pellicle/energies/geometry.h"
#include "pellicle/energies/profiles.h"
#include "pellicle/mesh/points/point_tree.h"

namespace pellicle {

namespace {

// By areas in the triangle's own plane; a corner where it has none.
Vec3 barycentric_of(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double n2 = n.squaredNorm();
  if (!(n2 > 0.0)) return {1.0, 0.0, 0.0};
  const double u = (b - x).cross(c - x).dot(n) / n2, v = (c - x).cross(a - x).dot(n) / n2;
  const Vec3 w = Vec3(u, v, 1.0 - u - v).cwiseMax(0.0);
  return w / w.sum();
}

Attachment attachment_at(const Vec3& y, const ClosestPoint::Hit& hit, const SampleView& samples) {
  Attachment out;
  if (hit.triangle < 0) return out;
  out.triangle = hit.triangle;
  const auto& t = samples.layout.triangles[static_cast<std::size_t>(hit.triangle)];
  const auto at = [&](int i) { return static_cast<std::size_t>(t[static_cast<std::size_t>(i)]); };
  out.barycentric = barycentric_of(hit.point, samples.x[at(0)], samples.x[at(1)], samples.x[at(2)]);
  Vec3 mean = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vec3& n = samples.normal[at(i)];
    mean += out.barycentric[i] * n;
    out.lift += 0.5 * out.barycentric[i] * n.dot(samples.x[at(i)] - hit.point) * n;
  }
  const double length = mean.norm();
  const Vec3 facet = (samples.x[at(1)] - samples.x[at(0)]).cross(samples.x[at(2)] - samples.x[at(0)]);
  out.normal = length > 1e-6 ? Vec3(mean / length) : Vec3(facet.normalized());
  // Where normals of a facet disagree wildly the parabola means nothing.
  if (!(length > 0.7)) out.lift.setZero();
  const Vec3 r = y - hit.point - out.lift;
  out.offset = out.normal.dot(r);
  out.distance = r.norm();
  return out;
}

}  // namespace

std::vector<Attachment> attach(const std::vector<Vec3>& points, const SampleView& surface) {
  const ClosestPoint nearest(mesh_of(surface));
  std::vector<Attachment> out(points.size());
  parallel_for(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      out[k] = attachment_at(points[k], nearest.query(points[k]), surface);
    }
  });
  return out;
}

ScalarRows spring_rows(const SampleLayout& layout, const std::vector<Vec3>& points,
                       const std::vector<Attachment>& attachments, const std::vector<double>& weights, double total,
                       double sliding_fraction, double energy_weight) {
  ScalarRows rows;
  if (!(total > 0.0)) return rows;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Attachment& a = attachments[k];
    const double w = weights.empty() ? 1.0 : weights[k];
    if (a.triangle < 0 || !(w > 0.0)) continue;
    const double root = std::sqrt(2.0 * energy_weight * w / total);
    const auto& t = layout.triangles[static_cast<std::size_t>(a.triangle)];
    const auto add = [&](const Vec3& direction, double scale) {
      for (int i = 0; i < 3; ++i) {
        if (a.barycentric[i] > 0.0) rows.add(t[static_cast<std::size_t>(i)], scale * a.barycentric[i] * direction);
      }
      rows.close(scale * direction.dot(points[k] - a.lift));
    };
    add(a.normal, root);
    if (sliding_fraction > 0.0) {
      const Vec3 t1 = a.normal.unitOrthogonal(), t2 = a.normal.cross(t1);
      const double sliding = root * std::sqrt(sliding_fraction);
      add(t1, sliding);
      add(t2, sliding);
    }
  }
  return rows;
}

ScalarRows reverse_spring_rows(const SampleView& surface, const ClosestPoint& data,
                               const std::vector<Vec3>& data_normals, double reach, double energy_weight) {
  std::vector<ClosestPoint::Hit> hits(surface.x.size());
  parallel_for(hits.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) hits[i] = data.query(surface.x[i], reach);
  });
  ScalarRows rows;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const ClosestPoint::Hit& hit = hits[i];
    if (hit.triangle < 0) continue;
    Vec3 m = surface.x[i] - hit.point;
    const double distance = m.norm();
    // On the surface itself the direction of the distance is lost: its normal stands for it.
    const Vec3& n = surface.normal[i];
    m = distance > 1e-9 * reach ? Vec3(m / distance) : n;
    if (!data_normals.empty() && data_normals[static_cast<std::size_t>(hit.triangle)].dot(n) < 0.0) continue;
    const double root = std::sqrt(2.0 * energy_weight * surface.area[i] / surface.total_area);
    rows.add(static_cast<int>(i), root * m);
    rows.close(root * m.dot(hit.point));
  }
  return rows;
}

ScalarRows overshoot_rows(const SampleView& surface, const PointTree& points, double reach, double energy_weight) {
  constexpr double kAlong = 0.7;  // across a hole the way to its rim is none along the normal
  std::vector<PointTree::Neighbour> nearest(surface.x.size());
  parallel_for(nearest.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) nearest[i] = points.nearest(surface.x[i], 1).front();
  });
  ScalarRows rows;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const double distance = nearest[i].distance;
    const Vec3 &x = surface.x[i], &p = points.points()[static_cast<std::size_t>(nearest[i].point)];
    if (distance <= reach || std::abs(surface.normal[i].dot(x - p)) < kAlong * distance) continue;
    const Vec3 n = std::sqrt(2.0 * energy_weight * surface.area[i] / surface.total_area) * surface.normal[i];
    rows.add(static_cast<int>(i), n);
    rows.close(n.dot(p));
  }
  return rows;
}

namespace {

/// `weight` of each distance over c, c = `cutoff` robust deviations, each at least `floor`.
template <class Weight>
std::vector<double> robust_weights(const std::vector<double>& distances, double cutoff, double floor, Weight weight) {
  std::vector<double> weights;
  weights.reserve(distances.size());
  for (const double d : distances) weights.push_back(std::abs(d));
  const double c = cutoff * std::max(floor, 1.4826 * median_of(weights));
  for (double& w : weights) w = weight(w / c);
  return weights;
}

}  // namespace

std::vector<double> tukey_weights(const std::vector<double>& distances, double cutoff, double floor) {
  return robust_weights(distances, cutoff, floor, [](double r) { return r < 1.0 ? std::pow(1.0 - r * r, 2) : 0.0; });
}

std::vector<double> huber_weights(const std::vector<double>& distances, double cutoff, double floor) {
  return robust_weights(distances, cutoff, floor, [](double r) { return r > 1.0 ? 1.0 / r : 1.0; });
}

ScalarRows sliding_rows(const SampleView& surface, const std::vector<Vec3>& targets, double energy_weight) {
  ScalarRows rows;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const double root = std::sqrt(2.0 * energy_weight * surface.area[i] / surface.total_area);
    const Vec3& n = surface.normal[i];
    const Vec3 t1 = n.unitOrthogonal(), t2 = n.cross(t1);
    for (const Vec3& t : {t1, t2}) {
      rows.add(static_cast<int>(i), root * t);
      rows.close(root * t.dot(targets[i]));
    }
  }
  return rows;
}

ScalarRows target_rows(const std::vector<Vec3>& targets, const std::vector<double>& area, double energy_weight) {
  const double total = sum(area);
  ScalarRows rows;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const double root = std::sqrt(2.0 * energy_weight * area[i] / total);
    if (!(root > 0.0)) continue;
    for (int c = 0; c < 3; ++c) {
      rows.add(static_cast<int>(i), root * Vec3::Unit(c));
      rows.close(root * targets[i][c]);
    }
  }
  return rows;
}

PointDistances summary_of(const ExpertPoints& points, const std::vector<double>& distances) {
  PointDistances out;
  double squares = 0.0;
  for (std::size_t k = 0; k < distances.size(); ++k) {
    if (!(points.weight(k) > 0.0)) continue;
    ++out.count;
    squares += distances[k] * distances[k];
    out.max_mm = std::max(out.max_mm, distances[k]);
  }
  if (out.count > 0) out.rms_mm = std::sqrt(squares / static_cast<double>(out.count));
  return out;
}

PointTargets point_targets(const ExpertPoints& points, const SampleView& surface, double h) {
  PointTargets out{.points = &points, .at = attach(points.points, surface)};
  out.sliding_fraction = points.held ? 1.0 : 0.0;
  std::vector<double> distances;
  distances.reserve(out.at.size());
  for (const Attachment& a : out.at) distances.push_back(a.distance);
  const std::vector<double> sound = huber_weights(distances, 3.0, 2.0 / 3.0 * h);
  for (std::size_t k = 0; k < distances.size(); ++k) {
    out.given.push_back(points.weight(k));
    out.robust.push_back(points.weight(k) * sound[k]);
  }
  return out;
}

TermOutput SpringsTerm::operator()(const StepView& step) const {
  if (step.points == nullptr || step.points->points.empty()) return {};
  return {point_targets(*step.points, step.surface, step.h)};
}

}  // namespace pellicle

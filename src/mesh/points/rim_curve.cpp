#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "pellicle/mesh/points/rim.h"

namespace pellicle {

namespace {

constexpr int kSamples = 768;        ///< of a curve
constexpr int kFewestPoints = 12;    ///< of a rim: fewer do not determine a curve
constexpr int kPointsAControl = 4;   ///< or more
constexpr int kSteps = 8;            ///< of attaching anew, a number of control points
constexpr double kInside = 0.05;     ///< weight of points that lie inside of the curve
constexpr double kDamping = 0.05;    ///< where no point is, a step leaves the curve as it was
constexpr double kStiffness = 1e-3;  ///< second differences of the control points, where no point is

/// Weights of four control points, the first of number floor(u) (periodic), at u of a uniform cubic B-spline.
std::array<double, 4> cubic_weights(double t) {
  const double r = 1.0 - t;
  return {r * r * r / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
          (-3.0 * t * t * t + 3.0 * t * t + 3.0 * t + 1.0) / 6.0, t * t * t / 6.0};
}

struct Attached {
  std::vector<int> sample;
  std::vector<double> beyond;    ///< mm, along the point's outward direction
  std::vector<double> distance;  ///< mm
};

Attached attached(const std::vector<Vec3>& curve, const RimPoints& rim) {
  const PointTree tree(curve);
  Attached out;
  for (std::size_t k = 0; k < rim.x.size(); ++k) {
    const auto near = tree.nearest(rim.x[k], 1).front();
    out.sample.push_back(near.point);
    out.distance.push_back(near.distance);
    out.beyond.push_back(rim.outward[k].dot(rim.x[k] - curve[idx(near.point)]));
  }
  return out;
}

/// Through the middle of the points, far ones counting less (Huber); along the outermost, without far ones (Tukey).
enum class Run { through, along_outermost };

std::vector<double> weights_of(const Attached& at, Run run) {
  constexpr double kPlausible = 2.0, kCutoff = 5.0;  // robust deviations
  std::vector<double> sorted = at.distance;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double deviation = std::max(1.4826 * *middle, 1e-300);
  std::vector<double> weights;
  for (std::size_t k = 0; k < at.distance.size(); ++k) {
    const double r = at.distance[k] / deviation, cut = r / kCutoff;
    if (run == Run::through) {
      weights.push_back(r > kPlausible ? kPlausible / r : 1.0);
    } else {
      weights.push_back(cut < 1.0 ? std::pow(1.0 - cut * cut, 2) * (at.beyond[k] > 0.0 ? 1.0 : kInside) : 0.0);
    }
  }
  return weights;
}

std::vector<Vec3> curve_of(const Eigen::MatrixX3d& control) {
  const auto count = control.rows();
  std::vector<Vec3> curve;
  for (int k = 0; k < kSamples; ++k) {
    const double u = static_cast<double>(count) * k / kSamples;
    const auto first = static_cast<Eigen::Index>(u);
    const std::array<double, 4> b = cubic_weights(u - static_cast<double>(first));
    Vec3 x = Vec3::Zero();
    for (int j = 0; j < 4; ++j) x += b[idx(j)] * control.row((first + j) % count).transpose();
    curve.push_back(x);
  }
  return curve;
}

// One step of least squares; the curve's parameter of each point is held.
std::vector<Vec3> step(const std::vector<Vec3>& curve, const RimPoints& rim, int controls, Run run) {
  const Attached at = attached(curve, rim);
  const std::vector<double> weights = weights_of(at, run);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(controls, controls);
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(controls, 3);
  double total = 0.0;
  for (const double w : weights) total += w;
  const auto pull = [&](int sample, const Vec3& to, double weight) {
    const double u = static_cast<double>(controls) * sample / kSamples;
    const int first = static_cast<int>(u);
    const std::array<double, 4> b = cubic_weights(u - first);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        normal((first + i) % controls, (first + j) % controls) += weight * b[idx(i)] * b[idx(j)];
      }
      right.row((first + i) % controls) += weight * b[idx(i)] * to.transpose();
    }
  };
  for (std::size_t k = 0; k < rim.x.size(); ++k) pull(at.sample[k], rim.x[k], weights[k] / total);
  for (int k = 0; k < kSamples; ++k) pull(k, curve[idx(k)], kDamping / kSamples);
  for (int i = 0; i < controls; ++i) {
    const std::array<int, 3> at_i{i, (i + 1) % controls, (i + 2) % controls};
    const std::array<double, 3> d{1.0, -2.0, 1.0};
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) normal(at_i[a], at_i[b]) += kStiffness / controls * d[a] * d[b];
    }
  }
  return curve_of(normal.ldlt().solve(right));
}

// Schwarz's criterion of distances that fall off as exp(-|d|): 2 n ln(mean distance) + m ln(n), n points and m control
// points. Unlike one of squares, it can compare fits with and without points far away.
double schwarz(const std::vector<Vec3>& curve, const RimPoints& rim, int controls) {
  const Attached at = attached(curve, rim);
  const auto n = static_cast<double>(rim.x.size());
  double mean = 0.0;
  for (const double d : at.distance) mean += d / n;
  return 2.0 * n * std::log(std::max(mean, 1e-300)) + controls * std::log(n);
}

RimCurve described(std::vector<Vec3> x, const RimPoints& rim) {
  constexpr int kNear = 5;
  RimCurve out;
  const PointTree tree(rim.x);
  for (int k = 0; k < kSamples; ++k) {
    const Vec3 t = (x[idx((k + 1) % kSamples)] - x[idx((k + kSamples - 1) % kSamples)]).normalized();
    Vec3 o = Vec3::Zero();
    for (const auto& n : tree.nearest(x[idx(k)], kNear)) o += rim.outward[idx(n.point)];
    out.tangent.push_back(t);
    out.outward.push_back((o - o.dot(t) * t).normalized());
  }
  out.x = std::move(x);
  out.points = static_cast<int>(rim.x.size());
  return out;
}

RimCurve rim_curve(const std::vector<Vec3>& start, const RimPoints& rim) {
  const auto fitted = [&](std::vector<Vec3> curve, int controls, Run run) {
    for (int k = 0; k < kSteps; ++k) curve = evenly_along(step(curve, rim, controls, run), kSamples);
    return curve;
  };
  std::vector<Vec3> curve = evenly_along(start, kSamples), best;
  double least = 0.0;
  int chosen = 0;
  for (int controls = 6; controls * kPointsAControl <= static_cast<int>(rim.x.size()) || best.empty(); controls *= 2) {
    curve = fitted(std::move(curve), controls, Run::through);
    const double here = schwarz(curve, rim, controls);
    if (!best.empty() && here >= least) continue;
    least = here;
    best = curve;
    chosen = controls;
  }
  best = fitted(std::move(best), chosen, Run::along_outermost);
  return described(std::move(best), rim);
}

}  // namespace

std::vector<Vec3> evenly_along(const std::vector<Vec3>& loop, int count) {
  std::vector<double> until{0.0};
  for (std::size_t i = 0; i < loop.size(); ++i) {
    until.push_back(until.back() + (loop[(i + 1) % loop.size()] - loop[i]).norm());
  }
  std::vector<Vec3> out;
  std::size_t at = 0;
  for (int k = 0; k < count; ++k) {
    const double s = until.back() * k / count;
    while (at + 1 < loop.size() && until[at + 1] <= s) ++at;
    const double length = until[at + 1] - until[at];
    const double part = length > 0.0 ? (s - until[at]) / length : 0.0;
    out.emplace_back(loop[at] + part * (loop[(at + 1) % loop.size()] - loop[at]));
  }
  return out;
}

std::vector<RimCurve> rim_curves(const std::vector<std::vector<Vec3>>& starts, const RimPoints& rim) {
  std::vector<Vec3> all;
  std::vector<std::size_t> owner;
  for (std::size_t s = 0; s < starts.size(); ++s) {
    for (const Vec3& x : evenly_along(starts[s], kSamples)) {
      all.push_back(x);
      owner.push_back(s);
    }
  }
  if (all.empty()) return {};
  const PointTree tree(std::move(all));
  std::vector<RimPoints> own(starts.size());
  for (std::size_t k = 0; k < rim.x.size(); ++k) {
    RimPoints& of = own[owner[idx(tree.nearest(rim.x[k], 1).front().point)]];
    of.x.push_back(rim.x[k]);
    of.outward.push_back(rim.outward[k]);
  }
  std::vector<RimCurve> curves;
  for (std::size_t s = 0; s < starts.size(); ++s) {
    if (static_cast<int>(own[s].x.size()) >= kFewestPoints) curves.push_back(rim_curve(starts[s], own[s]));
  }
  return curves;
}

RimLocator::RimLocator(const std::vector<RimCurve>& curves) : curves_(curves) {
  std::vector<Vec3> all;
  for (std::size_t c = 0; c < curves_.size(); ++c) {
    for (std::size_t k = 0; k < curves_[c].x.size(); ++k) {
      all.push_back(curves_[c].x[k]);
      owner_.emplace_back(static_cast<int>(c), static_cast<int>(k));
    }
  }
  tree_ = std::make_unique<PointTree>(std::move(all));
}

RimLocator::Place RimLocator::nearest(const Vec3& x) const {
  const auto near = tree_->nearest(x, 1).front();
  const auto [c, k] = owner_[idx(near.point)];
  const RimCurve& curve = curves_[idx(c)];
  return {curve.x[idx(k)],
          curve.tangent[idx(k)],
          curve.outward[idx(k)],
          c,
          static_cast<double>(k) / static_cast<double>(curve.x.size()),
          near.distance};
}

}  // namespace pellicle

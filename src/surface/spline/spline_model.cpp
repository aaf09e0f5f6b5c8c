#include "pellicle/surface/spline/spline_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/base/constants.h"
#include "pellicle/base/errors.h"
#include "pellicle/surface/linear_stencils.h"

namespace pellicle {
namespace {

constexpr int kLargest = 4096;  ///< control points a direction
constexpr int kPoleBlocks = 6;

void check_size(const SplineSettings& s, const char* name, int size, int least) {
  if (size >= least && size <= kLargest) return;
  throw UsageError(fmt::format("spline {} ({} = {}): must have {} to {} control points in this direction",
                               to_string(s.topology), name, size, least, kLargest));
}

SplineSettings checked(const SplineSettings& s) {
  const bool flat = s.topology == SplineTopology::rectangle;
  check_size(s, "m1", s.m1, flat ? 1 : 4);
  check_size(s, "m2", s.m2, s.topology == SplineTopology::torus ? 4 : s.topology == SplineTopology::sphere ? 2 : 1);
  if (!(s.reference_ratio > 0.0 && s.reference_ratio < 1.0)) {
    throw UsageError(fmt::format(
        "spline torus (reference ratio {}): the minor radius must be above 0 and below the major", s.reference_ratio));
  }
  return s;
}

SplineAxis axis_u(const SplineSettings& s) {
  if (s.topology == SplineTopology::rectangle) return {SplineGenerator::keys, s.m1, s.m1, false};
  return {s.generator, s.m1, s.m1, true};
}

SplineAxis axis_v(const SplineSettings& s) {
  if (s.topology == SplineTopology::sphere) return {s.generator, 2 * s.m2, s.m2, false};
  if (s.topology == SplineTopology::torus) return {s.generator, s.m2, s.m2, true};
  return {SplineGenerator::keys, s.m2, s.m2, false};
}

Vec3 point_on_reference(const SplineSettings& s, double u, double v) {
  const double around = 2.0 * kPi * u;
  switch (s.topology) {
    case SplineTopology::sphere:
      return {std::cos(around) * std::sin(kPi * v), std::sin(around) * std::sin(kPi * v), std::cos(kPi * v)};
    case SplineTopology::torus: {
      const double rho = 1.0 + s.reference_ratio * std::cos(2.0 * kPi * v);
      return {rho * std::cos(around), rho * std::sin(around), s.reference_ratio * std::sin(2.0 * kPi * v)};
    }
    case SplineTopology::cylinder:
      return {std::cos(around), std::sin(around), 2.0 * v - 1.0};
    case SplineTopology::rectangle:
      break;
  }
  return {2.0 * u - 1.0, 2.0 * v - 1.0, 0.0};
}

void append(Parameters& parameters, const Vec3& x) {
  parameters.insert(parameters.end(), x.begin(), x.end());
}

Parameters reference_of(const SplineSettings& s, const SplineAxis& u, const SplineAxis& v) {
  Parameters result;
  const bool sphere = s.topology == SplineTopology::sphere;
  if (sphere) {
    for (const Vec3& block :
         {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(kPi, 0, 0), Vec3(0, kPi, 0), Vec3(-kPi, 0, 0), Vec3(0, -kPi, 0)}) {
      append(result, block);
    }
  }
  const int first_l = sphere ? 1 : v.closed() ? 0 : -1, last_l = sphere || v.closed() ? s.m2 - 1 : s.m2 + 1;
  for (int l = first_l; l <= last_l; ++l) {
    for (int k = u.closed() ? 0 : -1; k <= (u.closed() ? s.m1 - 1 : s.m1 + 1); ++k) {
      append(result, point_on_reference(s, static_cast<double>(k) / s.m1, static_cast<double>(l) / s.m2));
    }
  }
  return result;
}

Vec3 block_at(const Parameters& parameters, int block) {
  return Vec3(parameters.data() + 3 * static_cast<std::ptrdiff_t>(block));
}

}  // namespace

std::string to_string(SplineTopology topology) {
  switch (topology) {
    case SplineTopology::sphere:
      return "sphere";
    case SplineTopology::torus:
      return "torus";
    case SplineTopology::cylinder:
      return "cylinder";
    case SplineTopology::rectangle:
      break;
  }
  return "rectangle";
}

std::string to_string(SplineGenerator generator) {
  return generator == SplineGenerator::keys ? "keys" : "exponential";
}

SplineModel::SplineModel(const SplineSettings& settings)
    : settings_(checked(settings)),
      along_u_(axis_u(settings_)),
      along_v_(axis_v(settings_)),
      reference_(reference_of(settings_, along_u_, along_v_)) {}

std::vector<BlockKind> SplineModel::blocks() const {
  std::vector<BlockKind> result(reference_.size() / 3, BlockKind::point);
  if (settings_.topology == SplineTopology::sphere) std::fill_n(result.begin() + 2, 4, BlockKind::vector);
  return result;
}

Vec3 SplineModel::reference_point(double u, double v) const {
  return point_on_reference(settings_, u, v);
}

std::string SplineModel::name() const {
  return settings_.topology == SplineTopology::sphere ? "spline" : "spline-" + to_string(settings_.topology);
}

bool SplineModel::is_closed() const {
  return settings_.topology == SplineTopology::sphere || settings_.topology == SplineTopology::torus;
}

std::vector<BlockWeight> SplineModel::control(int row_u, int row_v) const {
  if (settings_.topology != SplineTopology::sphere) return {{row_u + along_u_.rows() * row_v, 1.0}};
  const int l = row_v - 1, m1 = settings_.m1, m2 = settings_.m2;
  if (l == 0) return {{0, 1.0}};
  if (l == m2) return {{1, 1.0}};
  const auto inner = [&](int ring) { return kPoleBlocks + row_u + m1 * (ring - 1); };
  if (l > 0 && l < m2) return {{inner(l), 1.0}};
  // Eqs. (11), (12): c[k,-1] - c[k,1] = b sigma_v(k/M1, 0), c[k,M2+1] - c[k,M2-1] = -b sigma_v(k/M1, 1)
  const double b = 1.0 / (m2 * along_v_.phi().slope_at_one());
  const double angle = 2.0 * kPi * row_u / m1;
  if (l < 0) return {{inner(1), 1.0}, {2, b * std::cos(angle)}, {3, b * std::sin(angle)}};
  return {{inner(m2 - 1), 1.0}, {4, -b * std::cos(angle)}, {5, -b * std::sin(angle)}};
}

std::vector<Vec3> SplineModel::control_grid(const Parameters& parameters) const {
  if (parameters.size() != reference_.size()) {
    throw BadData(fmt::format("parameters (spline {}): are {} numbers, must be {}", to_string(settings_.topology),
                              parameters.size(), reference_.size()));
  }
  std::vector<Vec3> grid;
  grid.reserve(static_cast<std::size_t>(along_u_.rows()) * along_v_.rows());
  for (int row_v = 0; row_v < along_v_.rows(); ++row_v) {
    for (int row_u = 0; row_u < along_u_.rows(); ++row_u) {
      Vec3 c = Vec3::Zero();
      for (const auto& [block, weight] : control(row_u, row_v)) c += weight * block_at(parameters, block);
      grid.push_back(c);
    }
  }
  return grid;
}

void SplineModel::pull_back_grid(const std::vector<Vec3>& dE_dc, std::vector<double>& gradient) const {
  std::size_t at = 0;
  for (int row_v = 0; row_v < along_v_.rows(); ++row_v) {
    for (int row_u = 0; row_u < along_u_.rows(); ++row_u, ++at) {
      for (const auto& [block, weight] : control(row_u, row_v)) {
        for (int axis = 0; axis < 3; ++axis) gradient[3 * std::size_t(block) + axis] += weight * dE_dc[at][axis];
      }
    }
  }
}

SplinePoint SplineModel::at(const Parameters& parameters, double u, double v) const {
  const AxisWeights wu = along_u_.at(settings_.m1 * u), wv = along_v_.at(settings_.m2 * v);
  SplinePoint result{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  for (int b = 0; b < 4; ++b) {
    for (int a = 0; a < 4; ++a) {
      for (const auto& [block, weight] : control(wu.row[a], wv.row[b])) {
        const Vec3 c = weight * block_at(parameters, block);
        result.x += wu.value[a] * wv.value[b] * c;
        result.x_u += wu.slope[a] * wv.value[b] * c;
        result.x_v += wu.value[a] * wv.slope[b] * c;
      }
    }
  }
  return result;
}

TriangleMesh SplineModel::control_mesh(const Parameters& parameters) const {
  TriangleMesh mesh;
  const std::vector<Vec3> grid = control_grid(parameters);
  const auto [topology, m1, m2, generator, ratio] = settings_;
  const bool sphere = topology == SplineTopology::sphere, around = along_u_.closed(), round = along_v_.closed();
  const int columns = around ? m1 : m1 + 1, first = sphere ? 1 : 0, last = sphere || round ? m2 - 1 : m2;
  if (sphere) mesh.vertices = {block_at(parameters, 0), block_at(parameters, 1)};
  const int offset = sphere ? 2 : 0;
  for (int l = first; l <= last; ++l) {
    for (int k = 0; k < columns; ++k)
      mesh.vertices.push_back(grid[along_u_.row(k) + along_u_.rows() * along_v_.row(l)]);
  }
  const int rings = last - first + 1;
  const auto vertex = [&](int k, int l) { return offset + k % columns + columns * (l % rings); };
  for (int l = 0; l < (round ? rings : rings - 1); ++l) {
    for (int k = 0; k < m1; ++k) {
      const int a = vertex(k, l), b = vertex(k + 1, l), c = vertex(k + 1, l + 1), d = vertex(k, l + 1);
      if (sphere) {  // v runs down
        mesh.triangles.insert(mesh.triangles.end(), {{a, d, c}, {a, c, b}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      }
    }
  }
  for (int k = 0; sphere && k < m1; ++k) {
    mesh.triangles.push_back({0, vertex(k, 0), vertex(k + 1, 0)});
    mesh.triangles.push_back({1, vertex(k + 1, rings - 1), vertex(k, rings - 1)});
  }
  return mesh;
}

void SplineModel::evaluate(const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
                           SurfaceSamples& samples) const {
  evaluate_linear(parameters, layout, with_jacobian, samples);
}

void SplineModel::pull_back(const Parameters&, const SampleLayout& layout, const std::vector<Vec3>& dE_dx,
                            std::vector<double>& gradient) const {
  pull_back_linear(layout, dE_dx, gradient);
}

}  // namespace pellicle

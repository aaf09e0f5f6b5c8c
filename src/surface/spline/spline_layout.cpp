// Where the samples of a spline surface lie. See spline_model.h.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "pellicle/base/constants.h"
#include "pellicle/base/errors.h"
#include "pellicle/surface/icosphere.h"
#include "pellicle/surface/linear_stencils.h"
#include "pellicle/surface/spline/spline_model.h"

namespace pellicle {
namespace {

constexpr int kHighestDensity = 7;

struct Place {
  double knots_u = 0.0, knots_v = 0.0;
  Vec3 reference;
  int pole = 0;  ///< 1: north, -1: south
};

struct Places {
  std::vector<Place> at;
  std::vector<std::array<int, 3>> triangles;
};

/// Refinements of the icosahedron that come nearest (by ratio) to the facets of the control net.
int icosphere_level(const SplineSettings& s) {
  const double net = 2.0 * s.m1 * (s.m2 - 1);
  return std::max(0, static_cast<int>(std::lround(0.5 * std::log2(net / 20.0))));
}

Places on_sphere(const SplineSettings& s, int level) {
  Icosphere sphere = icosphere(icosphere_level(s) + level);
  Places places;
  places.triangles = std::move(sphere.triangles);
  places.at.reserve(sphere.directions.size());
  for (std::size_t i = 0; i < sphere.directions.size(); ++i) {
    const Vec3& d = sphere.directions[i];
    if (i < 2) {
      places.at.push_back({0.0, i == 0 ? 0.0 : static_cast<double>(s.m2), d, i == 0 ? 1 : -1});
      continue;
    }
    double u = std::atan2(d.y(), d.x()) / (2.0 * kPi);
    if (u < 0.0) u += 1.0;
    const double v = std::atan2(std::hypot(d.x(), d.y()), d.z()) / kPi;  // acos is blunt near the poles
    places.at.push_back({s.m1 * u, s.m2 * v, d, 0});
  }
  return places;
}

/// The knots' own lines: 2^level intervals between control points, and the poles.
Places on_meridians(const SplineModel& model, int level) {
  const SplineSettings& s = model.settings();
  const int fine = 1 << level, columns = s.m1 * fine, rings = s.m2 * fine - 1;
  Places places;
  places.at.push_back({0.0, 0.0, Vec3::UnitZ(), 1});
  for (int b = 1; b <= rings; ++b) {
    for (int a = 0; a < columns; ++a) {
      const double knots_u = static_cast<double>(a) / fine, knots_v = static_cast<double>(b) / fine;
      places.at.push_back({knots_u, knots_v, model.reference_point(knots_u / s.m1, knots_v / s.m2)});
    }
  }
  const int south = static_cast<int>(places.at.size());
  places.at.push_back({0.0, static_cast<double>(s.m2), -Vec3::UnitZ(), -1});
  const auto sample = [&](int a, int b) { return 1 + a % columns + columns * (b - 1); };
  for (int a = 0; a < columns; ++a) {
    places.triangles.push_back({0, sample(a, 1), sample(a + 1, 1)});
    for (int b = 1; b < rings; ++b) {
      const int p = sample(a, b), q = sample(a, b + 1), r = sample(a + 1, b + 1), t = sample(a + 1, b);
      places.triangles.insert(places.triangles.end(), {{p, q, r}, {p, r, t}});
    }
    places.triangles.push_back({south, sample(a + 1, rings), sample(a, rings)});
  }
  return places;
}

Places on_grid(const SplineModel& model, int level) {
  const SplineSettings& s = model.settings();
  const int fine = 1 << level, cells_u = s.m1 * fine, cells_v = s.m2 * fine;
  const bool around = model.along_u().closed(), round = model.along_v().closed();
  const int columns = around ? cells_u : cells_u + 1, rows = round ? cells_v : cells_v + 1;
  Places places;
  for (int b = 0; b < rows; ++b) {
    for (int a = 0; a < columns; ++a) {
      const double knots_u = static_cast<double>(a) / fine, knots_v = static_cast<double>(b) / fine;
      places.at.push_back({knots_u, knots_v, model.reference_point(knots_u / s.m1, knots_v / s.m2)});
    }
  }
  const auto sample = [&](int a, int b) { return a % columns + columns * (b % rows); };
  for (int b = 0; b < cells_v; ++b) {
    for (int a = 0; a < cells_u; ++a) {
      const int p = sample(a, b), q = sample(a + 1, b), r = sample(a + 1, b + 1), t = sample(a, b + 1);
      places.triangles.insert(places.triangles.end(), {{p, q, r}, {p, r, t}});
    }
  }
  return places;
}

/// One knot cell: its blocks, and its sixteen control points in terms of them.
class Cell {
 public:
  Cell(const SplineModel& model, const AxisWeights& u, const AxisWeights& v) {
    std::array<std::vector<BlockWeight>, 16> controls;
    std::set<int> blocks;
    for (int i = 0; i < 16; ++i) {
      controls[i] = model.control(u.row[i % 4], v.row[i / 4]);
      for (const auto& [block, weight] : controls[i]) blocks.insert(block);
    }
    blocks_.assign(blocks.begin(), blocks.end());
    for (int i = 0; i < 16; ++i) {
      for (const auto& [block, weight] : controls[i]) entries_.push_back({i, slot_of(block), weight});
    }
  }
  const std::vector<int>& blocks() const { return blocks_; }
  std::vector<double> combine(const std::array<double, 4>& u, const std::array<double, 4>& v) const {
    std::vector<double> weights(blocks_.size(), 0.0);
    for (const auto& [point, slot, weight] : entries_) weights[slot] += u[point % 4] * v[point / 4] * weight;
    return weights;
  }
  std::vector<double> only(int block) const {
    std::vector<double> weights(blocks_.size(), 0.0);
    weights[slot_of(block)] = 1.0;
    return weights;
  }

 private:
  struct Entry {
    int point;
    std::size_t slot;
    double weight;
  };
  std::size_t slot_of(int block) const {
    return static_cast<std::size_t>(std::lower_bound(blocks_.begin(), blocks_.end(), block) - blocks_.begin());
  }

  std::vector<int> blocks_;
  std::vector<Entry> entries_;
};

void add(const SplineModel& model, const Place& place, const Cell& cell, SampleLayout& layout,
         LinearStencils& stencils) {
  layout.reference.push_back(place.reference);
  // sigma_u is zero at the poles: the tangents span the plane there (blocks: spline_model.h)
  if (place.pole > 0) {
    add_sample(layout, stencils, cell.only(0), cell.only(2), cell.only(3));
  } else if (place.pole < 0) {
    add_sample(layout, stencils, cell.only(1), cell.only(5), cell.only(4));
  } else {
    const AxisWeights u = model.along_u().at(place.knots_u), v = model.along_v().at(place.knots_v);
    const std::vector<double> x = cell.combine(u.value, v.value);
    std::vector<double> first = cell.combine(u.slope, v.value), second = cell.combine(u.value, v.slope);
    if (model.settings().topology == SplineTopology::sphere) std::swap(first, second);  // u, v are left-handed there
    add_sample(layout, stencils, x, first, second);
  }
}

/// Samples sorted by knot cell, one patch a cell that has any.
SampleLayout lay_out(const SplineModel& model, int level, const Places& places) {
  const auto cell_of = [&](std::size_t i) {
    const int u = model.along_u().at(places.at[i].knots_u).cell, v = model.along_v().at(places.at[i].knots_v).cell;
    return u + model.settings().m1 * v;
  };
  std::vector<int> cell(places.at.size()), order(places.at.size()), number(places.at.size());
  for (std::size_t i = 0; i < cell.size(); ++i) cell[i] = cell_of(i);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return cell[a] < cell[b]; });
  SampleLayout layout;
  layout.level = level;
  auto stencils = std::make_shared<LinearStencils>();
  for (std::size_t begin = 0; begin < order.size();) {
    const int here = cell[order[begin]];
    const Place& first = places.at[order[begin]];
    const Cell patch(model, model.along_u().at(first.knots_u), model.along_v().at(first.knots_v));
    begin_patch(layout, patch.blocks());
    for (; begin < order.size() && cell[order[begin]] == here; ++begin) {
      number[order[begin]] = layout.sample_count();
      add(model, places.at[order[begin]], patch, layout, *stencils);
    }
  }
  layout.triangles = places.triangles;
  for (auto& triangle : layout.triangles) {
    for (int& corner : triangle) corner = number[corner];
  }
  layout.stencils = std::move(stencils);
  return layout;
}

}  // namespace

int SplineModel::base_facets() const {
  if (settings_.topology == SplineTopology::sphere) return 20 << (2 * icosphere_level(settings_));
  return 2 * settings_.m1 * settings_.m2;
}

SampleLayout SplineModel::layout(int level) const {
  if (level < 0 || level > kHighestDensity) {
    throw UsageError(fmt::format("surface density ({}): must be a level from 0 to {}", level, kHighestDensity));
  }
  return lay_out(*this, level,
                 settings_.topology == SplineTopology::sphere ? on_sphere(settings_, level) : on_grid(*this, level));
}

SampleLayout SplineModel::knot_layout(int level) const {
  if (settings_.topology != SplineTopology::sphere) return layout(level);
  if (level < 0 || level > kHighestDensity) {
    throw UsageError(fmt::format("surface density ({}): must be a level from 0 to {}", level, kHighestDensity));
  }
  return lay_out(*this, level, on_meridians(*this, level));
}

}  // namespace pellicle

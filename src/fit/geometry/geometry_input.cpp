#include "pellicle/fit/geometry/geometry_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/energies/profiles.h"
#include "pellicle/image/reorder.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/points/point_tree.h"
#include "pellicle/mesh/points/rim.h"
#include "pellicle/raster/closed_solid.h"
#include "pellicle/raster/cup.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/seed/open_seed.h"

namespace pellicle {

namespace {

constexpr int kMeshSamples = 40000;
constexpr std::size_t kLeastPoints = 10;

/// 0 for points whose neighbours are much further away than is usual, 1 for the others.
/// \param tree of all points or of some, evenly chosen.
std::vector<std::uint8_t> near_others(const std::vector<Vec3>& points, const PointTree& tree) {
  constexpr int kNeighbours = 6;
  constexpr double kFar = 5.0;
  std::vector<double> reach(points.size());
  parallel_for(points.size(), 1000, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) reach[i] = tree.nearest(points[i], kNeighbours + 1).back().distance;
  });
  const double usual = median_of(reach);
  std::vector<std::uint8_t> near(points.size());
  std::transform(reach.begin(), reach.end(), near.begin(),
                 [&](double r) { return static_cast<std::uint8_t>(r <= kFar * usual ? 1 : 0); });
  return near;
}

/// Points of `tree` that lie beside the sheet of their neighbours, which a rim would be drawn to: off the plane through
/// them by more than five times their own deviation and three quarters of the sixth's distance. 1 for those that do
/// not.
std::vector<std::uint8_t> on_sheets(const std::vector<Vec3>& points, const PointTree& tree) {
  constexpr int kNeighbours = 12, kSixth = 5;
  constexpr double kDeviations = 5.0, kOff = 0.75;
  std::vector<std::uint8_t> on(points.size());
  parallel_for(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::vector<Vec3> others;
      for (const auto& n : tree.nearest(points[i], kNeighbours + 1)) {
        if (n.distance > 0.0) others.push_back(tree.points()[static_cast<std::size_t>(n.point)]);
      }
      if (others.size() <= kSixth) continue;
      const FittedPlane plane = plane_through(others);
      const double off = std::abs(plane.normal.dot(points[i] - plane.mean));
      on[i] = off <= std::max(kDeviations * plane.deviation, kOff * (others[kSixth] - points[i]).norm()) ? 1 : 0;
    }
  });
  return on;
}

// A subset is enough for the shell.
std::vector<Vec3> thinned(const std::vector<Vec3>& points, std::size_t most) {
  if (points.size() <= most) return points;
  std::vector<Vec3> out;
  out.reserve(most);
  for (std::size_t i = 0; i < most; ++i) out.push_back(points[i * points.size() / most]);
  return out;
}

// Open data: their rim, found by a rough body, and a body that lids close there.
void take_rim(const std::string& name, const std::vector<Vec3>& points, GeometryInput& input) {
  const PointTree tree(points);
  const double spacing = point_spacing(tree);
  try {
    input.body = filled_cup(points, spacing);
    input.data.rim = rims_of(input.body, {tree, plane_normals(tree)});
    if (input.data.rim.empty()) throw BadData("its points end nowhere; leave `open` out for a closed surface");
    std::vector<Vec3> closed = lids_of(input.data.rim, spacing);
    closed.insert(closed.end(), points.begin(), points.end());
    ClosedSolid solid = solid_of_points(closed, spacing);
    if (solid.genus_as_given == 0) input.body = std::move(solid.as_given);  // else stray points lead it astray
  } catch (const BadData& fault) {
    throw BadData(fmt::format("cannot fit ({}): {}", name, fault.what()));
  }
}

void enclose(const std::string& name, GeometryInput& input) {
  const PointTree tree(thinned(input.data.points, 200000));
  std::vector<std::uint8_t> near = near_others(input.data.points, tree);
  if (input.open) {
    const std::vector<std::uint8_t> on = on_sheets(input.data.points, tree);
    for (std::size_t i = 0; i < near.size(); ++i) near[i] = std::min(near[i], on[i]);
  }
  std::vector<double>& weights = input.data.weights;
  if (weights.empty()) weights.assign(input.data.points.size(), 1.0);
  std::vector<Vec3> together;
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (near[i] == 0) {
      weights[i] = 0.0;
    } else {
      together.push_back(input.data.points[i]);
    }
  }
  if (together.size() < near.size()) {
    input.warnings.push_back(fmt::format("{} of {} points lie apart from the rest and take no part in the fit",
                                         near.size() - together.size(), near.size()));
  }
  const std::vector<Vec3> kept = thinned(together, 200000);
  input.data.diameter = diameter_of(kept);
  if (input.open) {
    take_rim(name, kept, input);
    return;
  }
  try {
    ClosedSolid solid = solid_of_points(kept, point_spacing(tree));
    input.solid = std::move(solid.surface);
    input.body = std::move(solid.as_given);
    input.genus = solid.genus_as_given;
    input.bridged_mm = solid.closing_mm;
  } catch (const BadData& fault) {
    throw BadData(fmt::format("cannot fit ({}): {}", name, fault.what()));
  }
  std::vector<Vec3> normals = plane_normals(tree);
  orient_outward(input.body, tree.points(), normals);
  input.data.normals.resize(input.data.points.size());
  parallel_for(input.data.points.size(), 1000, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int nearest = tree.nearest(input.data.points[i], 1).front().point;
      input.data.normals[i] = normals[static_cast<std::size_t>(nearest)];
    }
  });
}

}  // namespace

std::string to_string(GeometryKind kind) {
  switch (kind) {
    case GeometryKind::points:
      return "points";
    case GeometryKind::grid:
      return "grid";
    case GeometryKind::mesh:
      return "mesh";
    case GeometryKind::mask:
      return "mask";
  }
  return "";
}

GeometryInput geometry_of_points(PointCloud cloud, const std::string& name, bool open) {
  GeometryInput input;
  input.name = name;
  input.open = open;
  input.kind = cloud.grid ? GeometryKind::grid : GeometryKind::points;
  if (cloud.points.size() < kLeastPoints) {
    throw BadData(fmt::format("too few points ({}): it holds {}, a surface takes {} or more", name, cloud.points.size(),
                              kLeastPoints));
  }
  input.data.points = std::move(cloud.points);
  input.data.weights = std::move(cloud.weights);
  if (!input.data.weights.empty() && *std::max_element(input.data.weights.begin(), input.data.weights.end()) <= 0.0) {
    throw BadData(fmt::format("no weight ({}): every point has weight 0", name));
  }
  input.grid = std::move(cloud.grid);
  if (input.grid && open) {
    throw SettingError("bad value", "open, input", name,
                       "a grid of points is interpolated; leave `open` out (spline-cylinder and spline-rectangle are "
                       "open)");
  }
  if (input.grid) {
    input.data.robust = false;
    input.data.diameter = diameter_of(input.data.points);
  } else {
    enclose(name, input);
  }
  return input;
}

GeometryInput geometry_of_mesh(TriangleMesh mesh, const std::string& name, bool open) {
  GeometryInput input;
  input.open = open;
  input.name = name;
  input.kind = GeometryKind::mesh;
  if (!(area_of(mesh) > 0.0)) throw BadData(fmt::format("cannot fit ({}): its facets have no area", name));
  const MeshTopology topology = topology_of(mesh);
  const bool surface = topology.closed && topology.manifold && topology.oriented && topology.components == 1;
  if (!surface || open) {
    if (!open) {
      input.warnings.push_back(fmt::format(
          "the mesh is not a closed surface of one part ({}): it is treated as points",
          topology.first_fault.empty() ? fmt::format("{} parts", topology.components) : topology.first_fault));
    }
    input.data.points = sample_surface(mesh, 3 * kMeshSamples);
    enclose(name, input);
    return input;
  }
  input.genus = topology.genus;
  input.data = data_of(std::move(mesh), kMeshSamples);
  try {
    const PointTree tree(input.data.points);
    ClosedSolid solid = solid_of_points(input.data.points, point_spacing(tree));
    input.body = std::move(solid.as_given);
    input.solid = std::move(solid.surface);
    input.bridged_mm = solid.closing_mm;
  } catch (const BadData&) {
    input.solid = {};
  }
  if (topology.genus == 0) {
    input.solid = *input.data.surface;
    input.bridged_mm = 0.0;
  }
  return input;
}

GeometryInput geometry_of_mask(Image<std::uint8_t> mask, const std::string& name) {
  GeometryInput input;
  input.name = name;
  input.kind = GeometryKind::mask;
  const auto count = std::count_if(mask.voxels.begin(), mask.voxels.end(), [](std::uint8_t v) { return v != 0; });
  if (count == 0) throw BadData(fmt::format("empty mask ({}): every voxel is 0", name));
  mask = in_lps_order(std::move(mask));
  ClosedSolid solid = solid_of_mask(mask);
  const double voxel = mask.grid.voxel_volume();
  const double missing = 1.0 - volume_of(solid.surface) / (static_cast<double>(count) * voxel);
  if (missing > 0.05) {
    input.warnings.push_back(
        fmt::format("the mask has several parts: the largest one alone is fitted, {:.0f} % of the volume is left out",
                    100.0 * missing));
  }
  input.genus = solid.genus_as_given;
  input.bridged_mm = solid.closing_mm;
  input.data = data_of(solid.closing_mm > 0.0 ? surface_of_mask(solid.as_given) : solid.surface, kMeshSamples);
  input.body = std::move(solid.as_given);
  input.solid = std::move(solid.surface);
  return input;
}

}  // namespace pellicle

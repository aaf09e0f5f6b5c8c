#include "pellicle/job/measure.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/job/voxels.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {

namespace {

// More facets than this add nothing: on a ball of radius R the chords of 100,000 miss the surface by 4e-5 R.
constexpr int kMostFacets = 120000;
constexpr int kMostFacetsOfMany = 4000;
// Coarse meshes that the user asked for still get the volume of the smooth surface.
constexpr int kFineLevel = 4, kFineLevelOfMany = 3;

int mesh_level(const Surface& surface, const ImageGrid& grid, const SegmentOptions& options) {
  if (options.mesh_level) return *options.mesh_level;
  int level = tessellation_level(surface, 0.5 * grid.mean_spacing());
  const int control_facets = base_facets(surface.model);
  while (level > 2 && (control_facets << (2 * level)) > kMostFacets) --level;
  return std::max(2, level);
}

/// Facets of about a voxel.
int mesh_level_of_many(const Surface& surface, double area, const ImageGrid& grid, const SegmentOptions& options) {
  if (options.mesh_level) return *options.mesh_level;
  const double wanted = std::min<double>(kMostFacetsOfMany, area / (0.43 * std::pow(grid.mean_spacing(), 2)));
  return std::max(2, static_cast<int>(std::floor(0.5 * std::log2(wanted / base_facets(surface.model)) + 0.5)));
}

/// Longest by shortest half axis of the solid's ellipsoid of inertia.
double elongation_of(const TriangleMesh& mesh) {
  const Vec3 centre = centroid_of(mesh);
  Mat3 moments = Mat3::Zero();
  for (const auto& t : mesh.triangles) {
    std::array<Vec3, 3> p;
    for (std::size_t c = 0; c < 3; ++c) p[c] = mesh.vertices[static_cast<std::size_t>(t[c])] - centre;
    // Of the tetrahedron with the centre: V/20 (sum p p^T + (sum p)(sum p)^T).
    const double volume = p[0].dot(p[1].cross(p[2])) / 6.0;
    const Vec3 all = p[0] + p[1] + p[2];
    Mat3 one = all * all.transpose();
    for (const Vec3& q : p) one += q * q.transpose();
    moments += volume / 20.0 * one;
  }
  const Vec3 values = Eigen::SelfAdjointEigenSolver<Mat3>(moments).eigenvalues();
  return values[0] > 0.0 ? std::sqrt(values[2] / values[0]) : std::numeric_limits<double>::quiet_NaN();
}

bool lies_within(const TriangleMesh& mesh, const ImageGrid& grid) {
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [&](const Vec3& v) { return grid.contains(v); });
}

/// Volume and area from `fine`, which has normals; topology and self-intersections from the object's mesh.
void measure_surface(const TriangleMesh& fine, ObjectResult& object) {
  object.volume_surface_ml = volume_with_normals(fine) / 1000.0;
  object.area_mm2 = area_of(fine);
  object.topology = topology_of(object.mesh);
  object.self_intersections = self_intersection_count(object.mesh);
  if (object.self_intersections > 0 && object.fit.status == FitStatus::ok) {
    object.fit.status = FitStatus::folded;
    object.fit.reason = fmt::format("the surface cuts itself: {} pairs of facets", object.self_intersections);
  }
}

/// What is measured on each of many objects beside that, from the same meshes.
void measure_shape(const TriangleMesh& fine, const ImageGrid& grid, ObjectResult& object) {
  object.volume_mesh_ml = volume_of(object.mesh) / 1000.0;
  ObjectShape& shape = *object.shape;
  shape.centre = centroid_of(fine);
  shape.elongation = elongation_of(fine);
  const double volume = volume_of(fine);
  shape.sphericity = std::cbrt(36.0 * std::numbers::pi * volume * volume) / object.area_mm2;
  object.volume_partial_ml = object.volume_surface_ml;
  if (lies_within(object.mesh, grid)) return;
  const Box box = box_around(object.mesh, grid, 1);
  double sum = 0.0;
  if (!box.empty()) {
    for (const float f : rasterize_partial_volume(object.mesh, box.grid).voxels) sum += static_cast<double>(f);
  }
  object.volume_partial_ml = sum * grid.voxel_volume() / 1000.0;
}

void check_finite(const TriangleMesh& mesh) {
  const bool finite =
      std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& vertex) { return vertex.allFinite(); });
  if (!finite) throw Failure("fit failed (object): the surface is not finite; please report this");
}

void measure_object(ObjectResult& object, const ImageGrid& grid, const SegmentOptions& options, MeshLayouts& layouts) {
  const auto outward_mesh = [&](int level) {
    TriangleMesh mesh = layouts.mesh(object.surface, level);
    turn_outward(mesh);  // a surface that was turned inside out keeps its status
    return mesh;
  };
  TriangleMesh fine;
  if (options.many) {
    fine = outward_mesh(kFineLevelOfMany);
    object.mesh_level = mesh_level_of_many(object.surface, area_of(fine), grid, options);
  } else {
    object.mesh_level = mesh_level(object.surface, grid, options);
    fine = outward_mesh(std::max(object.mesh_level, kFineLevel));
  }
  const bool is_fine = object.mesh_level == (options.many ? kFineLevelOfMany : std::max(object.mesh_level, kFineLevel));
  object.mesh = is_fine ? fine : outward_mesh(object.mesh_level);
  check_finite(object.mesh);
  measure_surface(fine, object);
  if (options.many) measure_shape(fine, grid, object);
}

}  // namespace

TriangleMesh MeshLayouts::mesh(const Surface& surface, int level) {
  const std::shared_ptr<const SampleLayout> shared = layout(surface.model, level);
  SurfaceSamples samples;
  evaluate(surface.model, surface.parameters, *shared, false, samples);
  return mesh_of(*shared, samples);
}

std::shared_ptr<const SampleLayout> MeshLayouts::layout(const SurfaceModel& model, int level) {
  const LayoutKey key = layout_key(model, level);
  const std::scoped_lock lock(mutex_);
  const auto found = layouts_.find(key);
  if (found != layouts_.end()) return found->second;
  auto made = std::make_shared<const SampleLayout>(layout_of(model, level));
  if (layouts_.size() < kMostLayouts) layouts_.emplace(key, made);
  return made;
}

void measure(std::vector<ObjectResult>& objects, const ImageGrid& grid, const SegmentOptions& options) {
  MeshLayouts layouts;
  parallel_for(objects.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) measure_object(objects[i], grid, options, layouts);
  });
}

TriangleMesh merged_mesh(const std::vector<ObjectResult>& objects) {
  TriangleMesh all;
  for (const ObjectResult& object : objects) append(all, object.mesh);
  return all;
}

double z_extent(const std::vector<ObjectResult>& objects) {
  std::vector<double> ratios;
  for (const ObjectResult& object : objects) {
    if (object.shape->visible < 0.999) continue;
    Vec3 low = object.mesh.vertices.front(), high = low;
    for (const Vec3& v : object.mesh.vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    ratios.push_back(2.0 * (high[2] - low[2]) / (high[0] - low[0] + high[1] - low[1]));
  }
  if (ratios.empty()) return std::numeric_limits<double>::quiet_NaN();
  return std::accumulate(ratios.begin(), ratios.end(), 0.0) / static_cast<double>(ratios.size());
}

}  // namespace pellicle

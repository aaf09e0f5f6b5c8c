#include "pellicle/pipeline/segment_many.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>
#include <numeric>

#include "pellicle/base/errors.h"
#include "pellicle/base/interrupt.h"
#include "pellicle/base/parallel.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/pipeline/provenance.h"
#include "pellicle/pipeline/voxels.h"
#include "pellicle/raster/joint_labels.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {

namespace {

constexpr int kMostLabels = 65535;  // of a uint16 map
constexpr int kMostFacets = 4000;   // of one of many

void tell(const RunContext& context, SegmentResult& result, const std::string& message) {
  result.warnings.push_back(message);
  if (context.warn) context.warn(message);
}

std::vector<Seed> one_each(const std::vector<ObjectSeed>& seeds) {
  std::vector<Seed> list;
  list.reserve(seeds.size());
  for (const ObjectSeed& seed : seeds) list.push_back(seed.candidates.front());
  return list;
}

int level_of(const SegmentSettings& settings, int control_facets, double area, const ImageGrid& grid) {
  if (settings.mesh_density) return *settings.mesh_density;
  const double wanted = std::min<double>(kMostFacets, area / (0.43 * std::pow(grid.mean_spacing(), 2)));
  return std::max(2, static_cast<int>(std::floor(0.5 * std::log2(wanted / control_facets) + 0.5)));
}

/// Layouts of one model by level: thousands of objects share a few.
class Layouts {
 public:
  TriangleMesh mesh(const Surface& surface, int level) {
    const SampleLayout& layout = at(surface.model, level);
    SurfaceSamples samples;
    evaluate(surface.model, surface.parameters, layout, false, samples);
    return mesh_of(layout, samples);
  }

 private:
  const SampleLayout& at(const SurfaceModel& model, int level) {
    const std::scoped_lock lock(mutex_);
    const std::pair key{control_point_count(model), level};
    auto found = layouts_.find(key);
    if (found == layouts_.end()) found = layouts_.emplace(key, layout_of(model, level)).first;
    return found->second;
  }
  std::mutex mutex_;
  std::map<std::pair<int, int>, SampleLayout> layouts_;
};

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

void measure_one(const SegmentSettings& settings, const ImageGrid& grid, Layouts& layouts, ObjectResult& object) {
  TriangleMesh fine = layouts.mesh(object.surface, 3);
  turn_outward(fine);
  object.mesh_level = level_of(settings, base_facets(object.surface.model), area_of(fine), grid);
  object.mesh = object.mesh_level == 3 ? fine : layouts.mesh(object.surface, object.mesh_level);
  turn_outward(object.mesh);
  object.volume_mesh_ml = volume_of(object.mesh) / 1000.0;
  measure_surface(fine, object);
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

/// Which labels stand in the outermost voxels.
std::vector<bool> labels_at_border(const Image<std::uint16_t>& labels) {
  std::vector<bool> at(kMostLabels + 1, false);
  const Index3& size = labels.grid.size;
  for (int k = 0; k < size[2]; ++k) {
    const bool face_z = k == 0 || k == size[2] - 1;
    for (int j = 0; j < size[1]; ++j) {
      const bool whole = face_z || j == 0 || j == size[1] - 1;
      const int step = whole ? 1 : std::max(1, size[0] - 1);
      for (int i = 0; i < size[0]; i += step) at[labels.at(i, j, k)] = true;
    }
  }
  return at;
}

/// Mean extent along z of the typical object over its mean extent in x and y: 1 for balls at the right spacing.
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

}  // namespace

ManySettings many_settings(const SegmentSettings& settings) {
  return {settings.fit, settings.radius, {.valley = settings.valley}};
}

TriangleMesh merged_mesh(const std::vector<ObjectResult>& objects) {
  TriangleMesh all;
  for (const ObjectResult& object : objects) append(all, object.mesh);
  return all;
}

void fit_many_objects(const std::vector<ObjectSeed>& seeds, Image<float> image, const RunContext& context,
                      SegmentResult& result) {
  const auto progress = [&](double share, const std::string& what) {
    if (context.progress) context.progress(0.1 + 0.6 * share, what);
  };
  const ManySettings settings = many_settings(result.settings);
  PhaseClock clock;
  clock.start("fit");
  ManyResult many;
  if (result.max > result.min) {
    const Observer observer{.progress = progress, .stopped = interrupt_requested};
    many = seeds.empty() ? fit_many(std::move(image), settings, observer)
                         : fit_many(std::move(image), one_each(seeds), settings, observer);
  }
  clock.stop();
  if (many.objects.size() > static_cast<std::size_t>(kMostLabels)) {
    throw BadData(
        fmt::format("too many objects ({}): {} were found, a label map holds {}; crop the image or give --radius",
                    result.settings.input.string(), many.objects.size(), kMostLabels));
  }
  const double each = clock.seconds().front().second / std::max<double>(1.0, static_cast<double>(many.objects.size()));
  for (ManyObject& found : many.objects) {
    ObjectResult object{
        .label = static_cast<int>(result.objects.size()) + 1, .name = {}, .surface = std::move(found.surface)};
    object.name = fmt::format("object-{}", object.label);
    if (!seeds.empty()) {
      object.label = seeds[found.source].label;
      object.name = seeds[found.source].name;
    }
    object.fit = std::move(found.summary);
    object.shape = ObjectShape{
        .visible = found.evidence.visible, .support = found.evidence.support, .limited = found.evidence.limited};
    object.seconds = each;
    result.objects.push_back(std::move(object));
  }
  if (many.objects.empty())
    tell(context, result, "no object found: nothing rises above the noise; see --radius and --polarity");
  if (!seeds.empty() && many.doubled > 0) {
    tell(context, result,
         fmt::format("{} of the {} seeds lie in the object of another one: one object each is kept", many.doubled,
                     seeds.size()));
  }
  result.many = ManySummary{.radius_mm = many.radius,
                            .dark = many.dark,
                            .seeds = many.seeds,
                            .weak = many.weak,
                            .doubled = many.doubled,
                            .variation = many.variation,
                            .typical_shape = many.typical_shape};
  if (context.inform) {
    context.inform(
        fmt::format("typical radius {:.4g} mm, {} places tried, {} objects, {} turned down as unlike the others",
                    many.radius, many.seeds, many.objects.size(), many.weak));
  }
}

Image<std::uint16_t> measure_many(SegmentResult& result, const ImageGrid& grid, Image<float>& fraction) {
  Layouts layouts;
  parallel_for(result.objects.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) measure_one(result.settings, grid, layouts, result.objects[i]);
  });
  std::vector<const TriangleMesh*> meshes;
  std::vector<std::uint16_t> labels;
  for (const ObjectResult& object : result.objects) {
    meshes.push_back(&object.mesh);
    labels.push_back(static_cast<std::uint16_t>(object.label));
  }
  JointLabels joint = label_together(meshes, labels, grid);
  const std::vector<bool> at_border = labels_at_border(joint.labels);
  for (std::size_t i = 0; i < result.objects.size(); ++i) {
    ObjectResult& object = result.objects[i];
    object.volume_mask_ml = static_cast<double>(joint.voxels[i]) * grid.voxel_volume() / 1000.0;
    object.overlap_voxels = joint.shared[i];
    object.touches_border = at_border[static_cast<std::size_t>(object.label)];
    if (fraction.voxels.empty()) continue;
    const Box box = box_around(object.mesh, grid, 1);
    if (box.empty()) continue;
    const Image<float> own = rasterize_partial_volume(object.mesh, box.grid);
    for_each_voxel(box, grid, [&](std::size_t outer, std::size_t inner, bool) {
      fraction.voxels[outer] = std::min(1.0F, fraction.voxels[outer] + own.voxels[inner]);
    });
  }
  if (result.many) result.many->z_extent = z_extent(result.objects);
  return std::move(joint.labels);
}

Image<float> distance_to_all(const std::vector<ObjectResult>& objects, const ImageGrid& grid) {
  const double furthest = grid.extent().norm();
  if (objects.empty()) return Image<float>(grid, static_cast<float>(furthest));
  return rasterize_signed_distance(merged_mesh(objects), grid, furthest);
}

std::string many_table(const std::vector<ObjectResult>& objects) {
  std::string text =
      "index\tlabel\tname\tvolume_ml\tstatus\tx_mm\ty_mm\tz_mm\tvolume_surface_ml\tvolume_visible_ml\tvisible_share\t"
      "area_mm2\tsphericity\telongation\tcontrast\tsupport\ttouches_border\n";
  for (const ObjectResult& o : objects) {
    const ObjectShape& s = *o.shape;
    text += fmt::format(
        "{}\t{}\t{}\t{:.6g}\t{}\t{:.6g}\t{:.6g}\t{:.6g}\t{:.6g}\t{:.6g}\t{:.4f}\t{:.6g}\t{:.4f}\t{:.4f}\t{:.6g}\t{:.4f}"
        "\t{}\n",
        o.label, o.label, o.name, o.volume_mask_ml, to_string(o.fit.status), s.centre[0], s.centre[1], s.centre[2],
        o.volume_surface_ml, o.volume_partial_ml, s.visible, o.area_mm2, s.sphericity, s.elongation,
        o.fit.evidence.contrast, s.support, o.touches_border ? 1 : 0);
  }
  return text;
}

}  // namespace pellicle

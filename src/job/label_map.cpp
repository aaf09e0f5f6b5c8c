#include "pellicle/job/label_map.h"

#include <algorithm>
#include <limits>

#include "pellicle/job/measure.h"
#include "pellicle/job/voxels.h"
#include "pellicle/raster/joint_labels.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {

namespace {

constexpr int kMargin = 2, kMarginOfMany = 1;  // voxels around an object

void add_fraction(const Box& box, const Image<float>& own, Image<float>& fraction) {
  for_each_voxel(box, fraction.grid, [&](std::size_t outer, std::size_t inner, bool) {
    fraction.voxels[outer] = std::min(1.0F, fraction.voxels[outer] + own.voxels[inner]);
  });
}

/// One object by itself, with OpenVDB's mask beside ours.
void add_object(ObjectResult& object, VoxelMaps& maps) {
  const ImageGrid& grid = maps.labels.grid;
  const Box box = box_around(object.mesh, grid, kMargin);
  if (box.empty()) return;
  const MaskResult raster = rasterize_mask_checked(object.mesh, box.grid);
  if (raster.openvdb_volume_mm3) object.volume_openvdb_ml = *raster.openvdb_volume_mm3 / 1000.0;
  object.volume_mesh_ml = raster.mesh_volume_mm3 / 1000.0;
  std::size_t count = 0;
  for_each_voxel(box, grid, [&](std::size_t outer, std::size_t inner, bool border) {
    if (raster.mask.voxels[inner] == 0) return;
    ++count;
    object.touches_border = object.touches_border || border;
    maps.labels.voxels[outer] = static_cast<std::uint16_t>(object.label);
  });
  object.volume_mask_ml = static_cast<double>(count) * grid.voxel_volume() / 1000.0;
  const Image<float> fraction = rasterize_partial_volume(object.mesh, box.grid);
  double sum = 0.0;
  for (const float f : fraction.voxels) sum += static_cast<double>(f);
  object.volume_partial_ml = sum * grid.voxel_volume() / 1000.0;
  if (!maps.fraction.voxels.empty()) add_fraction(box, fraction, maps.fraction);
}

/// Labels of several objects, each voxel given to one of them.
Image<std::uint16_t> label_jointly(std::vector<ObjectResult>& objects, const ImageGrid& grid) {
  std::vector<const TriangleMesh*> meshes;
  std::vector<std::uint16_t> labels;
  for (const ObjectResult& object : objects) {
    meshes.push_back(&object.mesh);
    labels.push_back(static_cast<std::uint16_t>(object.label));
  }
  JointLabels joint = label_together(meshes, labels, grid);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    objects[i].volume_mask_ml = static_cast<double>(joint.voxels[i]) * grid.voxel_volume() / 1000.0;
    objects[i].overlap_voxels = joint.shared[i];
  }
  return std::move(joint.labels);
}

/// Which labels stand in the outermost voxels.
std::vector<bool> labels_at_border(const Image<std::uint16_t>& labels) {
  std::vector<bool> at(std::numeric_limits<std::uint16_t>::max() + std::size_t{1}, false);
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

void add_many(std::vector<ObjectResult>& objects, const ImageGrid& grid, VoxelMaps& maps) {
  maps.labels = label_jointly(objects, grid);
  const std::vector<bool> at_border = labels_at_border(maps.labels);
  for (ObjectResult& object : objects) {
    object.touches_border = at_border[static_cast<std::size_t>(object.label)];
    if (maps.fraction.voxels.empty()) continue;
    const Box box = box_around(object.mesh, grid, kMarginOfMany);
    if (!box.empty()) add_fraction(box, rasterize_partial_volume(object.mesh, box.grid), maps.fraction);
  }
}

}  // namespace

VoxelMaps label_map(std::vector<ObjectResult>& objects, const ImageGrid& grid, const SegmentOptions& options) {
  VoxelMaps maps;
  if (options.fraction_map) maps.fraction = Image<float>(grid);
  if (options.many) {
    add_many(objects, grid, maps);
    return maps;
  }
  maps.labels = Image<std::uint16_t>(grid);
  for (ObjectResult& object : objects) add_object(object, maps);
  if (objects.size() > 1) maps.labels = label_jointly(objects, grid);
  return maps;
}

Image<float> distance_map(const std::vector<ObjectResult>& objects, const ImageGrid& grid,
                          const SegmentOptions& options) {
  if (options.many) {
    const double furthest = grid.extent().norm();
    if (objects.empty()) return Image<float>(grid, static_cast<float>(furthest));
    return rasterize_signed_distance(merged_mesh(objects), grid, furthest);
  }
  Image<float> nearest(grid, std::numeric_limits<float>::max());
  for (const ObjectResult& object : objects) {
    const Image<float> distance = signed_distance(object.surface, object.mesh, grid);
    for (std::size_t i = 0; i < distance.voxels.size(); ++i) {
      nearest.voxels[i] = std::min(nearest.voxels[i], distance.voxels[i]);
    }
  }
  return nearest;
}

}  // namespace pellicle

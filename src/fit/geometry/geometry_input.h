#pragma once
/// What a surface is fitted to: points or a closed surface, and the solid that they enclose.

#include <optional>
#include <string>
#include <vector>

#include "pellicle/fit/geometry/point_fit.h"
#include "pellicle/image/image.h"
#include "pellicle/mesh/files/point_file.h"

namespace pellicle {

enum class GeometryKind { points, grid, mesh, mask };
std::string to_string(GeometryKind kind);

struct GeometryInput {
  GeometryKind kind = GeometryKind::points;
  std::string name;  ///< what messages call it
  GeometryData data;
  TriangleMesh solid;        ///< closed, outward, of genus 0: the data or a shell around them; empty: none was found
  Image<std::uint8_t> body;  ///< solid voxels of the data's own genus: where surfaces with handles start
  int genus = 0;             ///< of the data; of points that of `body`
  bool open = false;         ///< the data end at data.rim; `body` is filled up to the mouth
  double bridged_mm = 0.0;   ///< gaps up to about this wide were bridged to close `solid`
  std::optional<PointGrid> grid;      ///< points on a grid of parameters
  std::vector<std::string> warnings;  ///< one sentence each, for the user
};

/// Points, on a grid of parameters or not. Points far from all others get weight 0, with a warning.
/// \param open the points are those of an open surface, whose rim is looked for.
/// \throws BadData for fewer than ten points, points in one plane, points that enclose nothing, and, when open, points
/// without a rim; SettingError for a grid that is open.
GeometryInput geometry_of_points(PointCloud cloud, const std::string& name, bool open = false);

/// A mesh that is not a closed surface of one part is sampled and treated as points, with a warning.
/// \throws BadData for a mesh without area; as geometry_of_points.
GeometryInput geometry_of_mesh(TriangleMesh mesh, const std::string& name, bool open = false);

/// The surface of the largest part of a mask.
/// \throws BadData for a mask without a voxel.
GeometryInput geometry_of_mask(Image<std::uint8_t> mask, const std::string& name);

}  // namespace pellicle

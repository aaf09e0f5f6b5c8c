#pragma once
/// What `pellicle fit` reads: points, meshes and masks, made ready for a fit.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/fit/point_fit.h"
#include "pellicle/image/image.h"
#include "pellicle/mesh/files/point_file.h"

namespace pellicle {

struct GeometryInput {
  std::string kind;  ///< "points", "grid", "mesh", "mask"
  std::filesystem::path file;
  GeometryData data;
  TriangleMesh solid;        ///< closed, outward, of genus 0: the data or a shell around them; empty: none was found
  Image<std::uint8_t> body;  ///< solid voxels of the data's own genus: where surfaces with handles start
  int genus = 0;             ///< of the data; of points that of `body`
  bool open = false;         ///< the data end at data.rim; `body` is filled up to the mouth
  double bridged_mm = 0.0;   ///< gaps up to about this wide were bridged to close `solid`
  std::optional<PointGrid> grid;  ///< points on a grid of parameters
  std::vector<std::string> warnings;
};

/// By extension: points (mesh/point_file.h), meshes (mesh/mesh_file.h), anything else is a mask or label map, FILE or
/// FILE:LABEL. Meshes that are no closed surface of one part are sampled and treated as points, with a warning.
/// \throws NoInput, BadData (unreadable, empty, fewer than ten points, all in one plane), UsageError (a label for
/// something that is no mask).
/// \param open the points (or the mesh's) are those of an open surface: their rim is looked for; BadData without one,
/// UsageError for a mask or a grid.
GeometryInput read_geometry(const std::string& argument, bool open = false);

}  // namespace pellicle

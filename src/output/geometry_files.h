#pragma once
/// Files that `pellicle fit` reads: points, meshes and masks.

#include <string>

#include "pellicle/fit/geometry/geometry_input.h"

namespace pellicle {

/// By extension: points (mesh/files/point_file.h), meshes (mesh/files/mesh_file.h); anything else is a mask or label
/// map, FILE or FILE:LABEL.
/// \param open the points (or the mesh's) are those of an open surface.
/// \throws NoInput, BadData (unreadable or empty), SettingError (a label for something that is not a mask, an open
/// mask); as geometry_of_points.
GeometryInput read_geometry(const std::string& argument, bool open = false);

}  // namespace pellicle

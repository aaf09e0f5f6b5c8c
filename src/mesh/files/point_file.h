#pragma once
/// Files of points without facets: .xyz, .pts, .csv, .pcd and .ply. Coordinates are LPS mm as they stand.

#include <filesystem>

#include "pellicle/mesh/points/point_cloud.h"

namespace pellicle {

/// Whether a file holds points and no facets: by extension, and for .ply by its header.
bool is_point_file(const std::filesystem::path& path);

/// .xyz and .pts: three numbers a line, more are left alone; a first line with the count alone, comments (#) and the
///   one-letter records of the WA3D .pts ("p x y z") are understood; .pts of the kind "[Expe/PointSet/Binary/0.1]" too.
/// .csv: columns x,y,z[,weight] by name in any order, or in this order without names; separated by comma, semicolon
///   or tab. With columns u_index,v_index (or k,l): a grid, each cell once; rows in which all points are the same
///   (poles) may be given by one of them.
/// .pcd: ascii, binary and binary_compressed; points that are NaN are missing by that format's convention and left out.
/// .ply: the vertices.
/// \throws NoInput, BadData naming the file, the line and the fault (empty, not finite, truncated, wrong columns).
PointCloud read_points(const std::filesystem::path& path);

}  // namespace pellicle

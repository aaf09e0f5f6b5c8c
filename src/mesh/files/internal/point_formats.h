#pragma once
/// Readers of point formats, one each.

#include <cstddef>
#include <string>
#include <string_view>

#include "pellicle/mesh/points/point_cloud.h"

namespace pellicle::point_formats {

struct Source {
  std::string_view bytes;
  std::string name;
};

/// \throws BadData "cannot read points (NAME): WHY".
[[noreturn]] void fail(const Source& source, const std::string& why);
void check_finite(const Source& source, const Vec3& x, std::size_t line);

/// .xyz and .pts: a point in each line.
PointCloud read_lines(const Source& source);
/// .csv: columns by name or in order, or a grid.
PointCloud read_csv(const Source& source);
/// .pts of the kind "[Expe/PointSet/Binary/0.1]".
PointCloud read_expe(const Source& source);
/// Point Cloud Library's format, versions 0.5 to 0.7.
PointCloud read_pcd(const Source& source);

}  // namespace pellicle::point_formats

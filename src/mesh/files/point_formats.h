#pragma once
/// Readers of point formats; for this folder's sources only.

#include <string>
#include <string_view>

#include "pellicle/mesh/files/point_file.h"

namespace pellicle::point_formats {

struct Source {
  std::string_view bytes;
  std::string name;
};

/// \throws BadData "cannot read points (NAME): WHY".
[[noreturn]] void fail(const Source& source, const std::string& why);
void check_finite(const Source& source, const Vec3& x, std::size_t line);

/// Point Cloud Library's format, versions 0.5 to 0.7.
PointCloud read_pcd(const Source& source);

}  // namespace pellicle::point_formats

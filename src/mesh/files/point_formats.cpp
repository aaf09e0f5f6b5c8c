#include "pellicle/mesh/files/internal/point_formats.h"

#include <fmt/format.h>

#include "pellicle/base/errors.h"

namespace pellicle::point_formats {

void fail(const Source& source, const std::string& why) {
  throw BadData(fmt::format("cannot read points ({}): {}", source.name, why));
}

void check_finite(const Source& source, const Vec3& x, std::size_t line) {
  if (!x.allFinite()) fail(source, fmt::format("line {}: a coordinate is not finite", line));
}

}  // namespace pellicle::point_formats

#include "pellicle/output/viewer_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "pellicle/base/parallel.h"
#include "pellicle/picture/slice_view.h"

namespace pellicle {

namespace {

struct Bounds {
  Index3 from{0, 0, 0}, to{0, 0, 0};  ///< voxels, `to` not included
  int length(std::size_t axis) const { return to[axis] - from[axis]; }
};

Bounds bounds_around(const ImageGrid& grid, const std::vector<TriangleMesh>& meshes) {
  Bounds bounds{{0, 0, 0}, grid.size};
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  for (const auto& mesh : meshes) {
    for (const auto& vertex : mesh.vertices) {
      const Vec3 index = grid.index_from_world(vertex);
      low = low.cwiseMin(index);
      high = high.cwiseMax(index);
    }
  }
  if (!(low[0] <= high[0])) return bounds;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    const double last = static_cast<double>(grid.size[a] - 1);
    const double margin = std::max(6.0, 0.25 * (high[axis] - low[axis]));
    // A surface that left the image altogether still gets a voxel.
    bounds.from[a] = static_cast<int>(std::floor(std::clamp(low[axis] - margin, 0.0, last)));
    bounds.to[a] = static_cast<int>(std::ceil(std::clamp(high[axis] + margin, 0.0, last))) + 1;
  }
  return bounds;
}

Index3 block_sizes(const ImageGrid& grid, const Bounds& bounds, int edge) {
  const double most = std::pow(static_cast<double>(edge), 3);
  Index3 block{1, 1, 1};
  for (double target = grid.spacing.minCoeff();; target *= 1.1) {
    double count = 1.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double factor = std::round(target / grid.spacing[static_cast<Eigen::Index>(a)]);
      block[a] = static_cast<int>(std::clamp(factor, 1.0, static_cast<double>(bounds.length(a))));
      count *= std::ceil(static_cast<double>(bounds.length(a)) / block[a]);
    }
    if (count <= most) return block;
  }
}

std::uint8_t grey_of(double value, const Window& window) {
  const double grey = std::clamp((value - window.black) / (window.white - window.black), 0.0, 1.0);
  return static_cast<std::uint8_t>(std::lround(255.0 * grey));
}

template <class T>
void append(std::string& bytes, const T& value) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));  // little-endian, as the format wants and every machine here has it
  bytes.append(raw.data(), raw.size());
}

}  // namespace

Image<std::uint8_t> cut_out(const Image<float>& image, const std::vector<TriangleMesh>& meshes, int edge) {
  const ImageGrid& grid = image.grid;
  const Bounds bounds = bounds_around(grid, meshes);
  const Index3 block = block_sizes(grid, bounds, edge);
  ImageGrid small = grid;
  Vec3 first;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    small.size[a] = (bounds.length(a) + block[a] - 1) / block[a];
    small.spacing[axis] = grid.spacing[axis] * block[a];
    first[axis] = bounds.from[a] + 0.5 * (block[a] - 1);
  }
  small.origin_in_world = grid.world_from_index(first);
  const Window window = robust_window(image);
  Image<std::uint8_t> result(small);
  const auto average = [&](int i, int j, int k) {
    std::array<int, 3> from{}, to{};
    const Index3 at{i, j, k};
    for (std::size_t a = 0; a < 3; ++a) {
      from[a] = bounds.from[a] + at[a] * block[a];
      to[a] = std::min(from[a] + block[a], bounds.to[a]);
    }
    double sum = 0.0;
    for (int z = from[2]; z < to[2]; ++z) {
      for (int y = from[1]; y < to[1]; ++y) {
        for (int x = from[0]; x < to[0]; ++x) sum += static_cast<double>(image.at(x, y, z));
      }
    }
    return sum / (static_cast<double>(to[0] - from[0]) * (to[1] - from[1]) * (to[2] - from[2]));
  };
  parallel_for(static_cast<std::size_t>(small.size[2]), 1, [&](std::size_t begin, std::size_t end) {
    for (int k = static_cast<int>(begin); k < static_cast<int>(end); ++k) {
      for (int j = 0; j < small.size[1]; ++j) {
        for (int i = 0; i < small.size[0]; ++i) result.at(i, j, k) = grey_of(average(i, j, k), window);
      }
    }
  });
  return result;
}

std::string mz3_of(const std::vector<TriangleMesh>& meshes, const std::vector<Rgb>& colors) {
  std::uint32_t triangles = 0, vertices = 0;
  for (const auto& mesh : meshes) {
    triangles += static_cast<std::uint32_t>(mesh.triangles.size());
    vertices += static_cast<std::uint32_t>(mesh.vertices.size());
  }
  std::string bytes;
  bytes.reserve(16 + 12 * static_cast<std::size_t>(triangles) + 16 * static_cast<std::size_t>(vertices));
  constexpr std::uint16_t magic = 0x5A4D, faces_vertices_colors = 1 | 2 | 4;
  append(bytes, magic);
  append(bytes, faces_vertices_colors);
  append(bytes, triangles);
  append(bytes, vertices);
  append(bytes, std::uint32_t{0});
  std::int32_t first = 0;
  for (const auto& mesh : meshes) {
    for (const auto& triangle : mesh.triangles) {
      for (const int corner : triangle) append(bytes, static_cast<std::int32_t>(corner) + first);
    }
    first += static_cast<std::int32_t>(mesh.vertices.size());
  }
  for (const auto& mesh : meshes) {
    for (const auto& vertex : mesh.vertices) {
      const Eigen::Vector3f ras = flip_lps_ras(vertex).cast<float>();
      for (int a = 0; a < 3; ++a) append(bytes, ras[a]);
    }
  }
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    for (std::size_t v = 0; v < meshes[m].vertices.size(); ++v) {
      for (const std::uint8_t part : colors.at(m)) append(bytes, part);
      append(bytes, std::uint8_t{255});
    }
  }
  return bytes;
}

std::vector<TriangleMesh> viewing_meshes(const std::vector<Surface>& surfaces, std::size_t most_triangles) {
  int lower = 0;
  for (std::vector<TriangleMesh> meshes;; ++lower) {
    meshes.clear();
    meshes.reserve(surfaces.size());
    std::size_t triangles = 0;
    bool lowest = true;
    for (const auto& surface : surfaces) {
      const int level = std::max(0, viewing_level(surface) - lower);
      lowest = lowest && level == 0;
      meshes.push_back(tessellate(surface, level));
      triangles += meshes.back().triangles.size();
    }
    if (triangles <= most_triangles || lowest) return meshes;
  }
}

Rgb object_color(std::size_t index) {
  static const std::array<Rgb, 7> colors{
      {{230, 159, 0}, {86, 180, 233}, {0, 158, 115}, {240, 228, 66}, {213, 94, 0}, {204, 121, 167}, {0, 114, 178}}};
  return colors[index % colors.size()];
}

}  // namespace pellicle

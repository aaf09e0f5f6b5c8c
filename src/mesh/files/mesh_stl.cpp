// STL, ascii and binary. The format has no common vertices: equal positions are merged on reading.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <numeric>

#include "pellicle/mesh/files/internal/mesh_formats.h"

namespace pellicle::mesh_formats {

namespace {

constexpr std::size_t kHeader = 80, kFacet = 50;

std::uint32_t little_u32(const char* at) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(at[i]);
  return value;
}

void append_u32(std::string& out, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) out += static_cast<char>(value >> (8 * i) & 255U);
}

// Three corners per facet -> common vertices in order of first use; facets that lost their area to merging go.
TriangleMesh merged(const std::vector<Vec3>& corners) {
  std::vector<std::uint32_t> order(corners.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 &p = corners[a], &q = corners[b];
    for (int i = 0; i < 3; ++i) {
      if (p[i] != q[i]) return p[i] < q[i];
    }
    return a < b;
  };
  std::sort(order.begin(), order.end(), less);
  std::vector<std::uint32_t> first(corners.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && corners[order[i]] == corners[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  TriangleMesh mesh;
  std::vector<int> vertex(corners.size(), -1);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    std::array<int, 3> t{};
    for (std::size_t c = 0; c < 3; ++c) {
      int& v = vertex[first[i + c]];
      if (v < 0) {
        v = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(corners[i + c]);
      }
      t[c] = v;
    }
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  }
  return mesh;
}

void require_finite(const Source& source, const std::vector<Vec3>& corners) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!corners[i].allFinite()) fail(source, fmt::format("facet {} has a corner that is not finite", i / 3));
  }
}

std::vector<Vec3> read_ascii(const Source& source) {
  std::vector<Vec3> corners;
  TextCursor text(source.bytes);
  for (std::string_view word = text.next_word(); !word.empty(); word = text.next_word()) {
    if (word != "vertex") continue;
    Vec3 x;
    for (int a = 0; a < 3; ++a) {
      if (!parse_number(text.next_word(), x[a])) fail(source, fmt::format("vertex {} is incomplete", corners.size()));
    }
    corners.push_back(x);
  }
  if (corners.size() % 3 != 0) fail(source, "its last facet has fewer than three vertices");
  return corners;
}

std::vector<Vec3> read_binary(const Source& source, std::size_t facets) {
  std::vector<Vec3> corners;
  corners.reserve(3 * facets);
  const char* at = source.bytes.data() + kHeader + 4;
  for (std::size_t f = 0; f < facets; ++f, at += kFacet) {
    for (std::size_t c = 1; c <= 3; ++c) {  // 0 is the normal
      Vec3 x;
      for (std::size_t a = 0; a < 3; ++a) {
        x[static_cast<int>(a)] = static_cast<double>(std::bit_cast<float>(little_u32(at + 12 * c + 4 * a)));
      }
      corners.push_back(x);
    }
  }
  return corners;
}

}  // namespace

TriangleMesh read_stl(const Source& source) {
  const std::string_view bytes = source.bytes;
  const bool has_count = bytes.size() >= kHeader + 4;
  const std::size_t facets = has_count ? little_u32(bytes.data() + kHeader) : 0;
  std::vector<Vec3> corners;
  // The size decides, not the first word: some binary files start with "solid".
  if (has_count && bytes.size() == kHeader + 4 + kFacet * facets) {
    corners = read_binary(source, facets);
  } else if (bytes.substr(0, 5) == "solid") {
    corners = read_ascii(source);
  } else {
    fail(source, has_count
                     ? fmt::format("it claims {} facets, which does not agree with its {} bytes", facets, bytes.size())
                     : std::string("it is too short for STL"));
  }
  require_finite(source, corners);
  TriangleMesh mesh = merged(corners);
  if (bytes.substr(0, kHeader).find("SPACE=RAS") != std::string_view::npos) flip_lps_ras(mesh);
  return mesh;
}

std::string write_stl(const TriangleMesh& mesh) {
  std::string out = "binary STL, units mm, SPACE=LPS";
  out.resize(kHeader, ' ');
  append_u32(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  out.reserve(out.size() + kFacet * mesh.triangles.size());
  const auto append = [&](const Vec3& x) {
    for (int a = 0; a < 3; ++a) append_u32(out, std::bit_cast<std::uint32_t>(static_cast<float>(x[a])));
  };
  for (const auto& t : mesh.triangles) {
    const auto vertex = [&](std::size_t i) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(t[i])]; };
    const Vec3 normal = (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0));
    append(normal.stableNormalized());
    for (std::size_t i = 0; i < 3; ++i) append(vertex(i));
    out.append(2, '\0');
  }
  return out;
}

}  // namespace pellicle::mesh_formats

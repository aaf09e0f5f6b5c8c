#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>

#include "pellicle/base/parallel.h"
#include "pellicle/mesh/internal/embree_scene.h"
#include "pellicle/mesh/internal/exact_predicates.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

namespace {

struct Candidates {
  const TriangleMesh& mesh;
  std::mutex mutex;
  std::vector<std::uint64_t> pairs;  ///< smaller index in the upper half
};

void bounds_of(const RTCBoundsFunctionArguments* args) {
  const auto& mesh = *static_cast<const TriangleMesh*>(args->geometryUserPtr);
  const auto& t = mesh.triangles[args->primID];
  const auto vertex = [&](std::size_t i) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(t[i])]; };
  const Vec3 lo = vertex(0).cwiseMin(vertex(1)).cwiseMin(vertex(2));
  const Vec3 hi = vertex(0).cwiseMax(vertex(1)).cwiseMax(vertex(2));
  const float infinity = std::numeric_limits<float>::infinity();
  // One float outward: boxes that touch in double overlap in single precision too.
  const auto down = [&](double v) { return std::nextafter(static_cast<float>(v), -infinity); };
  const auto up = [&](double v) { return std::nextafter(static_cast<float>(v), infinity); };
  RTCBounds& box = *args->bounds_o;
  box.lower_x = down(lo.x());
  box.lower_y = down(lo.y());
  box.lower_z = down(lo.z());
  box.upper_x = up(hi.x());
  box.upper_y = up(hi.y());
  box.upper_z = up(hi.z());
}

void collect(void* user, RTCCollision* collisions, unsigned count) {
  auto& out = *static_cast<Candidates*>(user);
  // Neighbours over an edge are most of what overlaps: left out before anything waits for the lock.
  const auto worth = [&](const RTCCollision& c) {
    const auto &s = out.mesh.triangles[c.primID0], &t = out.mesh.triangles[c.primID1];
    return c.primID0 != c.primID1 &&
           std::count_if(s.begin(), s.end(), [&](int v) { return v == t[0] || v == t[1] || v == t[2]; }) < 2;
  };
  RTCCollision* const end = std::partition(collisions, collisions + count, worth);
  const std::lock_guard lock(out.mutex);
  for (const RTCCollision* c = collisions; c != end; ++c) {
    const std::uint64_t a = c->primID0, b = c->primID1;
    out.pairs.push_back(std::min(a, b) << 32 | std::max(a, b));
  }
}

// By position, so that a seam of doubled vertices is not a contact.
bool cut(const TriangleMesh& mesh, std::size_t first, std::size_t second) {
  std::array<Vec3, 3> a, b;
  for (std::size_t i = 0; i < 3; ++i) {
    a[i] = mesh.vertices[static_cast<std::size_t>(mesh.triangles[first][i])];
    b[i] = mesh.vertices[static_cast<std::size_t>(mesh.triangles[second][i])];
  }
  int shared = 0;
  std::size_t at_a = 0, at_b = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (a[i] != b[j]) continue;
      ++shared;
      at_a = i;
      at_b = j;
    }
  }
  if (shared == 0) return triangles_meet(a, b);
  if (shared > 1) return false;
  // One common vertex: they meet elsewhere when the side opposite to it of one reaches the other.
  return segment_meets_triangle(a[(at_a + 1) % 3], a[(at_a + 2) % 3], b) ||
         segment_meets_triangle(b[(at_b + 1) % 3], b[(at_b + 2) % 3], a);
}

}  // namespace

std::vector<std::array<int, 2>> self_intersections(const TriangleMesh& mesh) {
  check_indices(mesh);
  if (mesh.triangles.size() < 2) return {};
  EmbreeScene embree;
  RTCGeometry geometry = rtcNewGeometry(embree.device(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(mesh.triangles.size()));
  rtcSetGeometryUserData(geometry, const_cast<TriangleMesh*>(&mesh));  // Embree asks for void*; only read
  rtcSetGeometryBoundsFunction(
      geometry, [](const RTCBoundsFunctionArguments* args) { bounds_of(args); }, nullptr);
  embree.commit(geometry);
  Candidates candidates{mesh, {}, {}};
  rtcCollide(embree.scene(), embree.scene(), &collect, &candidates);

  auto& pairs = candidates.pairs;
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<std::uint8_t> hit(pairs.size());
  parallel_for(pairs.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      hit[i] = cut(mesh, static_cast<std::size_t>(pairs[i] >> 32), static_cast<std::size_t>(pairs[i] & 0xffffffffU));
    }
  });
  std::vector<std::array<int, 2>> out;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (hit[i] != 0) out.push_back({static_cast<int>(pairs[i] >> 32), static_cast<int>(pairs[i] & 0xffffffffU)});
  }
  return out;
}

std::size_t self_intersection_count(const TriangleMesh& mesh) {
  return self_intersections(mesh).size();
}

}  // namespace pellicle

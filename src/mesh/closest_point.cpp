#include <algorithm>
#include <cmath>
#include <limits>

#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/internal/embree_scene.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

namespace {

Vec3 closest_on_segment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 e = b - a;
  const double length2 = e.squaredNorm();
  if (!(length2 > 0.0)) return a;
  const double t = std::clamp(e.dot(x - a) / length2, 0.0, 1.0);
  // From the nearer end, so that the end itself is met exactly.
  return t < 0.5 ? Vec3(a + t * e) : Vec3(b - (1.0 - t) * e);
}

// The foot on the plane where it lies in the triangle, else the nearest point of the three edges. Slivers, whose plane
// is not known to working accuracy, go by their edges alone: they are as thin as that accuracy.
Vec3 closest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ax = x - a;
  const Vec3 normal = ab.cross(ac);
  const double n2 = normal.squaredNorm();
  const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
  if (n2 > 1e-24 * longest2 * longest2) {
    const double v = ax.cross(ac).dot(normal), w = ab.cross(ax).dot(normal);
    if (v >= 0.0 && w >= 0.0 && v + w <= n2) return x - (ax.dot(normal) / n2) * normal;
  }
  Vec3 best = closest_on_segment(x, a, b);
  double best2 = (best - x).squaredNorm();
  for (const Vec3& y : {closest_on_segment(x, b, c), closest_on_segment(x, c, a)}) {
    const double d2 = (y - x).squaredNorm();
    if (d2 < best2) {
      best = y;
      best2 = d2;
    }
  }
  return best;
}

}  // namespace

// Embree works in single precision: the mesh is moved and scaled to [-1, 1]^3 for it, and only its boxes are trusted.
// Distances come from the vertices in double; the search radius keeps a margin above the rounding of both.
struct ClosestPoint::Scene {
  EmbreeScene embree;
  Vec3 centre = Vec3::Zero();
  double scale = 1.0;          ///< scene units per mm
  std::vector<Vec3> vertices;  ///< mm, relative to `centre`
  std::vector<std::array<int, 3>> triangles;
};

namespace {

struct Search {
  const std::vector<Vec3>* vertices;
  const std::vector<std::array<int, 3>>* triangles;
  Vec3 x;  ///< mm, relative to the centre
  double scale, margin;
  Vec3 point;
  int triangle = -1;
  double distance2;
  bool any_will_do = false;  ///< the first facet within the distance ends the search
};

bool visit(RTCPointQueryFunctionArguments* args) {
  auto& s = *static_cast<Search*>(args->userPtr);
  const auto id = static_cast<int>(args->primID);
  const auto& t = (*s.triangles)[args->primID];
  const auto vertex = [&](std::size_t i) -> const Vec3& { return (*s.vertices)[static_cast<std::size_t>(t[i])]; };
  const Vec3 y = closest_on_triangle(s.x, vertex(0), vertex(1), vertex(2));
  const double d2 = (y - s.x).squaredNorm();
  // Ties go to the lower index: the answer does not depend on the order of the tree.
  if (d2 < s.distance2 || (d2 == s.distance2 && (s.triangle < 0 || id < s.triangle))) {
    s.point = y;
    s.triangle = id;
    s.distance2 = d2;
    if (s.any_will_do) {
      args->query->radius = 0.0F;
      return true;
    }
    const auto radius = static_cast<float>(std::sqrt(d2) * s.scale * (1.0 + 1e-6) + s.margin);
    if (radius < args->query->radius) {
      args->query->radius = radius;
      return true;
    }
  }
  return false;
}

}  // namespace

ClosestPoint::ClosestPoint(const TriangleMesh& mesh) {
  check_indices(mesh);
  scene_ = std::make_unique<Scene>();
  Vec3 lo = Vec3::Constant(std::numeric_limits<double>::infinity()), hi = -lo;
  for (const Vec3& v : mesh.vertices) {
    lo = lo.cwiseMin(v);
    hi = hi.cwiseMax(v);
  }
  if (mesh.triangles.empty()) return;
  scene_->centre = 0.5 * (lo + hi);
  const double half = 0.5 * (hi - lo).maxCoeff();
  scene_->scale = half > 0.0 ? 1.0 / half : 1.0;
  scene_->triangles = mesh.triangles;
  scene_->vertices.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices) scene_->vertices.emplace_back(v - scene_->centre);

  RTCGeometry geometry = rtcNewGeometry(scene_->embree.device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* xyz = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                          3 * sizeof(float), mesh.vertices.size()));
  for (const Vec3& v : scene_->vertices) {
    for (int a = 0; a < 3; ++a) *xyz++ = static_cast<float>(v[a] * scene_->scale);
  }
  auto* index = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                               3 * sizeof(unsigned), mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    for (const int i : t) *index++ = static_cast<unsigned>(i);
  }
  scene_->embree.commit(geometry);
}

ClosestPoint::~ClosestPoint() = default;

ClosestPoint::Hit ClosestPoint::query(const Vec3& x) const {
  return query(x, std::numeric_limits<double>::infinity());
}

namespace {

void run_query(const EmbreeScene& scene, double within_mm, Search& search) {
  const Vec3 q = search.x * search.scale;
  search.margin = 1e-6 * (1.0 + q.cwiseAbs().maxCoeff());
  RTCPointQuery query;
  query.x = static_cast<float>(q.x());
  query.y = static_cast<float>(q.y());
  query.z = static_cast<float>(q.z());
  query.time = 0.0F;
  query.radius = static_cast<float>(within_mm * search.scale * (1.0 + 1e-6) + search.margin);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene.scene(), &query, &context, &visit, &search);
}

}  // namespace

ClosestPoint::Hit ClosestPoint::query(const Vec3& x, double within_mm) const {
  Search search{&scene_->vertices,    &scene_->triangles, x - scene_->centre, scene_->scale, 0.0, x, -1,
                within_mm * within_mm};
  if (!scene_->triangles.empty()) run_query(scene_->embree, within_mm, search);
  if (search.triangle < 0) return {x, -1, std::numeric_limits<double>::infinity()};
  return {search.point + scene_->centre, search.triangle, std::sqrt(search.distance2)};
}

bool ClosestPoint::is_within(const Vec3& x, double within_mm) const {
  Search search{&scene_->vertices,
                &scene_->triangles,
                x - scene_->centre,
                scene_->scale,
                0.0,
                x,
                -1,
                within_mm * within_mm,
                true};
  if (!scene_->triangles.empty()) run_query(scene_->embree, within_mm, search);
  return search.triangle >= 0;
}

}  // namespace pellicle

#include "pellicle/seed/open_seed.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/seed/seed_surface.h"
#include "pellicle/seed/voxel_seed.h"

namespace pellicle {
namespace {

constexpr int kSmoothings = 6;

/// Quads of one mesh, of which some are kept.
class Part {
 public:
  Part(const QuadMesh& mesh, std::vector<bool> kept) : mesh_(mesh), kept_(std::move(kept)) {
    for (int q = 0; q < static_cast<int>(mesh.quads.size()); ++q) {
      for (std::size_t c = 0; c < 4; ++c) {
        quad_of_[{corner(q, c), corner(q, c + 1)}] = q;
        around_[corner(q, c)].push_back(q);
      }
    }
  }

  /// Sets of kept (or of left out) quads that are joined by edges.
  std::vector<std::vector<int>> parts(bool of_kept) const {
    std::vector<bool> seen(kept_.size(), false);
    std::vector<std::vector<int>> result;
    for (int q = 0; q < static_cast<int>(kept_.size()); ++q) {
      if (seen[idx(q)] || kept_[idx(q)] != of_kept) continue;
      std::vector<int> part{q};
      seen[idx(q)] = true;
      for (std::size_t at = 0; at < part.size(); ++at) {
        for (std::size_t c = 0; c < 4; ++c) {
          const int next = beside(part[at], c);
          if (next < 0 || seen[idx(next)] || kept_[idx(next)] != of_kept) continue;
          seen[idx(next)] = true;
          part.push_back(next);
        }
      }
      result.push_back(std::move(part));
    }
    return result;
  }

  void fill_small_holes() {
    constexpr std::size_t kSmall = 4;
    for (const auto& hole : parts(false)) {
      if (hole.size() >= kSmall) continue;
      for (const int q : hole) kept_[idx(q)] = true;
    }
  }

  void keep_largest() {
    const auto all = parts(true);
    const auto largest =
        std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    kept_.assign(kept_.size(), false);
    if (largest == all.end()) return;
    for (const int q : *largest) kept_[idx(q)] = true;
  }

  /// Leaves out quads that hang by one edge and those of the smaller fans at a vertex; returns whether any was.
  bool trim() {
    bool any = false;
    for (int q = 0; q < static_cast<int>(kept_.size()); ++q) {
      if (!kept_[idx(q)]) continue;
      int joined = 0;
      for (std::size_t c = 0; c < 4; ++c) joined += is_kept(beside(q, c)) ? 1 : 0;
      if (joined > 1) continue;
      kept_[idx(q)] = false;
      any = true;
    }
    for (const auto& [vertex, quads] : around_) {
      const std::vector<std::vector<int>> fans = fans_at(vertex, quads);
      for (std::size_t f = 0; f + 1 < fans.size(); ++f) {
        for (const int q : fans[f]) kept_[idx(q)] = false;
        any = true;
      }
    }
    return any;
  }

  /// The kept quads with a strip around them, vertices renumbered.
  QuadMesh sewn() const {
    QuadMesh out;
    std::map<int, int> number;
    const auto numbered = [&](int v) {
      const auto [at, is_new] = number.try_emplace(v, static_cast<int>(out.vertices.size()));
      if (is_new) out.vertices.push_back(mesh_.vertices[idx(v)]);
      return at->second;
    };
    std::map<int, int> after, before;
    for (int q = 0; q < static_cast<int>(kept_.size()); ++q) {
      if (!kept_[idx(q)]) continue;
      Quad quad{};
      for (std::size_t c = 0; c < 4; ++c) {
        quad[c] = numbered(corner(q, c));
        if (is_kept(beside(q, c))) continue;
        after[corner(q, c)] = corner(q, c + 1);
        before[corner(q, c + 1)] = corner(q, c);
      }
      out.quads.push_back(quad);
    }
    std::map<int, int> rim;
    for (const auto& [v, next] : after) {
      rim[v] = static_cast<int>(out.vertices.size());
      out.vertices.push_back(beyond(v, before.at(v), next));
    }
    for (const auto& [v, next] : after) {
      out.quads.push_back({numbered(next), numbered(v), rim.at(v), rim.at(next)});
    }
    return out;
  }

 private:
  int corner(int quad, std::size_t c) const { return mesh_.quads[idx(quad)][c % 4]; }
  int beside(int quad, std::size_t c) const {
    const auto at = quad_of_.find({corner(quad, c + 1), corner(quad, c)});
    return at == quad_of_.end() ? -1 : at->second;
  }
  bool is_kept(int quad) const { return quad >= 0 && kept_[idx(quad)]; }

  // Kept quads around a vertex that are joined by its edges, the smallest set first.
  std::vector<std::vector<int>> fans_at(int vertex, const std::vector<int>& quads) const {
    std::vector<std::vector<int>> fans;
    std::vector<int> left;
    std::copy_if(quads.begin(), quads.end(), std::back_inserter(left), [&](int q) { return is_kept(q); });
    while (!left.empty()) {
      std::vector<int> fan{left.back()};
      left.pop_back();
      for (std::size_t at = 0; at < fan.size(); ++at) {
        for (std::size_t c = 0; c < 4; ++c) {
          if (corner(fan[at], c) != vertex && corner(fan[at], c + 1) != vertex) continue;
          const auto next = std::find(left.begin(), left.end(), beside(fan[at], c));
          if (next == left.end()) continue;
          fan.push_back(*next);
          left.erase(next);
        }
      }
      fans.push_back(std::move(fan));
    }
    std::stable_sort(fans.begin(), fans.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    return fans;
  }

  // Half an edge further than a border vertex, across the border.
  Vec3 beyond(int vertex, int previous, int next) const {
    const Vec3 &x = mesh_.vertices[idx(vertex)], along = mesh_.vertices[idx(next)] - mesh_.vertices[idx(previous)];
    Vec3 inward = Vec3::Zero();
    for (const int q : around_.at(vertex)) {
      if (!is_kept(q)) continue;
      for (std::size_t c = 0; c < 4; ++c) inward += 0.25 * (mesh_.vertices[idx(corner(q, c))] - x);
    }
    const Vec3 t = along.normalized();
    inward -= inward.dot(t) * t;
    return x - 0.25 * along.norm() * inward.normalized();
  }

  const QuadMesh& mesh_;
  std::vector<bool> kept_;
  std::map<std::pair<int, int>, int> quad_of_;  ///< by its directed edges
  std::map<int, std::vector<int>> around_;      ///< quads at a vertex
};

// The quads that lie along the points; quads that are nearer to a lid do not.
QuadMesh part_along(const QuadMesh& closed, const OpenPoints& points, const std::vector<Vec3>& lids, double reach) {
  constexpr double kAlong = 0.7;  // cosine between the quad's normal and the plane's
  const QuadMesh smooth{smoothed_vertices(closed, kSmoothings), closed.quads};
  const PointTree lid(lids);
  const auto is_lid = [&](const Vec3& x, double from_points) {
    return !lids.empty() && lid.nearest(x, 1).front().distance < from_points;
  };
  std::vector<bool> kept;
  kept.reserve(smooth.quads.size());
  for (const Quad& quad : smooth.quads) {
    const auto at = [&](std::size_t c) -> const Vec3& { return smooth.vertices[static_cast<std::size_t>(quad[c])]; };
    const Vec3 centre = 0.25 * (at(0) + at(1) + at(2) + at(3));
    const Vec3 normal = (at(2) - at(0)).cross(at(3) - at(1)).normalized();
    const auto near = points.tree.nearest(centre, 1).front();
    const Vec3& plane = points.plane_normals[static_cast<std::size_t>(near.point)];
    kept.push_back(near.distance <= reach && std::abs(normal.dot(plane)) >= kAlong && !is_lid(centre, near.distance));
  }
  Part part(smooth, std::move(kept));
  part.fill_small_holes();
  do part.keep_largest();
  while (part.trim());
  QuadMesh open = part.sewn();
  if (open.quads.empty()) throw BadData("open surface (start): no part of the start mesh lies along the points");
  return open;
}

// Parameters in equal steps that go round a closed curve once as the loop does; none when the loop does not.
std::vector<double> even_parameters(const std::vector<double>& nearest) {
  const auto n = static_cast<double>(nearest.size());
  std::vector<double> along{nearest.front()};
  for (std::size_t i = 1; i < nearest.size(); ++i) {
    along.push_back(along.back() + std::remainder(nearest[i] - nearest[i - 1], 1.0));
  }
  const double round = std::round(along.back() + std::remainder(nearest.front() - nearest.back(), 1.0) - along.front());
  if (std::abs(round) != 1.0) return {};
  double first = 0.0;
  for (std::size_t i = 0; i < along.size(); ++i) first += (along[i] - round * static_cast<double>(i) / n) / n;
  for (std::size_t i = 0; i < along.size(); ++i) along[i] = first + round * static_cast<double>(i) / n;
  return along;
}

void lay_borders(const std::vector<RimCurve>& rims, QuadMesh& mesh) {
  const RimLocator locator(rims);
  for (const std::vector<int>& loop : border_loops(split_quads(mesh).triangles)) {
    std::vector<int> votes(rims.size(), 0);
    for (const int v : loop) ++votes[idx(locator.nearest(mesh.vertices[idx(v)]).curve)];
    const auto c = static_cast<std::size_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
    const RimLocator own({rims[c]});
    std::vector<double> nearest;
    nearest.reserve(loop.size());
    for (const int v : loop) nearest.push_back(own.nearest(mesh.vertices[idx(v)]).along);
    const std::vector<double> along = even_parameters(nearest);
    for (std::size_t i = 0; i < along.size(); ++i) {
      const std::vector<Vec3>& x = rims[c].x;
      const double at = (along[i] - std::floor(along[i])) * static_cast<double>(x.size());
      const std::size_t k = std::min(static_cast<std::size_t>(at), x.size() - 1);
      const double t = at - static_cast<double>(k);
      mesh.vertices[idx(loop[i])] = (1.0 - t) * x[k] + t * x[(k + 1) % x.size()];
    }
  }
}

// Vertices inside move to the mean of their neighbours and then onto the planes through the points near them.
void spread(const OpenPoints& points, QuadMesh& mesh) {
  constexpr int kSweeps = 40, kNear = 6;
  const QuadTopology topology = quad_topology(static_cast<int>(mesh.vertices.size()), mesh.quads, Border::allowed);
  for (int k = 0; k < kSweeps; ++k) {
    std::vector<Vec3> moved = mesh.vertices;
    for (std::size_t v = 0; v < moved.size(); ++v) {
      const QuadRing& ring = topology.rings[v];
      if (!ring.closed) continue;
      Vec3 mean = Vec3::Zero();
      for (const int n : ring.edge) mean += mesh.vertices[idx(n)] / static_cast<double>(ring.edge.size());
      Vec3& x = moved[v];
      x = 0.5 * (x + mean);
      const auto near = points.tree.nearest(x, kNear);
      const Vec3& normal = points.plane_normals[idx(near.front().point)];
      double height = 0.0;
      for (const auto& n : near) {
        height += normal.dot(points.tree.points()[idx(n.point)] - x) / static_cast<double>(near.size());
      }
      x += height * normal;
    }
    mesh.vertices = std::move(moved);
  }
}

std::vector<std::vector<Vec3>> borders_of(const QuadMesh& open) {
  std::vector<std::vector<Vec3>> borders;
  for (const std::vector<int>& loop : border_loops(split_quads(open).triangles)) {
    std::vector<Vec3>& border = borders.emplace_back();
    for (const int v : loop) border.push_back(open.vertices[idx(v)]);
  }
  return borders;
}

// Mean distance of the points from the curves, and of the curves from the points, mm.
double distance_between(const std::vector<RimCurve>& curves, const RimPoints& rim) {
  const RimLocator on(curves);
  const PointTree tree(rim.x);
  double there = 0.0, back = 0.0, samples = 0.0;
  for (const Vec3& x : rim.x) there += on.nearest(x).distance / static_cast<double>(rim.x.size());
  for (const RimCurve& curve : curves) {
    for (const Vec3& x : curve.x) back += tree.nearest(x, 1).front().distance;
    samples += static_cast<double>(curve.x.size());
  }
  return there + back / samples;
}

}  // namespace

QuadMesh open_part(const QuadMesh& closed, const OpenPoints& points, double reach) {
  return part_along(closed, points, {}, reach);
}

std::vector<RimCurve> rims_of(const Image<std::uint8_t>& body, const OpenPoints& points) {
  constexpr int kGrids = 5;
  const RimPoints rim = rim_of(points.tree, points.plane_normals);
  std::vector<RimCurve> best;
  double least = 0.0, spacing = coarsest_spacing(body);
  for (int k = 0; k < kGrids; ++k, spacing /= std::numbers::sqrt2) {
    std::vector<RimCurve> curves;
    try {
      const VoxelSeed voxels = voxel_seed_of_mask(body, spacing);
      curves = rim_curves(borders_of(open_part(voxels.mesh, points, voxels.spacing_mm)), rim);
    } catch (const BadData&) {
      continue;  // a grid that shows no part along the points
    }
    if (curves.empty()) continue;
    const double here = distance_between(curves, rim);
    if (!best.empty() && here >= least) continue;
    least = here;
    best = std::move(curves);
  }
  return best;
}

std::vector<Vec3> lids_of(const std::vector<RimCurve>& rims, double spacing) {
  std::vector<Vec3> lids;
  for (const RimCurve& rim : rims) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& x : rim.x) middle += x / static_cast<double>(rim.x.size());
    for (std::size_t k = 0; k < rim.x.size(); ++k) {
      const Vec3 in = middle - rim.x[k];
      for (double s = spacing; s < in.norm(); s += spacing) lids.emplace_back(rim.x[k] + s * in.normalized());
    }
  }
  return lids;
}

QuadMesh open_part_within(const QuadMesh& closed, const OpenPoints& points, const std::vector<RimCurve>& rims,
                          double reach) {
  if (rims.empty()) throw BadData("open surface (rim): the points end nowhere");
  QuadMesh open = part_along(closed, points, lids_of(rims, point_spacing(points.tree)), reach);
  lay_borders(rims, open);
  spread(points, open);
  return open;
}

std::pair<CatmullClarkModel, Parameters> open_seed(const QuadMesh& closed, const OpenPoints& points,
                                                   const std::vector<RimCurve>& rims, double reach) {
  const QuadMesh open = open_part_within(closed, points, rims, reach);
  const int count = static_cast<int>(open.vertices.size());
  const PointRows limit = CatmullClarkModel(count, open.quads, {}, Border::allowed).limit_rows();
  Parameters control = parameters_of(compensated(limit, open.vertices));
  return {CatmullClarkModel(count, open.quads, {control, false}, Border::allowed), control};
}

}  // namespace pellicle

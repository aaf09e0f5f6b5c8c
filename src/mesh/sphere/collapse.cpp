#include "pellicle/mesh/sphere/internal/collapse.h"

#include <algorithm>
#include <cmath>
#include <queue>

namespace pellicle {

namespace {

/// Sum of squared distances to planes, each weighted by its area.
struct Quadric {
  Mat3 A = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  double c = 0.0;
  void add_plane(const Vec3& n, double d, double weight) {
    A += weight * n * n.transpose();
    b += weight * d * n;
    c += weight * d * d;
  }
  void add(const Quadric& q) {
    A += q.A;
    b += q.b;
    c += q.c;
  }
  double at(const Vec3& x) const { return std::max(0.0, x.dot(A * x) + 2.0 * b.dot(x) + c); }
};

struct Candidate {
  double cost;
  int gone, kept, version_gone, version_kept;
  bool operator<(const Candidate& other) const {  // the queue puts the largest first
    if (cost != other.cost) return cost > other.cost;
    if (gone != other.gone) return gone > other.gone;
    return kept > other.kept;
  }
};

}  // namespace

class Collapser {
 public:
  Collapser(const TriangleMesh& mesh, CollapsedMesh& out) : mesh_(mesh), m_(out) {
    const std::size_t n = mesh.vertices.size();
    for (const Vec3& v : mesh.vertices) centre_ += v / static_cast<double>(n);
    for (const Vec3& v : mesh.vertices) size2_ = std::max(size2_, (v - centre_).squaredNorm());
    m_.triangles_ = mesh.triangles;
    m_.gone_.assign(mesh.triangles.size(), false);
    m_.at_.resize(n);
    m_.alive_ = static_cast<int>(n);
    quadrics_.resize(n);
    version_.assign(n, 0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) add_triangle(static_cast<int>(t));
  }

  void run() {
    for (int v = 0; v < m_.all_vertices(); ++v) {
      for (const int w : neighbours(v)) push(v, w);
    }
    while (m_.alive_ > 4 && !queue_.empty()) {
      const Candidate c = queue_.top();
      queue_.pop();
      if (m_.at_[idx(c.gone)].empty() || m_.at_[idx(c.kept)].empty()) continue;
      if (version_[idx(c.gone)] != c.version_gone || version_[idx(c.kept)] != c.version_kept) continue;
      if (can_collapse(c.gone, c.kept)) collapse(c.gone, c.kept);
    }
  }

 private:
  Vec3 point(int v) const { return mesh_.vertices[idx(v)] - centre_; }

  void add_triangle(int t) {
    const auto& c = mesh_.triangles[idx(t)];
    const Vec3 area = (point(c[1]) - point(c[0])).cross(point(c[2]) - point(c[0]));
    const double size = area.norm();
    for (const int v : c) {
      m_.at_[idx(v)].push_back(t);
      if (size > 0.0) quadrics_[idx(v)].add_plane(area / size, -area.dot(point(v)) / size, size);
    }
  }

  std::vector<int> neighbours(int v) const {
    std::vector<int> ring;
    for (const int t : m_.at_[idx(v)]) {
      for (const int w : m_.triangles_[idx(t)]) {
        if (w != v) ring.push_back(w);
      }
    }
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    return ring;
  }

  void push(int gone, int kept) {
    Quadric q = quadrics_[idx(gone)];
    q.add(quadrics_[idx(kept)]);
    const Vec3 to = point(kept);
    // A little of the edge's length: on flat parts short edges go first, and vertices stay evenly spread.
    double cost = q.at(to) + 1e-4 * (to - point(gone)).squaredNorm() * (to - point(gone)).squaredNorm();
    for (const int t : m_.at_[idx(gone)]) {
      const auto& c = m_.triangles_[idx(t)];
      if (c[0] == kept || c[1] == kept || c[2] == kept) continue;
      std::array<Vec3, 3> before, after;
      for (std::size_t i = 0; i < 3; ++i) {
        before[i] = point(c[i]);
        after[i] = c[i] == gone ? to : before[i];
      }
      const Vec3 old_area = (before[1] - before[0]).cross(before[2] - before[0]);
      const Vec3 new_area = (after[1] - after[0]).cross(after[2] - after[0]);
      // Facets that would turn over wait until nothing else is left.
      if (new_area.dot(old_area) <= 0.1 * new_area.norm() * old_area.norm()) cost += size2_ * size2_;
    }
    queue_.push({cost, gone, kept, version_[idx(gone)], version_[idx(kept)]});
  }

  // The link condition: only the two corners opposite to the edge may be neighbours of both of its ends.
  bool can_collapse(int gone, int kept) const {
    const auto a = neighbours(gone), b = neighbours(kept);
    if (!std::binary_search(a.begin(), a.end(), kept)) return false;
    std::vector<int> common;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
    return common.size() == 2;
  }

  void collapse(int gone, int kept) {
    Collapse c{gone, kept, {}, {-1, -1}};
    std::size_t lost = 0;
    const std::vector<int> ring = neighbours(gone);
    for (const int t : m_.at_[idx(gone)]) {
      auto& corners = m_.triangles_[idx(t)];
      if (std::find(corners.begin(), corners.end(), kept) != corners.end()) {
        c.lost[lost++] = t;
      } else {
        std::replace(corners.begin(), corners.end(), gone, kept);
        c.moved.push_back(t);
      }
    }
    for (const int t : c.lost) {
      m_.gone_[idx(t)] = true;
      for (const int v : m_.triangles_[idx(t)]) {
        if (v != gone) std::erase(m_.at_[idx(v)], t);
      }
    }
    for (const int t : c.moved) m_.at_[idx(kept)].push_back(t);
    m_.at_[idx(gone)].clear();
    quadrics_[idx(kept)].add(quadrics_[idx(gone)]);
    ++version_[idx(kept)];
    --m_.alive_;
    m_.remaining_.push_back(std::move(c));
    for (const int w : neighbours(kept)) {
      push(kept, w);
      push(w, kept);
    }
    // The link condition of edges between two former neighbours may hold now.
    for (const int a : ring) {
      if (a == kept) continue;
      for (const int b : neighbours(a)) {
        if (b != kept && std::binary_search(ring.begin(), ring.end(), b)) push(a, b);
      }
    }
  }

  const TriangleMesh& mesh_;
  CollapsedMesh& m_;
  Vec3 centre_ = Vec3::Zero();
  double size2_ = 0.0;
  std::vector<Quadric> quadrics_;
  std::vector<int> version_;
  std::priority_queue<Candidate> queue_;
};

CollapsedMesh::CollapsedMesh(const TriangleMesh& mesh) {
  Collapser(mesh, *this).run();
}

const Collapse& CollapsedMesh::split() {
  last_ = std::move(remaining_.back());
  remaining_.pop_back();
  for (const int t : last_.moved) {
    auto& corners = triangles_[idx(t)];
    std::replace(corners.begin(), corners.end(), last_.kept, last_.gone);
    std::erase(at_[idx(last_.kept)], t);
    at_[idx(last_.gone)].push_back(t);
  }
  for (const int t : last_.lost) {
    gone_[idx(t)] = false;
    for (const int v : triangles_[idx(t)]) at_[idx(v)].push_back(t);
  }
  ++alive_;
  return last_;
}

}  // namespace pellicle

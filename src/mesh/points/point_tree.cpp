#include "pellicle/mesh/points/point_tree.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nanoflann.hpp>

namespace pellicle {

struct PointTree::Tree {
  std::vector<Vec3> points;
  // What nanoflann asks of a data set.
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<int>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
  using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Tree>, Tree, 3>;
  std::unique_ptr<Index> index;
};

PointTree::PointTree(std::vector<Vec3> points) : tree_(std::make_unique<Tree>()) {
  tree_->points = std::move(points);
  tree_->index = std::make_unique<Tree::Index>(3, *tree_, nanoflann::KDTreeSingleIndexAdaptorParams(16));
}

PointTree::~PointTree() = default;

std::vector<PointTree::Neighbour> PointTree::nearest(const Vec3& x, int count) const {
  const std::size_t n = std::min(static_cast<std::size_t>(count), tree_->points.size());
  std::vector<std::uint32_t> index(n);
  std::vector<double> squared(n);
  std::vector<Neighbour> out;
  if (n == 0) return out;
  const std::size_t found = tree_->index->knnSearch(x.data(), n, index.data(), squared.data());
  out.reserve(found);
  for (std::size_t i = 0; i < found; ++i) out.push_back({static_cast<int>(index[i]), std::sqrt(squared[i])});
  std::sort(out.begin(), out.end(), [](const Neighbour& a, const Neighbour& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.point < b.point;
  });
  return out;
}

const std::vector<Vec3>& PointTree::points() const {
  return tree_->points;
}

double point_spacing(const PointTree& tree) {
  const std::size_t n = tree.points().size();
  if (n < 2) return 0.0;
  const std::size_t stride = std::max<std::size_t>(1, n / 2000);
  std::vector<double> distance;
  distance.reserve(n / stride + 1);
  for (std::size_t i = 0; i < n; i += stride) {
    for (const auto& near : tree.nearest(tree.points()[i], 2)) {
      if (near.point != static_cast<int>(i)) {
        distance.push_back(near.distance);
        break;
      }
    }
  }
  if (distance.empty()) return 0.0;
  std::nth_element(distance.begin(), distance.begin() + static_cast<std::ptrdiff_t>(distance.size() / 2),
                   distance.end());
  return distance[distance.size() / 2];
}

}  // namespace pellicle

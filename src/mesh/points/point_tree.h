#pragma once
/// Nearest points of a cloud (nanoflann's k-d tree).

#include <memory>
#include <vector>

#include "pellicle/base/geometry.h"

namespace pellicle {

/// Holds a copy of the points; queries are thread-safe.
class PointTree {
 public:
  explicit PointTree(std::vector<Vec3> points);
  ~PointTree();
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  struct Neighbour {
    int point = -1;
    double distance = 0.0;  ///< mm
  };
  /// The `count` nearest points or as many as there are, nearest first; of equally near ones the lower number first.
  std::vector<Neighbour> nearest(const Vec3& x, int count) const;
  const std::vector<Vec3>& points() const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// Median distance of the points to their nearest other point, mm; 0 for fewer than two. Looks at 2000 points at most.
double point_spacing(const PointTree& tree);

}  // namespace pellicle

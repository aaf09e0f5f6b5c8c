#pragma once
/// Samples of the models over quad control meshes (Catmull-Clark, slime): 2^level intervals along every control edge,
/// each sample owned once.

#include <array>
#include <memory>
#include <vector>

#include "pellicle/mesh/quad/quad_mesh.h"
#include "pellicle/surface/linear_stencils.h"
#include "pellicle/surface/parameters.h"
#include "pellicle/surface/samples.h"

namespace pellicle {

/// What smoothness and spacing are measured against.
struct QuadReference {
  Parameters points;    ///< control points of the shape; empty when there is none
  bool sphere = false;  ///< they come near the unit sphere about the origin and stand for it: samples are projected
};

/// A control mesh that all copies of a model use.
struct QuadControl {
  QuadTopology topology;
  QuadReference reference;
};
/// \throws BadData for a fault of the mesh or a reference that does not fit it.
std::shared_ptr<const QuadControl> quad_control(int vertex_count, const std::vector<Quad>& quads,
                                                QuadReference reference, Border border);

/// Nodes of a grid over every quad: i counts from corner 0 to 1, j from corner 0 to 3, 0 .. intervals.
class QuadGrid {
 public:
  /// \throws UsageError unless the level is in 0 .. highest_level.
  QuadGrid(const QuadTopology& topology, int level);
  static constexpr int highest_level = 7;

  int intervals() const { return intervals_; }
  int node_count() const;
  /// The same number from each quad that has the node; nodes 0 .. vertex_count - 1 are the vertices.
  int node(int quad, int i, int j) const;
  /// The same for (i, j) counted from a corner: i towards the next corner, j towards the one before.
  int node_from_corner(int quad, int corner, int i, int j) const;
  /// Two triangles per cell, counter-clockwise, over the samples at the nodes.
  std::vector<std::array<int, 3>> triangles(const std::vector<int>& sample_of_node) const;

 private:
  const QuadTopology& topology_;  ///< outlives the grid
  int intervals_;
};

/// Weights of one sample over any control points; see LinearStencils.
struct SampleWeights {
  std::vector<int> index;
  std::vector<double> x, u, v;
  void add(int i, double wx, double wu, double wv) {
    index.push_back(i);
    x.push_back(wx);
    u.push_back(wu);
    v.push_back(wv);
  }
};
/// Appends a patch of these samples; its blocks are all control points that any of them uses.
void add_patch(SampleLayout& layout, LinearStencils& stencils, const std::vector<SampleWeights>& samples);
/// Sets level, triangles, stencils and reference of a layout whose samples are all there.
void finish_layout(SampleLayout& layout, LinearStencils stencils, const QuadGrid& grid, int level,
                   const std::vector<int>& sample_of_node, const QuadReference& reference);

/// How often a cube would be split 1 -> 4 to have about so many quads.
int refinements_of(const QuadTopology& topology);

std::vector<Vec3> points_of(const Parameters& parameters);
Parameters parameters_of(const std::vector<Vec3>& points);

}  // namespace pellicle

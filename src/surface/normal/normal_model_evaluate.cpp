#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/surface/normal/internal/normal_edge_rule.h"
#include "pellicle/surface/normal/internal/triangle_refinement.h"
#include "pellicle/surface/normal/normal_model.h"

namespace pellicle {
namespace {

constexpr int kColumns = 18;

/// Derivative of a vertex of a patch by the patch's 18 scalars (point and normal of corner 0, 1, 2).
struct VertexDerivative {
  double p[3][kColumns];
  double n[3][kColumns];
};

/// Which rule acts on control edges and which inside a control triangle.
template <EdgeRule on_edge, EdgeRule inside_triangle>
struct RulePair {
  static constexpr EdgeRule control = on_edge, interior = inside_triangle;
};

template <class Function>
void with_rules(SubdivisionRule rule, const Function& function) {
  switch (rule) {
    case SubdivisionRule::smooth:
      return function(RulePair<EdgeRule::convex, EdgeRule::convex_direction>{});
    case SubdivisionRule::published:
      return function(RulePair<EdgeRule::published, EdgeRule::published>{});
    case SubdivisionRule::balanced:
      return function(RulePair<EdgeRule::balanced, EdgeRule::balanced>{});
  }
}

Vec3 block_of(const Parameters& parameters, int block) {
  return Vec3(parameters.data() + 3 * std::size_t(block));
}

/// Room for the vertices of one patch that others depend on; made once a thread's range, never cleared.
struct PatchValues {
  explicit PatchValues(int count)
      : p(std::make_unique_for_overwrite<Vec3[]>(count)), n(std::make_unique_for_overwrite<Vec3[]>(count)) {}
  void set_corners(const Parameters& parameters, const SamplePatch& patch) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      p[corner] = block_of(parameters, patch.blocks[2 * corner]);
      n[corner] = block_of(parameters, patch.blocks[2 * corner + 1]);
    }
  }
  template <EdgeRule rule>
  PointNormal<double> refined(const RefinedVertex& v) const {
    if constexpr (rule == EdgeRule::convex_direction) {
      return refine_edge<rule, double>(p[v.a], n[v.a], p[v.b], n[v.b], p[v.left] - p[v.right]);
    }
    return refine_edge<rule, double>(p[v.a], n[v.a], p[v.b], n[v.b], p[v.a]);
  }
  template <EdgeRule rule>
  void refine_range(const TriangleRefinement& refinement, int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const PointNormal<double> vertex = refined<rule>(refinement.vertices[i]);
      p[i] = vertex.p;
      n[i] = vertex.n;
    }
  }
  /// All steps but the last.
  template <class Rules>
  void refine_coarse(const TriangleRefinement& refinement) {
    for (int k = 0; k + 1 < refinement.level; ++k) {
      const TriangleRefinement::Step& step = refinement.steps[k];
      refine_range<Rules::control>(refinement, step.edge_begin[0], step.edge_begin[3]);
      refine_range<Rules::interior>(refinement, step.edge_begin[3], step.end);
    }
  }

  std::unique_ptr<Vec3[]> p, n;
};

/// Derivatives of a vector by the six scalars of one corner.
using SixColumns = double[3][6];

void load(const double (&from)[3][kColumns], int column, SixColumns& x) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 6; ++c) x[r][c] = from[r][column + c];
  }
}

void load_difference(const double (&plus)[3][kColumns], const double (&minus)[3][kColumns], int column, SixColumns& x) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 6; ++c) x[r][c] = plus[r][column + c] - minus[r][column + c];
  }
}

void store(const SixColumns& x, int column, double (*to)[kColumns]) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 6; ++c) to[r][column + c] = x[r][c];
  }
}

void add_product(const Mat3& m, const SixColumns& x, SixColumns& y) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 6; ++c) y[r][c] += m(r, 0) * x[0][c] + m(r, 1) * x[1][c] + m(r, 2) * x[2][c];
  }
}

/// Chain rule for the columns of one corner of the patch, which begin at `column`.
/// \param n null when the normal's derivative is not wanted.
template <EdgeRule rule>
void chain_columns(const EdgeDerivative& by, const RefinedVertex& v, const VertexDerivative* all, int column,
                   double (*p)[kColumns], double (*n)[kColumns]) {
  const VertexDerivative &a = all[v.a], &b = all[v.b];
  SixColumns de, dn0, dn1, sum;
  load_difference(b.p, a.p, column, de);
  load(a.n, column, dn0);
  load(b.n, column, dn1);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 6; ++c) sum[r][c] = 0.5 * (a.p[r][column + c] + b.p[r][column + c]);
  }
  add_product(by.p_e, de, sum);
  add_product(by.p_n0, dn0, sum);
  add_product(by.p_n1, dn1, sum);
  store(sum, column, p);
  if (n == nullptr) return;
  SixColumns turn = {};
  add_product(by.n_e, de, turn);
  add_product(by.n_n0, dn0, turn);
  add_product(by.n_n1, dn1, turn);
  if constexpr (rule == EdgeRule::convex_direction) {
    SixColumns dd;
    load_difference(all[v.left].p, all[v.right].p, column, dd);
    add_product(by.n_d, dd, turn);
  }
  store(turn, column, n);
}

void clear_columns(int column, double (*p)[kColumns]) {
  for (int r = 0; r < 3; ++r) std::fill_n(p[r] + column, 6, 0.0);
}

/// Values and derivatives of one patch.
struct PatchDerivatives {
  explicit PatchDerivatives(int count) : values(count), by(std::make_unique_for_overwrite<VertexDerivative[]>(count)) {}
  void set_corners(const Parameters& parameters, const SamplePatch& patch) {
    values.set_corners(parameters, patch);
    for (int corner = 0; corner < 3; ++corner) {
      by[corner] = {};
      for (int r = 0; r < 3; ++r) by[corner].p[r][6 * corner + r] = by[corner].n[r][6 * corner + 3 + r] = 1;
    }
  }
  /// Derivative of the vertex into 3 x 18 rows of `p` and, unless null, `n`. On control edge 0..2 the columns of the
  /// corner that the edge does not touch are zero; 3 stands for inside.
  template <EdgeRule rule, bool with_normal>
  PointNormal<double> refined(const RefinedVertex& v, int edge, double (*p)[kColumns], double (*n)[kColumns]) const {
    Vec3 d = Vec3::Zero();
    if constexpr (rule == EdgeRule::convex_direction) d = values.p[v.left] - values.p[v.right];
    PointNormal<double> value;
    EdgeDerivative derivative;
    differentiate_edge<rule, with_normal>({values.p[v.a], values.n[v.a], values.p[v.b], values.n[v.b], d}, value,
                                          derivative);
    for (int corner = 0; corner < 3; ++corner) {
      if (edge == (corner + 1) % 3) {
        clear_columns(6 * corner, p);
        if (with_normal) clear_columns(6 * corner, n);
      } else {
        chain_columns<rule>(derivative, v, by.get(), 6 * corner, p, with_normal ? n : nullptr);
      }
    }
    return value;
  }
  template <EdgeRule rule>
  void refine_range(const TriangleRefinement& refinement, int edge, int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const PointNormal<double> value = refined<rule, true>(refinement.vertices[i], edge, by[i].p, by[i].n);
      values.p[i] = value.p;
      values.n[i] = value.n;
    }
  }
  template <class Rules>
  void refine_coarse(const TriangleRefinement& refinement) {
    for (int k = 0; k + 1 < refinement.level; ++k) {
      const TriangleRefinement::Step& step = refinement.steps[k];
      for (int edge = 0; edge < 3; ++edge) {
        refine_range<Rules::control>(refinement, edge, step.edge_begin[edge], step.edge_begin[edge + 1]);
      }
      refine_range<Rules::interior>(refinement, 3, step.edge_begin[3], step.end);
    }
  }

  PatchValues values;
  std::unique_ptr<VertexDerivative[]> by;
};

/// Local vertices of the last step fall into four runs (three control edges, inside): calls
/// `control(vertex, edge, sample)` or `interior(vertex, sample)` for the samples that the patch owns among them.
template <class Control, class Interior>
void for_owned_of_last_step(const SampleLayout& layout, const SamplePatch& patch, int first, const Control& control,
                            const Interior& interior) {
  const TriangleRefinement& refinement = *layout.refinement;
  const int end = patch.first_sample + patch.sample_count;
  int sample = first;
  for (int edge = 0; edge < 3 && refinement.level > 0; ++edge) {
    for (; sample < end && layout.owned_local[sample] < refinement.steps.back().edge_begin[edge + 1]; ++sample) {
      control(refinement.vertices[layout.owned_local[sample]], edge, sample);
    }
  }
  for (; sample < end; ++sample) interior(refinement.vertices[layout.owned_local[sample]], sample);
}

/// First sample of the patch that belongs to the last step; the ones before it are among the coarse vertices.
int first_of_last_step(const SampleLayout& layout, const SamplePatch& patch) {
  const auto begin = layout.owned_local.begin() + patch.first_sample;
  return patch.first_sample +
         static_cast<int>(std::lower_bound(begin, begin + patch.sample_count, layout.refinement->coarse_count()) -
                          begin);
}

template <class Rules>
void evaluate_patch(const Parameters& parameters, const SampleLayout& layout, const SamplePatch& patch,
                    PatchValues& work, SurfaceSamples& samples) {
  work.set_corners(parameters, patch);
  work.refine_coarse<Rules>(*layout.refinement);
  const int last = first_of_last_step(layout, patch);
  for (int sample = patch.first_sample; sample < last; ++sample) {
    const int local = layout.owned_local[sample];
    samples.x[sample] = work.p[local];
    samples.normal[sample] = local < 3 ? work.n[local].normalized() : work.n[local];
  }
  const auto put = [&](int sample, const PointNormal<double>& value) {
    samples.x[sample] = value.p;
    samples.normal[sample] = value.n;
  };
  for_owned_of_last_step(
      layout, patch, last,
      [&](const RefinedVertex& v, int, int sample) { put(sample, work.refined<Rules::control>(v)); },
      [&](const RefinedVertex& v, int sample) { put(sample, work.refined<Rules::interior>(v)); });
}

template <class Rules>
void differentiate_patch(const Parameters& parameters, const SampleLayout& layout, const SamplePatch& patch,
                         PatchDerivatives& work, SurfaceSamples& samples) {
  work.set_corners(parameters, patch);
  work.refine_coarse<Rules>(*layout.refinement);
  double* const jacobian = samples.jacobian.data() + patch.jacobian_offset;
  const auto rows = [&](int sample) {
    return reinterpret_cast<double(*)[kColumns]>(jacobian + std::size_t(sample - patch.first_sample) * 3 * kColumns);
  };
  const int last = first_of_last_step(layout, patch);
  for (int sample = patch.first_sample; sample < last; ++sample) {
    std::copy_n(&work.by[layout.owned_local[sample]].p[0][0], 3 * kColumns, &rows(sample)[0][0]);
  }
  for_owned_of_last_step(
      layout, patch, last,
      [&](const RefinedVertex& v, int edge, int sample) {
        work.refined<Rules::control, false>(v, edge, rows(sample), nullptr);
      },
      [&](const RefinedVertex& v, int sample) { work.refined<Rules::interior, false>(v, 3, rows(sample), nullptr); });
}

/// Cotangents of the coarse vertices of one patch.
struct PatchCotangents {
  explicit PatchCotangents(int count)
      : values(count),
        p(std::make_unique_for_overwrite<Vec3[]>(count)),
        n(std::make_unique_for_overwrite<Vec3[]>(count)) {}
  template <EdgeRule rule, bool with_normal>
  void pull_back(const RefinedVertex& v, const Vec3& bar_p, const Vec3& bar_n) {
    Vec3 d = Vec3::Zero(), bar_d = Vec3::Zero();
    if constexpr (rule == EdgeRule::convex_direction) d = values.p[v.left] - values.p[v.right];
    pull_back_edge<rule, with_normal>({values.p[v.a], values.n[v.a], values.p[v.b], values.n[v.b], d}, bar_p, bar_n,
                                      {p[v.a], n[v.a], p[v.b], n[v.b], bar_d});
    if constexpr (rule == EdgeRule::convex_direction && with_normal) {
      p[v.left] += bar_d;
      p[v.right] -= bar_d;
    }
  }

  PatchValues values;
  std::unique_ptr<Vec3[]> p, n;
};

/// \param gradient the patch's 18 scalars.
template <class Rules>
void pull_back_patch(const Parameters& parameters, const SampleLayout& layout, const SamplePatch& patch,
                     const std::vector<Vec3>& dE_dx, PatchCotangents& work, double* gradient) {
  const TriangleRefinement& refinement = *layout.refinement;
  work.values.set_corners(parameters, patch);
  work.values.refine_coarse<Rules>(refinement);
  std::fill_n(work.p.get(), refinement.coarse_count(), Vec3(Vec3::Zero()));
  std::fill_n(work.n.get(), refinement.coarse_count(), Vec3(Vec3::Zero()));
  const int last = first_of_last_step(layout, patch);
  for (int sample = patch.first_sample; sample < last; ++sample) work.p[layout.owned_local[sample]] = dE_dx[sample];
  const Vec3 none = Vec3::Zero();
  for_owned_of_last_step(
      layout, patch, last,
      [&](const RefinedVertex& v, int, int sample) { work.pull_back<Rules::control, false>(v, dE_dx[sample], none); },
      [&](const RefinedVertex& v, int sample) { work.pull_back<Rules::interior, false>(v, dE_dx[sample], none); });
  for (int k = refinement.level - 2; k >= 0; --k) {
    const TriangleRefinement::Step& step = refinement.steps[k];
    for (int i = step.end - 1; i >= step.edge_begin[3]; --i) {
      work.pull_back<Rules::interior, true>(refinement.vertices[i], work.p[i], work.n[i]);
    }
    for (int i = step.edge_begin[3] - 1; i >= step.edge_begin[0]; --i) {
      work.pull_back<Rules::control, true>(refinement.vertices[i], work.p[i], work.n[i]);
    }
  }
  for (std::size_t corner = 0; corner < 3; ++corner) {
    std::copy_n(work.p[corner].data(), 3, gradient + 6 * corner);
    std::copy_n(work.n[corner].data(), 3, gradient + 6 * corner + 3);
  }
}

/// About 1000 refined vertices a task.
std::size_t grain_of(const SampleLayout& layout) {
  return std::max<std::size_t>(1, 1000 / std::size_t(layout.refinement->vertex_count()));
}

void require(bool condition, const char* what, std::size_t have, std::size_t want) {
  if (!condition) throw BadData(fmt::format("{} (surface model): has {} entries where {} belong", what, have, want));
}

void require_match(const NormalModel& model, const Parameters& parameters, const SampleLayout& layout) {
  require(parameters.size() == std::size_t(model.parameter_count()), "parameters", parameters.size(),
          model.parameter_count());
  require(layout.patches.size() == model.triangles().size() && layout.refinement != nullptr, "sample layout",
          layout.patches.size(), model.triangles().size());
}

}  // namespace

void NormalModel::evaluate(const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
                           SurfaceSamples& samples) const {
  require_match(*this, parameters, layout);
  const std::size_t count = layout.patch_of.size();
  samples.x.resize(count);
  samples.normal.resize(count);
  samples.jacobian.resize(with_jacobian ? count * 3 * kColumns : 0);
  const int coarse = layout.refinement->coarse_count();
  with_rules(rule_, [&]<class Rules>(Rules) {
    parallel_for(layout.patches.size(), grain_of(layout), [&](std::size_t begin, std::size_t end) {
      PatchValues values(coarse);
      for (std::size_t i = begin; i < end; ++i) {
        evaluate_patch<Rules>(parameters, layout, layout.patches[i], values, samples);
      }
      if (!with_jacobian) return;
      PatchDerivatives derivatives(coarse);
      for (std::size_t i = begin; i < end; ++i) {
        differentiate_patch<Rules>(parameters, layout, layout.patches[i], derivatives, samples);
      }
    });
  });
}

void NormalModel::pull_back(const Parameters& parameters, const SampleLayout& layout, const std::vector<Vec3>& dE_dx,
                            std::vector<double>& gradient) const {
  require_match(*this, parameters, layout);
  require(dE_dx.size() == layout.patch_of.size(), "dE/dx", dE_dx.size(), layout.patch_of.size());
  require(gradient.size() == parameters.size(), "gradient", gradient.size(), parameters.size());
  std::vector<double> of_patch(layout.patches.size() * kColumns);
  with_rules(rule_, [&]<class Rules>(Rules) {
    parallel_for(layout.patches.size(), grain_of(layout), [&](std::size_t begin, std::size_t end) {
      PatchCotangents work(layout.refinement->coarse_count());
      for (std::size_t i = begin; i < end; ++i) {
        pull_back_patch<Rules>(parameters, layout, layout.patches[i], dE_dx, work, &of_patch[i * kColumns]);
      }
    });
  });
  for (std::size_t i = 0; i < layout.patches.size(); ++i) {  // one order whatever the number of threads
    for (int k = 0; k < kColumns; ++k)
      gradient[3 * layout.patches[i].blocks[k / 3] + k % 3] += of_patch[i * kColumns + k];
  }
}

}  // namespace pellicle

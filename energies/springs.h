#pragma once
/// springs: pull the surface to given points (expert points, scans, other surfaces); mm^2.
///
/// E = sum_k (w_k/W) [ (n_k . r_k)^2 + s |(I - n_k n_k^T) r_k|^2 ],   r_k = x(k) - y_k,   W = sum of the weights before
///   they are made robust
/// y_k a data point, x(k) = sum_j b_kj x_j + lift_k the point of the surface nearest to it, n_k the surface normal
/// there. Triangle and barycentric weights b are held in a step, so rows are linear in the samples; s = 0 is the
/// distance to the tangent plane (the data point may slide), s = 1 to the point. The lift carries the flat facet to the
/// smooth surface: half the mean height of the corners' tangent planes, exact to third order in the facet size.
///
/// The reverse springs pull every sample to the nearest place of a closed data surface:
/// E = sum_i (A_i/A) w_i (m_i . (x_i - y_i))^2, m_i the direction of the distance.

#include "pellicle/energies/point_targets.h"
#include "pellicle/energies/rows.h"
#include "pellicle/energies/term.h"
#include "pellicle/mesh/distance.h"

namespace pellicle {

class PointTree;

/// Threads over points, deterministic.
std::vector<Attachment> attach(const std::vector<Vec3>& points, const SampleView& surface);

/// \param weights one per point, >= 0; empty: 1 each. Points without weight or attachment give no rows.
/// \param total what the weights are divided by (W above); the energy does not fall when weights are made robust.
ScalarRows spring_rows(const SampleLayout& layout, const std::vector<Vec3>& points,
                       const std::vector<Attachment>& attachments, const std::vector<double>& weights, double total,
                       double sliding_fraction, double energy_weight);

/// Reverse springs.
/// \param reach mm: samples further from the data get no row.
/// \param data_normals of the data mesh's facets: places that face the other way are not taken; empty: all are.
ScalarRows reverse_spring_rows(const SampleView& surface, const ClosestPoint& data,
                               const std::vector<Vec3>& data_normals, double reach, double energy_weight);

/// Springs along the normals from samples that lie further than `reach` mm from every point, and off them along their
/// normals, to the nearest point: limbs that reach beyond the data.
ScalarRows overshoot_rows(const SampleView& surface, const PointTree& points, double reach, double energy_weight);

/// Tukey's biweight (1 - (r/c)^2)^2 within c = `cutoff` robust deviations of the distances, 0 beyond; the deviation is
/// at least `floor` mm.
std::vector<double> tukey_weights(const std::vector<double>& distances, double cutoff, double floor);
/// Huber's min(1, c/r), c as above: far points pull, but no harder the further off they are. (Weights that fall to
/// nothing lose whole limbs that a start lacks.)
std::vector<double> huber_weights(const std::vector<double>& distances, double cutoff, double floor);

/// Rows that draw samples along the surface to places of their own: E = sum_i (A_i/A) |(I - n_i n_i^T)(x_i - y_i)|^2.
ScalarRows sliding_rows(const SampleView& surface, const std::vector<Vec3>& targets, double energy_weight);

/// E = sum_i (A_i/A) |x_i - y_i|^2: every sample to a place of its own. \pre one target per sample.
ScalarRows target_rows(const std::vector<Vec3>& targets, const std::vector<double>& area, double energy_weight);

/// Expert points attached to the present surface. Weights are Huber's: full up to c, c/distance beyond it, c the larger
/// of 2 h and three robust deviations, so that a stray point pulls no harder the further off it is. (Weights that fall
/// to nothing would lose the points where the image leads the surface astray.)
PointTargets point_targets(const ExpertPoints& points, const SampleView& surface, double h);

/// Pulls where points are given.
struct SpringsTerm {
  TermOutput operator()(const StepView& step) const;
};

}  // namespace pellicle

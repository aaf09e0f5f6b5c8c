#include "pellicle/fit/stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "pellicle/base/parallel.h"
#include "pellicle/base/random.h"
#include "pellicle/energies/bending.h"
#include "pellicle/energies/body.h"
#include "pellicle/energies/edge.h"
#include "pellicle/energies/spacing.h"
#include "pellicle/energies/tension.h"
#include "pellicle/fit/dynamics.h"
#include "pellicle/fit/expert_points.h"
#include "pellicle/fit/linear_system.h"
#include "pellicle/fit/scalars.h"
#include "pellicle/mesh/points/point_tree.h"

namespace pellicle {

StageGeometry::StageGeometry(const SurfaceModel& model, int level) : layout(layout_of(model, level)), graph(layout) {
  // About eight samples a control triangle are enough for smoothness.
  const SampleLayout coarser = layout_of(model, std::min(level, 2));
  // A sample of the coarser level is the one of this level at the same place on the reference shape.
  double apart = 0.0, size = 0.0;
  const PointTree places(layout.reference);
  for (const Vec3& place : coarser.reference) {
    const PointTree::Neighbour nearest = places.nearest(place, 1).front();
    apart = std::max(apart, nearest.distance);
    size = std::max(size, place.norm());
    coarse.push_back(nearest.point);
  }
  if (apart > 1e-9 * size) {  // a model whose levels do not share their samples
    bending = bending_rows(layout);
    coarse.clear();
    return;
  }
  bending = bending_rows(coarser);
  for (int& s : bending.sample) s = coarse[static_cast<std::size_t>(s)];
}

const StageGeometry& GeometryCache::get(const SurfaceModel& model, int level) {
  Parameters reference = std::visit([](const auto& m) { return m.reference(); }, model);
  const Parameters somewhere = reference.empty() ? Parameters(3 * blocks_of(model).size()) : reference;
  std::vector<std::array<int, 3>> facets = control_mesh_of({model, somewhere}).triangles;
  const Key key{model.index(), level, std::move(facets), std::move(reference)};
  const std::scoped_lock lock(mutex_);
  auto at = cache_.find(key);
  if (at == cache_.end()) at = cache_.try_emplace(key, model, level).first;
  return at->second;
}

int sampling_level(const SurfaceModel& model, double area, double h, Density density) {
  const double most = density == Density::all    ? 9000.0
                      : density == Density::fine ? 4000.0
                                                 : std::max(500.0, 16.0 * control_point_count(model));
  const double share = density == Density::all ? 1.2 : 3.5;
  const double wanted = std::clamp(area / (share * h * h), 500.0, most);
  const double level = 0.5 * std::log2(2.0 * wanted / base_facets(model));
  return std::clamp(static_cast<int>(std::lround(level)), 1, 6);
}

namespace {

double weight_of(const Stage& stage, const char* name) {
  const auto at = stage.energies.find(name);
  return at == stage.energies.end() ? 0.0 : at->second;
}

/// The surface at the beginning of a step.
struct StepGeometry {
  SurfaceSamples samples;
  std::vector<double> area;
  double total_area = 0.0, volume = 0.0, radius = 0.0;
};

StepGeometry geometry_at(const Candidate& state, const StageGeometry& geometry) {
  StepGeometry g;
  evaluate(state.surface.model, state.surface.parameters, geometry.layout, false, g.samples);
  g.area = sample_areas(geometry.layout, g.samples.x);
  g.total_area = sum(g.area);
  g.volume = facet_volume(geometry.layout, g.samples.x);
  g.radius = std::cbrt(3.0 * std::abs(g.volume) / (4.0 * std::numbers::pi));
  return g;
}

class StageRun {
 public:
  StageRun(const StageContext& context, const StageRequest& request, Candidate& candidate)
      : context_(context),
        request_(request),
        stage_(request.stage),
        state_(candidate),
        h_in_(context.image.grid.mean_spacing()) {}

  StageOutcome run();

 private:
  void prepare();
  void add_operators(const StepGeometry& g);
  void keep_frame(int step, bool last);
  std::vector<NamedRows> rows_at(const StepGeometry& g, int step);
  NamedRows region_rows(const StepGeometry& g, int step);
  void reestimate_levels(const StepGeometry& g);
  NamedRows edge_rows(const StepGeometry& g, int step);
  NamedRows crossing_rows(const StepGeometry& g);
  NamedRows body_rows(const StepGeometry& g, int step);
  bool healthy(const StepGeometry& g);
  bool failed(FitStatus status, const std::string& reason) {
    state_.status = status;
    state_.reason = reason;
    return false;
  }
  void keep_within_limit(const StepGeometry& g, NormalTargets& targets) const;
  void narrow_reach(const NormalTargets& targets);
  void hold_out_samples(const StepGeometry& g, NormalTargets& targets);

  const StageContext& context_;
  const StageRequest& request_;
  const Stage& stage_;
  Candidate& state_;
  StageOutcome out_;
  double h_in_, h_ = 1.0, reach_ = 0.0, first_contrast_ = 0.0, rms_ = -1.0, edge_window_ = 2.5;
  double delay_ = 1.0;  ///< by how much slower a surface with mass and damping follows (dynamics.h); else 1
  int max_steps_ = 0;
  double edge_held_out_ = -1.0;  ///< mm, rms of the edge offsets of samples left out
  PointDistances points_ = {};
  const StageGeometry* geometry_ = nullptr;
  std::vector<GroupedOperator> operators_;
  std::optional<LinearSystem> linear_;
  std::optional<WorkingImage> image_;
  std::vector<double> curvature_;
};

void StageRun::prepare() {
  while (state_.detail < stage_.detail) {
    state_.surface = refine(state_.surface);
    ++state_.detail;
  }
  // Of many small objects each is too short a job to lay out samples anew.
  const bool one_of_many = weight_of(stage_, "body") > 0.0;
  const SampleLayout own = one_of_many ? SampleLayout{} : layout_of(state_.surface.model, 2);
  const SampleLayout& coarse = one_of_many ? context_.geometry.get(state_.surface.model, 2).layout : own;
  SurfaceSamples samples;
  evaluate(state_.surface.model, state_.surface.parameters, coarse, false, samples);
  const double area = sum(sample_areas(coarse, samples.x));
  const double radius = std::sqrt(area / (4.0 * std::numbers::pi));
  // A stage that does not need every voxel works on voxels of a fifteenth of the object's radius.
  const double resolution = stage_.resolution > 0.0 ? stage_.resolution : std::max(1.0, radius / (15.0 * h_in_));
  const double smoothing = [&](double h) {
    return stage_.smoothing_mm.value_or(stage_.smoothing * h);
  }(WorkingImage(context_.image, state_.reading, resolution, 0.0, 0.0).h());
  h_ = WorkingImage(context_.image, state_.reading, resolution, 0.0, 0.0).h();
  reach_ = request_.first_reach_mm > 0.0 ? std::max(request_.first_reach_mm, stage_.reach * h_)
                                         : std::max(stage_.reach * h_, 0.15 * radius);
  if (weight_of(stage_, "crossing") > 0.0) reach_ = std::max(reach_, 12.0);
  image_.emplace(context_.image, state_.reading, resolution, smoothing, reach_ + 8.0 * h_);
  const Density density = request_.all_samples              ? Density::all
                          : weight_of(stage_, "edge") > 0.0 ? Density::fine
                                                            : Density::coarse;
  geometry_ = &context_.geometry.get(state_.surface.model, sampling_level(state_.surface.model, area, h_, density));
  first_contrast_ = state_.levels.contrast();
  // Local levels belong to the samples of the stage that measured them.
  state_.levels.local_inside.clear();
  state_.levels.local_outside.clear();
}

// Before the closed form, which is made of them.
void StageRun::add_operators(const StepGeometry& g) {
  if (weight_of(stage_, "bending") > 0.0) {
    operators_.push_back(
        grouped_operator("bending", weight_of(stage_, "bending"), geometry_->bending, geometry_->layout));
  }
  if (weight_of(stage_, "tension") > 0.0) {
    operators_.push_back(
        grouped_operator("tension", weight_of(stage_, "tension"), tension_rows(geometry_->layout), geometry_->layout));
  }
  const bool dynamic = stage_.solver == Solver::dynamic;
  if (dynamic) {
    delay_ = delay(stage_.motion);
    operators_.push_back(motion_operator(stage_.motion, g.area, g.samples.x, geometry_->layout));
  }
  if (geometry_->layout.stencils && (dynamic || stage_.solver == Solver::least_squares)) {
    linear_.emplace(geometry_->layout, state_.surface.parameters.size() / 3, operators_);
  }
}

void StageRun::keep_frame(int step, bool last) {
  const int every = request_.trace_every;
  if (every <= 0 || (step % every != 0 && !last)) return;
  state_.trace.push_back({stage_.name, step, state_.surface});
}

// R <- max(4 h, min(0.85 R, 4 p90|t| + 3 h)): wide at first, narrow once the surface has arrived. A surface that
// follows slowly narrows it slowly.
void StageRun::narrow_reach(const NormalTargets& targets) {
  std::vector<double> size;
  for (const double t : targets.offset) size.push_back(std::abs(t));
  reach_ = std::max(4.0 * h_, std::min(std::pow(0.85, 1.0 / delay_) * reach_, 4.0 * quantile_of(size, 0.9) + 3.0 * h_));
}

NamedRows StageRun::region_rows(const StepGeometry& g, int step) {
  const double extent = reach_ + 6.5 * h_;
  const double spacing = reach_ > 10.0 * h_ ? reach_ / 20.0 : 0.5 * h_;
  const Profiles profiles =
      sample_profiles(TrilinearField(image_->image()), g.samples.x, g.samples.normal, extent, extent, spacing);
  // Not past the middle, which would turn the surface inside out: 2 V/A is the radius of a tube, two thirds of a
  // ball's.
  const double depth = 2.0 * g.volume / g.total_area;
  const NormalTargets targets = state_.reading.ridge ? ridge_search(profiles, state_.reading.sign, reach_, h_)
                                                     : region_targets(profiles, state_.levels, reach_, depth);
  if (!state_.reading.similarity && !state_.reading.ridge) {
    update_levels(profiles, targets, geometry_->graph, h_, step > 0, first_contrast_, state_.levels);
  }
  narrow_reach(targets);
  return {"region", offset_rows(g.samples.x, g.samples.normal, g.area, targets, weight_of(stage_, "region"))};
}

// The integral forms have no targets to take levels from: bands on both sides of the present surface tell them.
void StageRun::reestimate_levels(const StepGeometry& g) {
  const Profiles profiles =
      sample_profiles(TrilinearField(image_->image()), g.samples.x, g.samples.normal, 6.5 * h_, 6.5 * h_, 0.5 * h_);
  const NormalTargets here{std::vector<double>(g.area.size(), 0.0), std::vector<double>(g.area.size(), 1.0)};
  update_levels(profiles, here, geometry_->graph, h_, false, first_contrast_, state_.levels);
}

void StageRun::keep_within_limit(const StepGeometry& g, NormalTargets& targets) const {
  parallel_for(targets.weight.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (state_.limit->outline.query(g.samples.x[i], state_.limit->length).triangle < 0) targets.weight[i] = 0.0;
    }
  });
}

NamedRows StageRun::edge_rows(const StepGeometry& g, int step) {
  const double extent = (state_.reading.ridge ? 8.25 : 4.25) * h_;
  edge_window_ = std::max(1.75, step == 0 ? 2.5 : std::pow(0.9, 1.0 / delay_) * edge_window_);
  const Profiles profiles =
      sample_profiles(TrilinearField(image_->image()), g.samples.x, g.samples.normal, extent, extent, 0.25 * h_);
  EdgeMeasurement m = measure_edge(profiles, geometry_->graph,
                                   {h_, edge_window_, state_.reading.ridge, state_.reading.sign > 0.0 ? 1 : -1});
  if (step < 2.0 * delay_) {
    curvature_ = sum_of_curvatures(geometry_->layout, g.samples.x, g.samples.normal);
    average_over_mesh(geometry_->graph, 8, curvature_);
    state_.blur_mm = m.blur > 0.0 ? m.blur : 1.1 * h_;
  }
  downweight_outliers(h_, m.targets);
  if (state_.limit) keep_within_limit(g, m.targets);
  add_curvature_correction(curvature_, state_.blur_mm, h_, m.targets);
  hold_out_samples(g, m.targets);
  if (m.median_contrast > 0.0 && !state_.reading.similarity) {
    state_.levels.inside = median_of(m.inside);
    state_.levels.outside = median_of(m.outside);
  }
  return {"edge", offset_rows(g.samples.x, g.samples.normal, g.area, m.targets, weight_of(stage_, "edge"))};
}

// Root mean square of the offsets over the samples that take part and, when asked for, over those that do not; and how
// alike neighbours are (Moran 1950).
void StageRun::hold_out_samples(const StepGeometry& g, NormalTargets& targets) {
  double products = 0.0, pairs = 0.0, own = 0.0, count = 0.0;
  for (std::size_t i = 0; i < g.area.size(); ++i) {
    const double here = targets.weight[i] > 0.0 ? targets.offset[i] : 0.0;
    own += here * here;
    count += 1.0;
    for (int k = geometry_->graph.start[i]; k < geometry_->graph.start[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(geometry_->graph.neighbour[static_cast<std::size_t>(k)]);
      products += here * (targets.weight[j] > 0.0 ? targets.offset[j] : 0.0);
      pairs += 1.0;
    }
  }
  out_.residual_correlation = own > 0.0 ? products / pairs / (own / count) : 1.0;
  double squares[2] = {0.0, 0.0}, weights[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < g.area.size(); ++i) {
    const bool out = request_.hold_out && RandomEngine(i).next() % 4 == 0;
    const double w = g.area[i] * targets.weight[i];
    squares[out ? 1 : 0] += w * targets.offset[i] * targets.offset[i];
    weights[out ? 1 : 0] += w;
    if (out) targets.weight[i] = 0.0;
  }
  rms_ = weights[0] > 0.0 ? std::sqrt(squares[0] / weights[0]) : -1.0;
  if (!request_.hold_out) return;
  edge_held_out_ = weights[1] > 0.0 ? std::sqrt(squares[1] / weights[1]) : -1.0;
  out_.held_out_rms = edge_held_out_;
}

NamedRows StageRun::crossing_rows(const StepGeometry& g) {
  const TrilinearField field(image_->image());
  TissueLevels levels = *state_.reading.tissue;
  if (state_.detail > 1) {
    // Median of the tissue inside the present surface: twelve concentric copies of equal share of the volume.
    Vec3 centre = Vec3::Zero();
    for (std::size_t i = 0; i < g.area.size(); ++i) centre += g.area[i] / g.total_area * g.samples.x[i];
    std::vector<double> values;
    for (int shell = 0; shell < 12; ++shell) {
      const double scale = std::cbrt((shell + 0.5) / 12.0);
      for (const Vec3& x : g.samples.x) values.push_back(field.at(centre + scale * (x - centre)));
    }
    levels.middle = median_of(values);
  }
  CrossingSettings settings;
  const Profiles profiles =
      sample_profiles(field, g.samples.x, g.samples.normal, settings.depth, settings.reach, std::min(1.0, h_));
  const NormalTargets targets = crossing_targets(profiles, geometry_->graph, levels, settings);
  return {"crossing", offset_rows(g.samples.x, g.samples.normal, g.area, targets, weight_of(stage_, "crossing"))};
}

// A wide search first, ever narrower ones later: half widths 0.6 to 0.35 of the radius.
NamedRows StageRun::body_rows(const StepGeometry& g, int step) {
  const OneOfMany& crowd = state_.one_of_many;
  const double done = max_steps_ > 1 ? static_cast<double>(step) / (max_steps_ - 1) : 1.0;
  std::vector<double> cap;
  BodySearch search{.sign = state_.reading.sign,
                    .half_width = 0.6 + done * (0.35 - 0.6),
                    .least_radius = 0.3 * crowd.radius,
                    .most_radius = 2.2 * crowd.radius,
                    .unblur = true,
                    .territory = crowd.territory};
  const bool typical = crowd.typical != nullptr && crowd.typical->size() == g.area.size();
  if (typical) {
    for (const double r : *crowd.typical) cap.push_back(1.6 * r);
    search.cap = &cap;
  }
  const BodyReading reading = read_body(TrilinearField(image_->image()), g.samples.x, g.samples.normal, g.area, search);
  state_.levels.inside = reading.inside;
  state_.levels.outside = reading.beyond;
  const double weight = weight_of(stage_, "body");
  NamedRows rows{"body", offset_rows(g.samples.x, g.samples.normal, g.area, reading.targets, weight)};
  if (typical) {
    // A twentieth of the weight draws the surface towards the shape that objects of this kind have.
    NormalTargets alike{std::vector<double>(g.area.size()), std::vector<double>(g.area.size(), 0.05)};
    for (std::size_t i = 0; i < g.area.size(); ++i) alike.offset[i] = (*crowd.typical)[i] - reading.reach[i];
    const ScalarRows more = offset_rows(g.samples.x, g.samples.normal, g.area, alike, weight);
    for (std::size_t row = 0; row < more.size(); ++row) {
      rows.rows.add(more.sample[row], more.coefficient[row]);
      rows.rows.close(more.target[row]);
    }
  }
  return rows;
}

std::vector<NamedRows> StageRun::rows_at(const StepGeometry& g, int step) {
  std::vector<NamedRows> rows;
  const bool scalar_region = stage_.solver == Solver::gradient;
  if (weight_of(stage_, "region") > 0.0 && !scalar_region) rows.push_back(region_rows(g, step));
  if (scalar_region && !state_.reading.ridge && !state_.reading.similarity) reestimate_levels(g);
  if (weight_of(stage_, "edge") > 0.0) rows.push_back(edge_rows(g, step));
  if (weight_of(stage_, "body") > 0.0) rows.push_back(body_rows(g, step));
  if (weight_of(stage_, "crossing") > 0.0 && state_.reading.tissue) rows.push_back(crossing_rows(g));
  if (weight_of(stage_, "springs") > 0.0 && !context_.points.points.empty()) {
    const double weight = weight_of(stage_, "springs");
    ExpertRows springs = expert_rows(context_.points, geometry_->layout, g.samples, weight, h_, request_.hold_out);
    points_ = springs.distances;
    out_.held_out_points = springs.held_out;
    if (springs.held_out >= 0.0) {
      const double edges = edge_held_out_ >= 0.0 ? weight_of(stage_, "edge") * edge_held_out_ * edge_held_out_ : 0.0;
      out_.held_out_rms = std::sqrt(edges + weight * springs.held_out);
    }
    rows.push_back(std::move(springs.rows));
  }
  if (weight_of(stage_, "spacing") > 0.0) {
    rows.push_back({"spacing", spacing_rows(geometry_->layout, g.samples.x, g.samples.normal, g.area,
                                            weight_of(stage_, "spacing"), geometry_->coarse)});
  }
  return rows;
}

bool StageRun::healthy(const StepGeometry& g) {
  if (!std::isfinite(g.volume) || !std::isfinite(g.total_area))
    return failed(FitStatus::folded, "the solver met numbers that are not finite");
  if (g.volume < 0.0) return failed(FitStatus::inside_out, "the surface turned inside out");
  if (g.volume < 4.0 * std::pow(h_in_, 3))
    return failed(FitStatus::collapsed, "the surface shrank to less than four voxels");
  if (state_.start_volume > 0.0 && g.volume > 10.0 * state_.start_volume) {
    return failed(FitStatus::leaked, fmt::format("the surface grew to {:.0f} times the volume that the seed saw",
                                                 g.volume / state_.start_volume));
  }
  double outside = 0.0;
  for (std::size_t i = 0; i < g.area.size(); ++i)
    outside += context_.image.grid.contains(g.samples.x[i]) ? 0.0 : g.area[i];
  if (outside > 0.6 * g.total_area)
    return failed(FitStatus::left_image,
                  fmt::format("{:.0f} % of the surface lies outside the volume", 100.0 * outside / g.total_area));
  return true;
}

// The same without what the motion adds.
std::map<std::string, double> energies_of_surface(const StepProblem& problem, const std::vector<Vec3>& x) {
  std::map<std::string, double> energies = energies_at(problem, x);
  energies.erase("motion");
  return energies;
}

double mean_normal_move(const StepGeometry& from, const StepGeometry& to) {
  double move = 0.0;
  for (std::size_t i = 0; i < from.area.size(); ++i) {
    move += from.area[i] / from.total_area * std::abs(from.samples.normal[i].dot(to.samples.x[i] - from.samples.x[i]));
  }
  return move;
}

StageOutcome StageRun::run() {
  const auto begin = std::chrono::steady_clock::now();
  prepare();
  StageSummary& summary = out_.summary;
  summary.name = stage_.name;
  summary.detail = state_.detail;
  summary.control_points = control_point_count(state_.surface.model);
  summary.degrees_of_freedom = degrees_of_freedom(state_.surface.model);
  summary.samples = geometry_->layout.sample_count();
  StepGeometry g = geometry_at(state_, *geometry_);
  add_operators(g);
  const int max_steps = max_steps_ = stage_.max_steps;
  const double tolerance = stage_.tolerance * h_;
  double trust_radius = 1e3;
  StepProblem problem{&state_.surface.model, &geometry_->layout, &operators_, {}, {}, linear_ ? &*linear_ : nullptr};
  std::vector<Vec3> before = g.samples.x;  // a time step ago; every stage starts at rest
  int resting = 0;
  keep_frame(0, false);
  for (int step = 0; step < max_steps; ++step) {
    context_.observer.check_stopped();
    image_->cover(g.samples.x);
    problem.rows = rows_at(g, step);
    problem.scalars = scalar_energies({stage_, state_, *geometry_, image_->image(), h_, g.total_area, g.volume});
    if (step == 0) summary.energy_before = energies_of_surface(problem, g.samples.x);
    const bool gradient = stage_.solver == Solver::gradient || !problem.scalars.empty();
    if (stage_.solver == Solver::dynamic) aim_motion(stage_.motion, g.samples.x, before, operators_.back());
    const StepOutcome outcome =
        solve_step(problem, stage_.solver, gradient ? 60 : 8, trust_radius, state_.surface.parameters);
    summary.solver_iterations += outcome.iterations;
    ++summary.steps;
    const StepGeometry next = geometry_at(state_, *geometry_);
    const double move = summary.last_move_mm = mean_normal_move(g, next);
    summary.history.push_back({move, energies_of_surface(problem, next.samples.x)});
    before = std::move(g.samples.x);
    g = next;
    if (!outcome.usable || !healthy(g)) {
      if (state_.status == FitStatus::ok) failed(FitStatus::folded, "the solver found no way on: " + outcome.message);
      summary.termination = Termination::failed;
      summary.failure = state_.status;
      break;
    }
    const bool arrived = weight_of(stage_, "region") == 0.0 || stage_.solver == Solver::gradient || reach_ <= 6.0 * h_;
    const bool settled = weight_of(stage_, "edge") == 0.0 || step >= 3;
    // What moves with delay has further to go than it just went; what swings stands still where it turns.
    resting = outcome.moved && delay_ * move < tolerance ? resting + 1 : 0;
    const bool at_rest = resting >= (stage_.solver == Solver::dynamic ? 2 : 1) && arrived && settled;
    keep_frame(step + 1, at_rest || step + 1 == max_steps);
    if (at_rest) {
      summary.termination = Termination::converged;
      break;
    }
  }
  summary.energy_after =
      summary.history.empty() ? energies_of_surface(problem, g.samples.x) : summary.history.back().energies;
  summary.rms_residual_mm = rms_;
  out_.error = std::max(rms_, points_.count > 0 ? points_.rms_mm : -1.0);
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return std::move(out_);
}

}  // namespace

StageOutcome run_stage(const StageContext& context, const StageRequest& request, Candidate& candidate) {
  return StageRun(context, request, candidate).run();
}

}  // namespace pellicle

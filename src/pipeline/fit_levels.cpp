#include "pellicle/pipeline/fit_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/base/interrupt.h"
#include "pellicle/pipeline/fit_seeds.h"
#include "pellicle/seed/voxel_seed.h"
#include "pellicle/surface/spline/spline_interpolation.h"

namespace pellicle {

namespace {

constexpr int kMostByItself = 2000;  ///< control points that a fit takes without being told to
constexpr int kMostForTolerance = 2600;
constexpr int kCheap = 200;           ///< control points: coarser levels take no part in ending the search
constexpr double kAstray = 0.005;     ///< share of points beside the surface that a fit is doubted for
constexpr double kWorthwhile = 0.97;  ///< a finer level must bring the left-out points down to this share

double residual_for(const PointFit& fit, ToleranceOf which) {
  const Residual& r = fit.summary.to_surface;
  return which == ToleranceOf::rms ? r.rms : which == ToleranceOf::p95 ? r.p95 : r.max;
}

std::string name_of_size(const SurfaceModel& model) {
  if (const auto* spline = std::get_if<SplineModel>(&model)) {
    return fmt::format("{} x {}", spline->settings().m1, spline->settings().m2);
  }
  return fmt::format("{} points", control_point_count(model));
}

SurfaceModel refined(const SurfaceModel& model) {
  return refine(Surface{model, affine_image(model, Vec3::Zero(), Mat3::Identity())}).model;
}

/// Sizes that are laid out on a map, the fewest control points first, each about 1.5 times the one before.
std::vector<SurfaceModel> sizes_of(const ModelChoice& choice) {
  std::vector<SurfaceModel> sizes;
  if (choice.kind == ModelKind::spline) {
    for (const auto& [m1, m2] : std::initializer_list<std::pair<int, int>>{{4, 2},
                                                                           {6, 3},
                                                                           {6, 5},
                                                                           {8, 6},
                                                                           {10, 7},
                                                                           {12, 9},
                                                                           {14, 12},
                                                                           {16, 15},
                                                                           {20, 18},
                                                                           {24, 22},
                                                                           {30, 26},
                                                                           {36, 32},
                                                                           {44, 40},
                                                                           {52, 50}}) {
      SplineSettings spline;
      spline.m1 = m1;
      spline.m2 = m2;
      sizes.emplace_back(SplineModel(spline));
    }
    return sizes;
  }
  for (const StartSolid solid : {StartSolid::tetrahedron, StartSolid::octahedron, StartSolid::icosahedron}) {
    SurfaceModel model = NormalModel::start(solid, choice.rule);
    while (control_point_count(model) <= kMostForTolerance) {
      sizes.push_back(model);
      model = refined(model);
    }
  }
  std::stable_sort(sizes.begin(), sizes.end(), [](const SurfaceModel& a, const SurfaceModel& b) {
    return control_point_count(a) < control_point_count(b);
  });
  return sizes;
}

bool takes_any_genus(ModelKind kind) {
  return kind == ModelKind::catmull_clark || kind == ModelKind::slime || kind == ModelKind::normal;
}

class LevelSearch {
 public:
  LevelSearch(const RunContext& context, GeometryFitResult& result)
      : settings_(result.settings),
        context_(context),
        result_(result),
        data_(result.input.data),
        seeds_(result.input, result.settings) {
    if (settings_.tolerance_mm) tolerance_ = *settings_.tolerance_mm;
    if (settings_.tolerance_percent) tolerance_ = 0.01 * *settings_.tolerance_percent * data_.diameter;
    fit_settings_.smoothness = settings_.smoothness;
    if (settings_.tolerance_of == ToleranceOf::max) fit_settings_.largest_residual = tolerance_;
  }

  void run() {
    if (result_.input.grid) {
      interpolate();
    } else {
      prepare();
      choose();
    }
    for (FittedSurface& fitted : result_.tried) judge(fitted);
  }

 private:
  /// A size: a model to be laid out on the map, or a surface that is near the data.
  struct Size {
    std::optional<SurfaceModel> model;
    std::optional<Surface> start;
    const SurfaceModel& of() const { return model ? *model : start->model; }
  };

  void tell(double share, const std::string& what) const {
    if (context_.inform) context_.inform(what);
    if (context_.progress) context_.progress(share, what);
    check_interrupt();
  }

  void interpolate() {
    const SurfaceModel start = start_model(settings_.model);
    auto [model, parameters] = interpolate_grid(*result_.input.grid, std::get<SplineModel>(start).settings().topology);
    PointFit fit{{std::move(model), std::move(parameters)}, {}};
    fit.summary.control_points = control_point_count(fit.surface.model);
    fit.summary.degrees_of_freedom = degrees_of_freedom(fit.surface.model);
    fit.summary.reason = "interpolated";
    measure_fit(data_, fit);
    keep(std::move(fit));
  }

  // Spheres are laid out; everything else starts from voxels of the right genus.
  void prepare() {
    const ModelKind kind = settings_.model.kind;
    from_map_ = kind == ModelKind::spline || (kind == ModelKind::normal && result_.input.genus == 0);
    if (!from_map_) {
      tell(0.1, "seeding from voxels");
      if (result_.input.body.voxels.empty()) {
        throw BadData(fmt::format("cannot fit ({}): its points enclose nothing that a surface could start from",
                                  result_.input.file.string()));
      }
      seed_ = seeds_.first();
      return;
    }
    tell(0.1, "laying the surface out on a sphere");
    if (result_.input.solid.triangles.empty()) {
      throw BadData(
          fmt::format("cannot fit ({}): a sphere cannot be laid around data of genus {}; give --model "
                      "catmull-clark or slime",
                      result_.input.file.string(), result_.input.genus));
    }
    if (result_.input.genus > 0) {
      result_.input.warnings.push_back(fmt::format(
          "the data have genus {}: a sphere covers them with their holes bridged; --model catmull-clark or slime keeps "
          "the holes",
          result_.input.genus));
      if (context_.warn)
        context_.warn(fmt::format("{}: {}", result_.input.file.string(), result_.input.warnings.back()));
    }
    const SphereMap map = map_to_sphere(result_.input.solid);
    result_.stretch = map.stretch;
    SurfaceModel probe = start_model(settings_.model);
    while (control_point_count(probe) < 60) probe = refined(probe);
    tell(0.15, "choosing the axis");
    correspondence_ = choose_axis(map, probe);
  }

  Size start() {
    if (!from_map_) return {{}, seed_};
    sizes_ = sizes_of(settings_.model);
    return {sizes_.front(), {}};
  }

  // Of a seeded surface the next finer seed, and where there is none the fitted surface itself, refined. None of more
  // than so many control points.
  std::optional<Size> finer(const PointFit& fitted, std::size_t stride, int most) {
    if (from_map_) {
      at_ += stride;
      if (at_ >= sizes_.size() || control_point_count(sizes_[at_]) > most) return std::nullopt;
      return Size{sizes_[at_], {}};
    }
    const std::optional<VoxelSeed> seed = seeds_.next();
    if (seed && static_cast<int>(seed->mesh.vertices.size()) <= most) return Size{{}, seeds_.surface_on(*seed)};
    Surface finer = refine(fitted.surface);
    if (control_point_count(finer.model) > most) return std::nullopt;
    return Size{{}, std::move(finer)};
  }

  PointFit one(const Size& size, bool hold_out) {
    tell(std::min(0.8, 0.2 + 0.1 * static_cast<double>(result_.tried.size())), "fitting " + name_of_size(size.of()));
    PointFit fit = size.model ? fit_to_map(*size.model, data_, *correspondence_, fit_settings_, hold_out)
                              : fit_from(*size.start, data_, fit_settings_, hold_out);
    measure_fit(data_, fit);
    if (context_.inform) {
      const PointFitSummary& s = fit.summary;
      const double percent = 100.0 / data_.diameter;
      context_.inform(fmt::format("{}: rms {:.3g} %, max {:.3g} % of the diameter{}{}, {}", name_of_size(size.of()),
                                  percent * s.to_surface.rms, percent * s.to_surface.max,
                                  hold_out ? fmt::format(", left-out points {:.3g} %", percent * s.held_out_rms) : "",
                                  s.self_intersections > 0 ? ", cuts itself" : "", s.reason));
    }
    return fit;
  }

  static Size spline_of(int m1, int m2) {
    SplineSettings spline;
    spline.m1 = m1;
    spline.m2 = m2;
    return {SplineModel(spline), {}};
  }

  void choose() {
    if (!settings_.ladder.empty()) {
      for (const int m : settings_.ladder) keep(one(spline_of(m, m), false));
      result_.chosen = result_.tried.size() - 1;
    } else if (settings_.size) {
      keep(one(spline_of((*settings_.size)[0], (*settings_.size)[1]), false));
    } else if (tolerance_) {
      until_tolerance();
    } else if (settings_.detail) {
      at_detail(*settings_.detail);
    } else {
      by_left_out_points();
    }
  }

  void at_detail(int detail) {
    if (from_map_) {
      SurfaceModel model = start_model(settings_.model);
      for (int k = 0; k < detail; ++k) model = refined(model);
      keep(one({std::move(model), {}}, false));
      return;
    }
    PointFit fit = one({{}, seed_}, false);
    for (int k = 0; k < detail; ++k) fit = one({{}, refine(fit.surface)}, false);
    keep(std::move(fit));
  }

  int most_for_tolerance() const {
    if (!settings_.detail) return kMostForTolerance;
    if (settings_.model.kind == ModelKind::spline) {
      const int m = GeometryFitSettings::kFirstRung << *settings_.detail;
      return control_point_count(spline_of(m, m).of());
    }
    Surface surface = from_map_ ? Surface{start_model(settings_.model), {}} : *seed_;
    if (from_map_) surface.parameters = affine_image(surface.model, Vec3::Zero(), Mat3::Identity());
    for (int k = 0; k < *settings_.detail; ++k) surface = refine(surface);
    return control_point_count(surface.model);
  }

  bool meets(const FittedSurface& fitted) const {
    return fitted.fit.summary.self_intersections == 0 &&
           residual_for(fitted.fit, settings_.tolerance_of) <= *tolerance_;
  }

  // Whether what was tried last is the one to keep: fewer points where both meet the tolerance, else the nearer one.
  bool last_is_better_than(std::size_t best) const {
    const FittedSurface &a = result_.tried.back(), &b = result_.tried[best];
    if (meets(a) != meets(b)) return meets(a);
    if (meets(a)) return a.fit.summary.control_points < b.fit.summary.control_points;
    const bool a_cuts = a.fit.summary.self_intersections > 0, b_cuts = b.fit.summary.self_intersections > 0;
    if (a_cuts != b_cuts) return b_cuts;
    return residual_for(a.fit, settings_.tolerance_of) < residual_for(b.fit, settings_.tolerance_of);
  }

  void until_tolerance() {
    const int most = most_for_tolerance();
    const auto attempt = [&](const Size& size) {
      keep(one(size, false));
      if (last_is_better_than(result_.chosen)) result_.chosen = result_.tried.size() - 1;
      return meets(result_.tried.back());
    };
    std::optional<Size> size = start();
    for (double coarser = seeds_.spacing(); size;
         coarser = seeds_.spacing(), size = finer(result_.tried.back().fit, 1, most)) {
      if (!attempt(*size)) continue;
      if (!from_map_ && result_.tried.size() > 1) between_grids(coarser, attempt);
      return;
    }
  }

  // A grid that meets the tolerance may be finer than need be: some between it and the last that was too coarse.
  template <class F>
  void between_grids(double poor, const F& attempt) {
    constexpr double kAlike = 1.1;
    constexpr int kTries = 3;
    double good = seeds_.spacing();
    for (int k = 0; k < kTries && poor > kAlike * good; ++k) {
      const double spacing = std::sqrt(good * poor);
      const std::optional<VoxelSeed> seed = seeds_.on_grid(spacing);
      const int points = seed ? static_cast<int>(seed->mesh.vertices.size()) : 0;
      const bool fewer = seed && points < result_.tried[result_.chosen].fit.summary.control_points;
      (fewer && attempt({{}, seeds_.surface_on(*seed)}) ? good : poor) = spacing;
    }
  }

  void by_left_out_points() {
    const int most = std::clamp(static_cast<int>(data_.points.size() / 2), 10, kMostByItself);
    std::optional<Size> size = start();
    std::optional<PointFit> best;
    Size chosen;
    bool refine_best = false;  // as the next size: the best so far came after the last that was refined
    for (int poor = 0; poor < 2 && size;) {
      const PointFit fit = one(*size, true);
      const bool better = !best || fit.summary.held_out_rms < kWorthwhile * best->summary.held_out_rms;
      const bool cheap = control_point_count(size->of()) < kCheap;
      poor = better ? 0 : poor + (cheap ? 0 : 1);
      if (better) {
        best = fit;
        chosen = from_map_ ? *size : Size{{}, fit.surface};
        refine_best = !from_map_;
      }
      if (best->summary.held_out_rms < 1e-6 * data_.diameter) break;
      // A finer seed that does no better may begin with its limbs in a tangle; the best surface, refined, does not.
      if (!better && !cheap && refine_best) {
        refine_best = false;
        Surface finer = refine(best->surface);
        if (control_point_count(finer.model) <= most) {
          size = Size{{}, std::move(finer)};
          continue;
        }
      }
      size = finer(fit, 2, most);
    }
    // With all points; a surface that starts from voxels goes on from where it was and is only left for a nearer one.
    PointFit last = one(chosen, false);
    last.summary.held_out_rms = best->summary.held_out_rms;
    const bool nearer = from_map_ || last.summary.to_surface.rms <= best->summary.to_surface.rms;
    keep(nearer ? std::move(last) : std::move(*best));
  }

  void keep(PointFit fit) {
    std::string name = name_of_size(fit.surface.model);
    result_.tried.push_back({std::move(name), std::move(fit), "", ""});
  }

  void judge(FittedSurface& fitted) const {
    fitted.status = "ok";
    fitted.reason = fitted.fit.summary.reason;
    const double residual = residual_for(fitted.fit, settings_.tolerance_of);
    if (tolerance_ && residual > *tolerance_) {
      fitted.status = "tolerance_missed";
      fitted.reason = fmt::format("the residual is {:.4g} mm, {:.4g} mm were asked for", residual, *tolerance_);
    }
    const bool by_itself = !tolerance_ && !settings_.size && !settings_.detail && settings_.ladder.empty();
    if (by_itself && fitted.fit.summary.astray_share > kAstray) {
      fitted.status = "doubtful";
      fitted.reason =
          fmt::format("{:.1f} % of the points lie together beside the surface: a part that it does not show",
                      100.0 * fitted.fit.summary.astray_share);
    }
    if (fitted.fit.summary.self_intersections > 0) {
      fitted.status = "folded";
      fitted.reason = fmt::format("the surface cuts itself: {} pairs of facets", fitted.fit.summary.self_intersections);
    }
  }

  const GeometryFitSettings& settings_;
  const RunContext& context_;
  GeometryFitResult& result_;
  const GeometryData& data_;
  std::optional<double> tolerance_;
  PointFitSettings fit_settings_;
  bool from_map_ = true;
  std::optional<Correspondence> correspondence_;
  FitSeeds seeds_;
  std::optional<Surface> seed_;
  std::vector<SurfaceModel> sizes_;  ///< of a model that is laid out on a map
  std::size_t at_ = 0;               ///< the present one
};

}  // namespace

void check_model(ModelKind kind, const GeometryInput& input) {
  if (input.grid && !std::holds_alternative<SplineModel>(start_model({.kind = kind}))) {
    throw UsageError(
        fmt::format("bad value (--model {}): a grid of points (u_index, v_index) is interpolated by a "
                    "spline; give --model spline, spline-torus, spline-cylinder or spline-rectangle",
                    name_of(kind)));
  }
  if (!input.grid && kind != ModelKind::spline && !takes_any_genus(kind)) {
    throw UsageError(
        fmt::format("bad value (--model {}): points without a grid are fitted by normal, spline, "
                    "catmull-clark and slime",
                    name_of(kind)));
  }
}

void fit_levels(const RunContext& context, GeometryFitResult& result) {
  LevelSearch(context, result).run();
}

}  // namespace pellicle

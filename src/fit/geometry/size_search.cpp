#include "pellicle/fit/geometry/size_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/fit/geometry/internal/size_models.h"
#include "pellicle/fit/geometry/internal/size_seeds.h"
#include "pellicle/surface/spline/spline_interpolation.h"

namespace pellicle {

namespace {

constexpr int kMostByDefault = 2000;  ///< control points when nothing is said of their number
constexpr int kCheap = 200;           ///< control points: smaller sizes take no part in ending the search
constexpr double kBeside = 0.005;     ///< fraction of the points beside the surface above which a fit is doubtful
constexpr double kWorthwhile = 0.97;  ///< a larger size must bring the left-out residual down to this fraction

double residual_for(const PointFit& fit, ToleranceOf which) {
  const Residual& r = fit.summary.to_surface;
  return which == ToleranceOf::rms ? r.rms : which == ToleranceOf::p95 ? r.p95 : r.max;
}

bool takes_any_genus(ModelKind kind) {
  return kind == ModelKind::catmull_clark || kind == ModelKind::slime || kind == ModelKind::normal;
}

class Search {
 public:
  Search(const GeometryInput& input, const SizeOptions& options, const Observer& observer)
      : input_(input),
        options_(options),
        observer_(observer),
        data_(input.data),
        seeds_(input, options.model, options.smoothness, observer) {
    if (options.tolerance_mm) tolerance_ = *options.tolerance_mm;
    if (options.tolerance_percent) tolerance_ = 0.01 * *options.tolerance_percent * data_.diameter;
    fit_settings_.smoothness = options.smoothness;
    if (options.tolerance_of == ToleranceOf::max) fit_settings_.largest_residual = tolerance_;
  }

  SizeSearch run() {
    if (input_.grid) {
      interpolate();
    } else {
      prepare();
      choose();
    }
    for (FittedSurface& fitted : result_.tried) judge(fitted);
    return std::move(result_);
  }

 private:
  /// A size: a model to be laid out on the map, or a surface that is near the data.
  struct Size {
    std::optional<SurfaceModel> model;
    std::optional<Surface> start;
    const SurfaceModel& of() const { return model ? *model : start->model; }
  };

  void begin(double fraction, const std::string& what) const {
    observer_.tell(what);
    observer_.tell_progress(fraction, what);
    observer_.check_stopped();
  }

  void interpolate() {
    const SurfaceModel start = start_model(options_.model);
    auto [model, parameters] = interpolate_grid(*input_.grid, std::get<SplineModel>(start).settings().topology);
    PointFit fit{{std::move(model), std::move(parameters)}, {}};
    fit.summary.control_points = control_point_count(fit.surface.model);
    fit.summary.degrees_of_freedom = degrees_of_freedom(fit.surface.model);
    fit.summary.reason = "interpolated";
    measure_fit(data_, fit);
    keep(std::move(fit));
  }

  // Spheres are laid out; everything else starts from voxels of the right genus.
  void prepare() {
    const ModelKind kind = options_.model.kind;
    from_map_ = kind == ModelKind::spline || (kind == ModelKind::normal && input_.genus == 0);
    if (!from_map_) {
      begin(0.1, "seeding from voxels");
      if (input_.body.voxels.empty()) {
        throw BadData(
            fmt::format("cannot fit ({}): its points enclose nothing that a surface could start from", input_.name));
      }
      seed_ = seeds_.first();
      return;
    }
    begin(0.1, "laying the surface out on a sphere");
    if (input_.solid.triangles.empty()) {
      throw BadData(
          fmt::format("cannot fit ({}): a sphere cannot be laid around data of genus {}; give `model` "
                      "catmull-clark or slime",
                      input_.name, input_.genus));
    }
    if (input_.genus > 0) {
      result_.warnings.push_back(fmt::format(
          "the data have genus {}: a sphere covers them with their holes bridged; `model` catmull-clark or slime keeps "
          "the holes",
          input_.genus));
      observer_.tell_warning(fmt::format("{}: {}", input_.name, result_.warnings.back()));
    }
    const SphereMap map = map_to_sphere(input_.solid, {}, observer_);
    result_.stretch = map.stretch;
    SurfaceModel probe = start_model(options_.model);
    while (control_point_count(probe) < 60) probe = refined(probe);
    begin(0.15, "choosing the axis");
    correspondence_ = choose_axis(map, probe);
  }

  Size start() {
    if (!from_map_) return {{}, seed_};
    sizes_ = sizes_of(options_.model);
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
    begin(std::min(0.8, 0.2 + 0.1 * static_cast<double>(result_.tried.size())), "fitting " + name_of_size(size.of()));
    PointFit fit = size.model ? fit_to_map(*size.model, data_, *correspondence_, fit_settings_, hold_out, observer_)
                              : fit_from(*size.start, data_, fit_settings_, hold_out, observer_);
    measure_fit(data_, fit);
    if (observer_.inform) {
      const PointFitSummary& s = fit.summary;
      const double percent = 100.0 / data_.diameter;
      observer_.inform(fmt::format("{}: rms {:.3g} %, max {:.3g} % of the diameter{}{}, {}", name_of_size(size.of()),
                                   percent * s.to_surface.rms, percent * s.to_surface.max,
                                   hold_out ? fmt::format(", left-out points {:.3g} %", percent * s.held_out_rms) : "",
                                   s.self_intersections > 0 ? ", cuts itself" : "", s.reason));
    }
    return fit;
  }

  void choose() {
    if (!options_.ladder.empty()) {
      for (const int m : options_.ladder) keep(one({spline_of(m, m), {}}, false));
      result_.chosen = result_.tried.size() - 1;
    } else if (options_.size) {
      keep(one({spline_of((*options_.size)[0], (*options_.size)[1]), {}}, false));
    } else if (tolerance_) {
      until_tolerance();
    } else if (options_.detail) {
      at_detail(*options_.detail);
    } else {
      by_left_out_points();
    }
  }

  void at_detail(int detail) {
    if (from_map_) {
      SurfaceModel model = start_model(options_.model);
      for (int k = 0; k < detail; ++k) model = refined(model);
      keep(one({std::move(model), {}}, false));
      return;
    }
    PointFit fit = one({{}, seed_}, false);
    for (int k = 0; k < detail; ++k) fit = one({{}, refine(fit.surface)}, false);
    keep(std::move(fit));
  }

  int most_for_tolerance() const {
    if (!options_.detail) return kMostForTolerance;
    if (options_.model.kind == ModelKind::spline) {
      const int m = SizeOptions::kFirstRung << *options_.detail;
      return control_point_count(spline_of(m, m));
    }
    Surface surface = from_map_ ? Surface{start_model(options_.model), {}} : *seed_;
    if (from_map_) surface.parameters = affine_image(surface.model, Vec3::Zero(), Mat3::Identity());
    for (int k = 0; k < *options_.detail; ++k) surface = refine(surface);
    return control_point_count(surface.model);
  }

  bool meets(const FittedSurface& fitted) const {
    return fitted.fit.summary.self_intersections == 0 && residual_for(fitted.fit, options_.tolerance_of) <= *tolerance_;
  }

  // Whether the last fit is the one to keep: fewer control points where both meet the tolerance, else the smaller
  // residual.
  bool last_is_better_than(std::size_t best) const {
    const FittedSurface &a = result_.tried.back(), &b = result_.tried[best];
    if (meets(a) != meets(b)) return meets(a);
    if (meets(a)) return a.fit.summary.control_points < b.fit.summary.control_points;
    const bool a_cuts = a.fit.summary.self_intersections > 0, b_cuts = b.fit.summary.self_intersections > 0;
    if (a_cuts != b_cuts) return b_cuts;
    return residual_for(a.fit, options_.tolerance_of) < residual_for(b.fit, options_.tolerance_of);
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

  // A grid that meets the tolerance may be finer than necessary: tries some between it and the last that was too
  // coarse.
  template <class F>
  void between_grids(double poor, const F& attempt) {
    constexpr double kNearlySame = 1.1;  // ratio of two spacings
    constexpr int kTries = 3;
    double good = seeds_.spacing();
    for (int k = 0; k < kTries && poor > kNearlySame * good; ++k) {
      const double spacing = std::sqrt(good * poor);
      const std::optional<VoxelSeed> seed = seeds_.on_grid(spacing);
      const int points = seed ? static_cast<int>(seed->mesh.vertices.size()) : 0;
      const bool fewer = seed && points < result_.tried[result_.chosen].fit.summary.control_points;
      (fewer && attempt({{}, seeds_.surface_on(*seed)}) ? good : poor) = spacing;
    }
  }

  void by_left_out_points() {
    const int most = std::clamp(static_cast<int>(data_.points.size() / 2), 10, kMostByDefault);
    std::optional<Size> size = start();
    std::optional<PointFit> best;
    Size chosen;
    bool refine_best = false;  // the best so far was not refined yet: it may be the next size
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
      // A finer seed that does no better may have started with tangled limbs; the best surface, refined, does not.
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
    // With all points. A surface that started from voxels goes on from where it was; the new one must be nearer.
    PointFit last = one(chosen, false);
    last.summary.held_out_rms = best->summary.held_out_rms;
    const bool nearer = from_map_ || last.summary.to_surface.rms <= best->summary.to_surface.rms;
    keep(nearer ? std::move(last) : std::move(*best));
  }

  void keep(PointFit fit) {
    std::string name = name_of_size(fit.surface.model);
    result_.tried.push_back({std::move(name), std::move(fit)});
  }

  void judge(FittedSurface& fitted) const {
    fitted.status = SizeStatus::ok;
    fitted.reason = fitted.fit.summary.reason;
    const double residual = residual_for(fitted.fit, options_.tolerance_of);
    if (tolerance_ && residual > *tolerance_) {
      fitted.status = SizeStatus::tolerance_missed;
      fitted.reason = fmt::format("the residual is {:.4g} mm, {:.4g} mm were asked for", residual, *tolerance_);
    }
    const bool by_default = !tolerance_ && !options_.size && !options_.detail && options_.ladder.empty();
    if (by_default && fitted.fit.summary.astray_share > kBeside) {
      fitted.status = SizeStatus::doubtful;
      fitted.reason =
          fmt::format("{:.1f} % of the points lie together beside the surface: a part that it does not show",
                      100.0 * fitted.fit.summary.astray_share);
    }
    if (fitted.fit.summary.self_intersections > 0) {
      fitted.status = SizeStatus::folded;
      fitted.reason = fmt::format("the surface cuts itself: {} pairs of facets", fitted.fit.summary.self_intersections);
    }
  }

  const GeometryInput& input_;
  const SizeOptions& options_;
  const Observer& observer_;
  SizeSearch result_;
  const GeometryData& data_;
  std::optional<double> tolerance_;
  PointFitSettings fit_settings_;
  bool from_map_ = true;
  std::optional<Correspondence> correspondence_;
  SizeSeeds seeds_;
  std::optional<Surface> seed_;
  std::vector<SurfaceModel> sizes_;  ///< of a model that is laid out on a map
  std::size_t at_ = 0;               ///< the present one
};

}  // namespace

std::string to_string(SizeStatus status) {
  switch (status) {
    case SizeStatus::ok:
      return "ok";
    case SizeStatus::doubtful:
      return "doubtful";
    case SizeStatus::folded:
      return "folded";
    case SizeStatus::tolerance_missed:
      return "tolerance_missed";
  }
  return "";
}

bool takes(ModelKind kind, const GeometryInput& input) {
  if (input.grid) return std::holds_alternative<SplineModel>(start_model({.kind = kind}));
  return kind == ModelKind::spline || takes_any_genus(kind);
}

SizeSearch search_size(const GeometryInput& input, const SizeOptions& options, const Observer& observer) {
  return Search(input, options, observer).run();
}

}  // namespace pellicle

#include <fmt/format.h>

#include <algorithm>

#include "pellicle/base/errors.h"
#include "pellicle/fit/fit.h"
#include "pellicle/job/internal/fit_objects.h"

namespace pellicle {

namespace {

constexpr std::size_t kMostLabels = 65535;  // of a uint16 map

void tell(const Observer& observer, Segmentation& result, const std::string& message) {
  result.warnings.push_back(message);
  observer.tell_warning(message);
}

std::vector<Seed> first_candidates(const std::vector<ObjectSeed>& seeds) {
  std::vector<Seed> list;
  list.reserve(seeds.size());
  for (const ObjectSeed& seed : seeds) list.push_back(seed.candidates.front());
  return list;
}

ManySummary summary_of(const ManyResult& many) {
  return {.radius_mm = many.radius,
          .dark = many.dark,
          .seeds = many.seeds,
          .weak = many.weak,
          .doubled = many.doubled,
          .variation = many.variation,
          .typical_shape = many.typical_shape};
}

bool has_contrast(const Image<float>& image) {
  return std::any_of(image.voxels.begin(), image.voxels.end(), [&](float v) { return v != image.voxels.front(); });
}

}  // namespace

void fit_objects(const Image<float>& image, const std::vector<ObjectSeed>& seeds, const SegmentOptions& options,
                 const Observer& observer, Segmentation& result) {
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    observer.check_stopped();
    const ObjectSeed& seed = seeds[i];
    const auto count = static_cast<double>(seeds.size());
    const Observer own = observer.part(static_cast<double>(i) / count, (static_cast<double>(i) + 1.0) / count);
    PhaseClock clock;
    clock.start("fit");
    FitResult fit = fit_surface({image, seed.candidates, seed.points}, options.fit, own);
    clock.stop();
    ObjectResult object{.label = seed.label,
                        .name = seed.name,
                        .surface = std::move(fit.surface),
                        .fit = std::move(fit.summary),
                        .trace = std::move(fit.trace),
                        .seconds = clock.seconds().front().second};
    observer.tell(fmt::format("{}: {} ({})", object.name, to_string(object.fit.status), object.fit.reason));
    result.objects.push_back(std::move(object));
  }
}

void fit_many_objects(Image<float> image, const std::vector<ObjectSeed>& seeds, const SegmentOptions& options,
                      const Observer& observer, Segmentation& result) {
  const ManySettings settings = many_settings(options);
  PhaseClock clock;
  clock.start("fit");
  ManyResult many;
  if (has_contrast(image)) {
    many = seeds.empty() ? fit_many(std::move(image), settings, observer)
                         : fit_many(std::move(image), first_candidates(seeds), settings, observer);
  }
  clock.stop();
  if (many.objects.size() > kMostLabels) {
    throw BadData(
        fmt::format("too many objects (label map): {} were found, it holds {}; crop the image or give `radius`",
                    many.objects.size(), kMostLabels));
  }
  const double each = clock.seconds().front().second / std::max<double>(1.0, static_cast<double>(many.objects.size()));
  for (ManyObject& found : many.objects) {
    const int number = static_cast<int>(result.objects.size()) + 1;
    ObjectResult object{.label = number,
                        .name = fmt::format("object-{}", number),
                        .surface = std::move(found.surface),
                        .fit = std::move(found.summary),
                        .seconds = each};
    if (!seeds.empty()) {
      object.label = seeds[found.source].label;
      object.name = seeds[found.source].name;
    }
    object.shape = ObjectShape{
        .visible = found.evidence.visible, .support = found.evidence.support, .limited = found.evidence.limited};
    result.objects.push_back(std::move(object));
  }
  if (many.objects.empty())
    tell(observer, result, "no object found: nothing rises above the noise; see `radius` and `polarity`");
  if (!seeds.empty() && many.doubled > 0) {
    tell(observer, result,
         fmt::format("{} of the {} seeds lie in the object of another one: one object each is kept", many.doubled,
                     seeds.size()));
  }
  result.many = summary_of(many);
  observer.tell(
      fmt::format("typical radius {:.4g} mm, {} places tried, {} objects, {} turned down as unlike the others",
                  many.radius, many.seeds, many.objects.size(), many.weak));
}

}  // namespace pellicle

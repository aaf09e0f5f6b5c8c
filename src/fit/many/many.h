#pragma once
/// Many objects of one kind in one image: found, or given by seeds, each with a small fit of its own.
///
/// Every object is fitted alone on a small piece of the image with the energy `body` (energies/body.h), inside its
/// territory, by the stages of fit/stage.h: independent, hence parallel and the same for any number of threads. The
/// first fits see the variance-stabilised image and are what objects are judged by; the last ones see the image itself.

#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/fit/many/many_types.h"
#include "pellicle/seed/seed.h"

namespace pellicle {

/// Where objects seem to be, as balls of their typical radius, the clearest first: what fit_many starts from.
std::vector<SeedSphere> detect_many(const Image<float>& image, const ManySettings& settings);

/// Finds and fits. The image is smoothed in place: move it in where it is not needed any more. It is not an error when
/// there is no object.
/// \throws UsageError for settings that break a rule; Interrupted.
ManyResult fit_many(Image<float> image, const ManySettings& settings, const Observer& observer = {});

/// From seeds, one object each; none is turned down for weak evidence (it is doubtful then), but of two that turn out
/// to be one object the second goes. Balls are placed as given; surfaces that are already near are kept as starts.
ManyResult fit_many(Image<float> image, const std::vector<Seed>& seeds, const ManySettings& settings,
                    const Observer& observer = {});

}  // namespace pellicle

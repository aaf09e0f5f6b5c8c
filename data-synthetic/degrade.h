#pragma once
/// What a scanner does to an ideal image: intensity drift and noise. In place, deterministic for any thread count.

#include <cstdint>

#include "pellicle/image/image.h"

namespace pellicle {

enum class PhantomNoise { none, gaussian, rician, poisson };

/// Multiplies by 1 + amplitude * g(x), g a sum of three plane waves with periods of one to two volume diagonals,
/// scaled to run from -1 to 1 over the volume.
void apply_bias(Image<float>& image, double amplitude, std::uint64_t seed);

/// \param sd of the Gaussian, or of each Rician channel; Poisson: at the intensity `reference`.
void apply_noise(Image<float>& image, PhantomNoise noise, double sd, double reference, std::uint64_t seed);

}  // namespace pellicle

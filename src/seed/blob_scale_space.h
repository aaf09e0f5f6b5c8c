#pragma once
/// Finding many objects of one kind: blobs of a band-pass scale space, in intensities whose noise is even.
///
/// N(sigma) = (G(sigma) - G(K sigma)) * v / (K - 1), K = 2^(1/3), the difference of Gaussians that approximates the
/// scale-normalised Laplacian (Lindeberg 1998); a solid ball of radius r answers strongest at sigma = r / sqrt 3.
/// v = sqrt(max(I - low, 0) / unit + 1) (Anscombe 1948): a few bright specks do not outweigh everything else.
/// Everything scales with the intensities and follows the axes: a scaled, shifted or transposed stack gives the same
/// objects.

#include <optional>
#include <vector>

#include "pellicle/image/image.h"

namespace pellicle {

/// From the file's intensities to v.
struct StableIntensity {
  double low = 0.0, unit = 1.0;  ///< 1st percentile; a 256th of the range of the sign's intensities
  bool dark = false;             ///< objects are darker than their surroundings: -I is looked at
  float linear(float intensity) const { return dark ? -intensity : intensity; }
  float operator()(float intensity) const;
};

/// What detection works on.
struct BlobField {
  StableIntensity intensity;
  double noise = 0.0;         ///< standard deviation of v in a voxel of the image
  double voxel_volume = 1.0;  ///< of the image, mm^3
  Image<float> v;             ///< binned where the image is large (16 million voxels at most)
};

/// Whether objects are likely dark: the low tail of the histogram reaches more than twice as far as the high one.
bool looks_dark(const Image<float>& image);

/// \pre the image has contrast.
BlobField blob_field(const Image<float>& image, bool dark);

/// N at sigma = scale * radius / sqrt 3, on voxels of about a fifth of the radius.
/// \param noise set to the standard
/// deviation that white noise gives it, when not null.
Image<float> blob_response(const BlobField& field, double radius, double scale, double* noise = nullptr);

/// Radii that are looked for, mm.
struct RadiusRange {
  double min = 0.0, max = 0.0;
};

/// The radius that most of the image's blobs have: mode of the scale-space maxima above six deviations of the noise,
/// weighted by N^2 r^2 (more weight to size picks clusters, less picks noise).
/// \param range looks only there; without
/// it between two voxels and 0.4 of the shortest edge. None when nothing rises above the noise.
std::optional<double> estimate_radius(const BlobField& field, const std::optional<RadiusRange>& range);

struct BlobSeed {
  Vec3 position{0, 0, 0};  ///< LPS mm
  double response = 0.0;   ///< N there
};

/// How readily two maxima near each other count as two objects.
struct SeedRules {
  double deviations = 6.0;  ///< N above so many deviations of its noise
  double relative = 0.2;    ///< N above this fraction of that of typical strong blobs
  double valley = 0.9;      ///< one object when N between them stays above this fraction of the weaker
};

/// Strongest first. Of two maxima closer than two radii the weaker is dropped when they are closer than half a radius
/// or no valley lies between.
std::vector<BlobSeed> find_blobs(const BlobField& field, double radius, const SeedRules& rules = {});

}  // namespace pellicle

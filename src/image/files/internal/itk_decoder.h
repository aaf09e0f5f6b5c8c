#pragma once
/// Decoding of NRRD and MetaImage by ITK: the only place that includes ITK. This header includes neither ITK nor Eigen:
/// ITK bundles an Eigen of its own, which cannot be in one translation unit with the system's.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace pellicle {

/// What ITK's NRRD and MetaImage readers say about a file; world LPS, in the file's own unit.
struct ItkVolume {
  enum class Pixel { scalar, rgb, complex, other };
  Pixel pixel = Pixel::scalar;
  unsigned components = 1;
  char kind = '?';  ///< 'u' unsigned, 'i' signed, 'f' floating, '?' none of them
  std::size_t bytes_per_component = 0;
  std::vector<std::int64_t> size;  ///< every axis of the file
  std::array<double, 3> spacing{1, 1, 1}, origin{0, 0, 0};
  std::array<std::array<double, 3>, 3> direction{};  ///< [axis][world coordinate]
  /// Fills a buffer of all voxels in native byte order.
  /// \throws std::runtime_error.
  std::function<void(std::byte* buffer)> read;
};

/// Opens `path` with the reader of its format. Nothing is printed; ITK's complaint, shortened to one line, is the
/// exception's text.
/// \throws std::runtime_error.
ItkVolume open_with_itk(const std::string& path, bool is_nrrd);

}  // namespace pellicle

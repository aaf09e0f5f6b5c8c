#include "pellicle/image/files/internal/bad_volume.h"

#include <fmt/format.h>

#include <algorithm>

#include "pellicle/base/errors.h"

namespace pellicle {

void throw_bad_volume(const std::filesystem::path& path, const std::string& why, const std::string& hint) {
  throw BadData(fmt::format("cannot read volume ({}): {}; {}", path.string(), why, hint));
}

void check_size(const std::filesystem::path& path, const std::array<std::int64_t, 3>& size) {
  const std::string shape = fmt::format("{}x{}x{}", size[0], size[1], size[2]);
  if (*std::min_element(size.begin(), size.end()) < 1) {
    throw_bad_volume(path, fmt::format("the header claims an impossible size of {} voxels", shape),
                     "the file is damaged; export it again");
  }
  if (size[0] == 1 && size[1] == 1 && size[2] == 1) {
    throw_bad_volume(path, "the image has one voxel only, too small to hold a surface", "give a 3D volume");
  }
  if (*std::min_element(size.begin(), size.end()) == 1) {
    throw_bad_volume(path, fmt::format("a 2D image or single slice of {} voxels", shape),
                     "give a 3D volume with at least two voxels along each axis");
  }
  constexpr std::int64_t axis_limit = 1 << 24;
  constexpr double voxel_limit = 1e12;  // 4 TB as float32
  const double count = static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]);
  if (*std::max_element(size.begin(), size.end()) > axis_limit || count > voxel_limit) {
    throw_bad_volume(path, fmt::format("the header claims an absurd size of {} voxels", shape),
                     "the file is damaged; export it again");
  }
}

void check_claim(const std::filesystem::path& path, std::uint64_t bytes_claimed, std::uint64_t bytes_on_disk,
                 bool compressed) {
  constexpr std::uint64_t best_deflate_ratio = 1032;
  const std::uint64_t most = compressed ? bytes_on_disk * best_deflate_ratio : bytes_on_disk;
  if (bytes_claimed > most) {
    throw_bad_volume(path,
                     fmt::format("truncated: the header claims {} bytes, the file has {}{}", bytes_claimed,
                                 bytes_on_disk, compressed ? " (compressed)" : ""),
                     "copy or export the file again");
  }
}

}  // namespace pellicle

#pragma once
/// What every format reader hands to volume_file.cpp: a header and the voxels as a stream of blocks in stored type.
/// Streaming keeps the peak memory of reading at the float32 image plus one block, whatever the format.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <type_traits>

#include "pellicle/image/files/volume_file.h"

namespace pellicle {

enum class ComponentType { uint8, int8, uint16, int16, uint32, int32, uint64, int64, float32, float64 };

std::size_t size_in_bytes(ComponentType type);
const char* name_of(ComponentType type);

/// Consecutive voxels in native byte order; `data` is valid during the call only and need not be aligned.
struct VoxelBlock {
  ComponentType type;
  const std::byte* data;
  std::size_t count;
};

/// An opened volume: the header is checked, the voxels are not read yet.
struct VolumeSource {
  VolumeHeader header;
  /// Calls the consumer with blocks, x fastest, header.grid.voxel_count() voxels in all. To be called once.
  /// \throws BadData (truncated, corrupt), IoError.
  std::function<void(const std::function<void(const VoxelBlock&)>& consume)> read_blocks;
};

/// `cannot read volume (PATH): WHY; HINT`.
[[noreturn]] void throw_bad_volume(const std::filesystem::path& path, const std::string& why, const std::string& hint);

/// Checks that x, y and z have at least two voxels each and that their number can be held in memory.
/// \throws BadData: negative, empty, one voxel, 2D.
void check_size(const std::filesystem::path& path, const std::array<std::int64_t, 3>& size);

/// Checks that a file of `bytes_on_disk` can hold `bytes_claimed` of voxels; deflate never packs better than 1032:1.
/// Called before anything is allocated. \throws BadData.
void check_claim(const std::filesystem::path& path, std::uint64_t bytes_claimed, std::uint64_t bytes_on_disk,
                 bool compressed);

/// Calls `f(T{})` with the C++ type of `type`.
template <class F>
decltype(auto) with_component(ComponentType type, F&& f) {
  switch (type) {
    case ComponentType::uint8:
      return f(std::uint8_t{});
    case ComponentType::int8:
      return f(std::int8_t{});
    case ComponentType::uint16:
      return f(std::uint16_t{});
    case ComponentType::int16:
      return f(std::int16_t{});
    case ComponentType::uint32:
      return f(std::uint32_t{});
    case ComponentType::int32:
      return f(std::int32_t{});
    case ComponentType::uint64:
      return f(std::uint64_t{});
    case ComponentType::int64:
      return f(std::int64_t{});
    case ComponentType::float32:
      return f(float{});
    case ComponentType::float64:
      break;
  }
  return f(double{});
}

}  // namespace pellicle

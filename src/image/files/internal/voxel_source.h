#pragma once
/// What every format reader hands to volume_file.cpp: a header and the voxels as a stream of blocks in stored type.
/// Streaming keeps the peak memory of reading at the float32 image plus one block, whatever the format.

#include <cstddef>
#include <cstdint>
#include <functional>

#include "pellicle/image/files/internal/bad_volume.h"
#include "pellicle/image/volume.h"

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

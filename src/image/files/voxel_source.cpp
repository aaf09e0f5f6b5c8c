#include "pellicle/image/files/internal/voxel_source.h"

namespace pellicle {

std::size_t size_in_bytes(ComponentType type) {
  return with_component(type, [](auto zero) { return sizeof(zero); });
}

const char* name_of(ComponentType type) {
  switch (type) {
    case ComponentType::uint8:
      return "uint8";
    case ComponentType::int8:
      return "int8";
    case ComponentType::uint16:
      return "uint16";
    case ComponentType::int16:
      return "int16";
    case ComponentType::uint32:
      return "uint32";
    case ComponentType::int32:
      return "int32";
    case ComponentType::uint64:
      return "uint64";
    case ComponentType::int64:
      return "int64";
    case ComponentType::float32:
      return "float32";
    case ComponentType::float64:
      break;
  }
  return "float64";
}

}  // namespace pellicle

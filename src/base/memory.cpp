#include "pellicle/base/memory.h"

#include <sys/mman.h>

#include <cstdint>

namespace pellicle {

void prefer_large_pages(void* block, std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::uintptr_t page = 4096;
  constexpr std::size_t least = std::size_t{4} << 20;
  if (block == nullptr || bytes < least) return;
  // Whole pages within the block only: the rest belongs to the allocator.
  const auto begin = (reinterpret_cast<std::uintptr_t>(block) + page - 1) / page * page;
  const auto end = (reinterpret_cast<std::uintptr_t>(block) + bytes) / page * page;
  static_cast<void>(madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE));  // a hint; may fail
#else
  static_cast<void>(block);
  static_cast<void>(bytes);
#endif
}

}  // namespace pellicle

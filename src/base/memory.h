#pragma once
/// How large blocks of memory are laid out.

#include <cstddef>

namespace pellicle {

/// Asks the system for large pages under a block that is about to be filled: a volume then costs one page fault per 2
/// MB instead of one per 4 kB. A hint: does nothing where the system has none, or for blocks below a few megabytes.
void prefer_large_pages(void* block, std::size_t bytes);

}  // namespace pellicle

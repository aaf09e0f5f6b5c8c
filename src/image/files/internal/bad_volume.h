#pragma once
/// What makes a file of voxels unreadable: one form of message, and checks before memory is allocated.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

namespace pellicle {

/// \throws BadData `cannot read volume (PATH): WHY; HINT`.
[[noreturn]] void throw_bad_volume(const std::filesystem::path& path, const std::string& why, const std::string& hint);

/// Checks that x, y and z have at least two voxels each and that their number can be held in memory.
/// \throws BadData: negative, empty, one voxel, 2D.
void check_size(const std::filesystem::path& path, const std::array<std::int64_t, 3>& size);

/// Checks that a file of `bytes_on_disk` can hold `bytes_claimed` of voxels; deflate never packs better than 1032:1.
/// Called before anything is allocated.
/// \throws BadData.
void check_claim(const std::filesystem::path& path, std::uint64_t bytes_claimed, std::uint64_t bytes_on_disk,
                 bool compressed);

}  // namespace pellicle

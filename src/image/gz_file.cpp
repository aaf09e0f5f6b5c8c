#include "pellicle/image/gz_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "pellicle/base/errors.h"
#include "pellicle/image/voxel_source.h"

namespace pellicle {

GzFile::GzFile(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code failure;
  bytes_on_disk_ = std::filesystem::file_size(path_, failure);
  if (failure) throw NoInput(fmt::format("cannot open ({}): {}", path_.string(), failure.message()));
  if (bytes_on_disk_ == 0) throw_bad_volume(path_, "the file is empty (zero bytes)", "copy or export it again");
  file_ = gzopen(path_.c_str(), "rb");
  if (file_ == nullptr) throw NoInput(fmt::format("cannot open ({}): {}", path_.string(), std::strerror(errno)));
  gzbuffer(file_, 1U << 18);
  compressed_ = gzdirect(file_) == 0;
}

GzFile::~GzFile() {
  gzclose(file_);
}

std::size_t GzFile::read_some(void* target, std::size_t count) {
  constexpr std::size_t most = 1U << 30;  // gzread counts in int
  std::size_t done = 0;
  while (done < count) {
    const int got =
        gzread(file_, static_cast<char*>(target) + done, static_cast<unsigned>(std::min(most, count - done)));
    int code = Z_OK;
    const char* text = gzerror(file_, &code);
    if (code == Z_BUF_ERROR) {
      throw_bad_volume(path_, fmt::format("truncated: the gzip data end after {} bytes", bytes_read_ + done),
                       "copy or export the file again");
    }
    if (code == Z_ERRNO) throw IoError(fmt::format("reading failed ({}): {}", path_.string(), std::strerror(errno)));
    if (got < 0)
      throw_bad_volume(path_, fmt::format("the gzip data are corrupt ({})", text), "copy or export the file again");
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  bytes_read_ += done;
  return done;
}

void GzFile::read_exact(void* target, std::size_t count) {
  const std::size_t got = read_some(target, count);
  if (got < count) {
    throw_bad_volume(path_, fmt::format("truncated: the data end after {} bytes", bytes_read_),
                     "copy or export the file again");
  }
}

void GzFile::skip(std::uint64_t count) {
  std::vector<char> ignored(static_cast<std::size_t>(std::min<std::uint64_t>(count, 1U << 16)));
  while (count > 0) {
    const std::size_t step = static_cast<std::size_t>(std::min<std::uint64_t>(count, ignored.size()));
    read_exact(ignored.data(), step);
    count -= step;
  }
}

void GzFile::check_rest() {
  if (!compressed_) return;
  std::vector<char> ignored(1U << 16);
  while (read_some(ignored.data(), ignored.size()) > 0) {
  }
}

}  // namespace pellicle

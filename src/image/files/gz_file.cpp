#include "pellicle/image/files/internal/gz_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include "pellicle/base/errors.h"
#include "pellicle/image/files/internal/bad_volume.h"

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
      throw_bad_volume(path_,
                       fmt::format("truncated: the gzip data end after {} bytes",
                                   bytes_read_ + done + static_cast<std::size_t>(std::max(got, 0))),
                       "copy or export the file again");
    }
    if (code == Z_ERRNO) throw IoError(fmt::format("reading failed ({}): {}", path_.string(), std::strerror(errno)));
    if (got < 0) {
      std::string reason = text;  // "PATH: REASON"
      if (reason.starts_with(path_.string() + ": ")) reason = reason.substr(path_.string().size() + 2);
      throw_bad_volume(path_, fmt::format("the gzip data are corrupt ({})", reason), "copy or export the file again");
    }
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

void check_deflated(const std::filesystem::path& path, const std::filesystem::path& file, std::uint64_t offset,
                    std::uint64_t bytes_expected) {
  std::ifstream in(file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(offset));
  constexpr std::size_t block = 1U << 18;
  std::vector<char> packed(block), unpacked(block);
  z_stream stream{};
  inflateInit2(&stream, 15 + 32);  // zlib or gzip, by its first bytes
  int code = Z_OK;
  while (code == Z_OK && stream.total_out < bytes_expected && in) {
    in.read(packed.data(), block);
    stream.next_in = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_in = static_cast<uInt>(in.gcount());
    while (code == Z_OK && stream.avail_in > 0) {
      stream.next_out = reinterpret_cast<Bytef*>(unpacked.data());
      stream.avail_out = block;
      code = inflate(&stream, Z_NO_FLUSH);
    }
  }
  const std::uint64_t done = stream.total_out;
  inflateEnd(&stream);
  if (code != Z_OK && code != Z_STREAM_END && code != Z_BUF_ERROR) {
    throw_bad_volume(path, "the compressed data are corrupt", "copy or export the file again");
  }
  if (done < bytes_expected) {
    throw_bad_volume(path, fmt::format("truncated: the compressed data end after {} of {} bytes", done, bytes_expected),
                     "copy or export the file again");
  }
}

}  // namespace pellicle

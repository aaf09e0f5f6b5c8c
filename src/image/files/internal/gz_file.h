#pragma once
/// Reading of files that may be gzipped, whatever their names.

#include <cstddef>
#include <cstdint>
#include <filesystem>

struct gzFile_s;

namespace pellicle {

class GzFile {
 public:
  /// \throws NoInput when it cannot be opened.
  explicit GzFile(std::filesystem::path path);
  ~GzFile();
  GzFile(const GzFile&) = delete;
  GzFile& operator=(const GzFile&) = delete;

  bool compressed() const { return compressed_; }
  std::uint64_t bytes_on_disk() const { return bytes_on_disk_; }
  /// Up to `count` bytes; fewer only at the end of the data.
  /// \throws BadData for corrupt gzip data, IoError.
  std::size_t read_some(void* target, std::size_t count);
  /// \throws BadData also when the data end early.
  void read_exact(void* target, std::size_t count);
  void skip(std::uint64_t count);
  /// Reads on to the end, so that a wrong checksum is seen.
  /// \throws BadData.
  void check_rest();

 private:
  std::filesystem::path path_;
  gzFile_s* file_ = nullptr;
  std::uint64_t bytes_on_disk_ = 0, bytes_read_ = 0;
  bool compressed_ = false;
};

/// Unpacks the zlib or gzip stream that starts at `offset` of a file and drops it. For decoders that ignore
/// zlib's errors.
/// \throws BadData: corrupt, or fewer than `bytes_expected` bytes; the message names `path`.
void check_deflated(const std::filesystem::path& path, const std::filesystem::path& file, std::uint64_t offset,
                    std::uint64_t bytes_expected);

}  // namespace pellicle

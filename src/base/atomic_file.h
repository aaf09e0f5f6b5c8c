#pragma once
/// Files that appear whole or not at all.

#include <filesystem>
#include <string>
#include <string_view>

namespace pellicle {

/// A file under construction beside its final name. Write to `path()` (same extension, so that libraries which look
/// at it are content), then `commit()` renames it into place. Without commit the destructor removes it: an
/// exception or an interrupt leaves nothing behind.
class AtomicFile {
 public:
  /// \throws CannotCreate when the folder cannot be written.
  explicit AtomicFile(std::filesystem::path final_path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& path() const { return temporary_; }
  /// \throws IoError when the rename fails.
  void commit();

 private:
  std::filesystem::path final_, temporary_;
  bool committed_ = false;
};

/// Writes `text` to `path` atomically.
/// \throws CannotCreate, IoError.
void write_text_file(const std::filesystem::path& path, std::string_view text);

/// SHA-256 of a file's bytes as 64 hexadecimal digits; of a folder: of its files' names and bytes, sorted by name.
/// \throws NoInput, IoError.
std::string sha256_of(const std::filesystem::path& path);

}  // namespace pellicle

#include "pellicle/base/atomic_file.h"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <vector>

#include "pellicle/base/errors.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

// "scan.nii.gz" -> ".scan.4711.part.nii.gz": hidden, in the same folder, with the same extensions.
fs::path temporary_name(const fs::path& final_path) {
  const std::string name = final_path.filename().string();
  const auto dot = name.find('.', 1);
  const std::string stem = name.substr(0, dot);
  const std::string extension = dot == std::string::npos ? "" : name.substr(dot);
  return final_path.parent_path() / fmt::format(".{}.{}.part{}", stem, getpid(), extension);
}

void add_file(EVP_MD_CTX* context, const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw NoInput(fmt::format("cannot open ({})", path.string()));
  std::array<char, 1 << 16> buffer{};
  while (in) {
    in.read(buffer.data(), buffer.size());
    EVP_DigestUpdate(context, buffer.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (in.bad()) throw IoError(fmt::format("reading failed ({})", path.string()));
}

}  // namespace

AtomicFile::AtomicFile(fs::path final_path) : final_(std::move(final_path)), temporary_(temporary_name(final_)) {
  std::ofstream probe(temporary_, std::ios::binary);
  if (!probe)
    throw CannotCreate(
        fmt::format("cannot create output ({}): the folder is missing or not writable", final_.string()));
}

AtomicFile::~AtomicFile() {
  std::error_code ignored;
  if (!committed_) fs::remove(temporary_, ignored);
}

void AtomicFile::commit() {
  std::error_code failure;
  fs::rename(temporary_, final_, failure);
  if (failure) throw IoError(fmt::format("cannot rename into place ({}): {}", final_.string(), failure.message()));
  committed_ = true;
}

void write_text_file(const fs::path& path, std::string_view text) {
  AtomicFile file(path);
  std::ofstream out(file.path(), std::ios::binary);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  if (!out) throw IoError(fmt::format("writing failed ({})", path.string()));
  file.commit();
}

std::string sha256_of(const fs::path& path) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr);
  if (fs::is_directory(path)) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(path)) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (const auto& file : files) {
      const std::string name = file.filename().string();
      EVP_DigestUpdate(context.get(), name.data(), name.size());
      add_file(context.get(), file);
    }
  } else {
    add_file(context.get(), path);
  }
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned length = 0;
  EVP_DigestFinal_ex(context.get(), digest.data(), &length);
  std::string hex;
  for (unsigned i = 0; i < length; ++i) hex += fmt::format("{:02x}", digest[i]);
  return hex;
}

}  // namespace pellicle

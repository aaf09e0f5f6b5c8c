#include "pellicle/output/run_record.h"

#include "pellicle/base/atomic_file.h"

namespace pellicle {

OutputFile described(const std::string& kind, const std::filesystem::path& path) {
  return {kind, path, sha256_of(path), std::filesystem::file_size(path)};
}

}  // namespace pellicle

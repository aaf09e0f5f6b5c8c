#include "pellicle/output/provenance.h"

#include <ceres/version.h>
#include <fmt/format.h>
#include <openssl/crypto.h>
#include <png.h>
#include <sys/resource.h>
#include <toml++/toml.h>

#include <Eigen/Core>
#include <ctime>
#include <nlohmann/json.hpp>

namespace pellicle {

std::string program_version() {
  return PELLICLE_VERSION;
}

std::vector<std::pair<std::string, std::string>> library_versions() {
  const std::string eigen = fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
  const std::string nlohmann =
      fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH);
  const std::string toml = fmt::format("{}.{}.{}", TOML_LIB_MAJOR, TOML_LIB_MINOR, TOML_LIB_PATCH);
  return {{"Ceres", CERES_VERSION_STRING},
          {"Eigen", eigen},
          {"ITK", PELLICLE_ITK_VERSION},
          {"OpenVDB", PELLICLE_OPENVDB_VERSION},
          {"Embree", PELLICLE_EMBREE_VERSION},
          {"OpenSubdiv", PELLICLE_OPENSUBDIV_VERSION},
          {"OpenSSL", OpenSSL_version(OPENSSL_VERSION_STRING)},
          {"libpng", png_get_libpng_ver(nullptr)},
          {"nlohmann-json", nlohmann},
          {"toml++", toml}};
}

long peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss * 1024L;
}

std::string utc_time() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday,
                     parts.tm_hour, parts.tm_min, parts.tm_sec);
}

}  // namespace pellicle
